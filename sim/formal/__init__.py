# SPDX-License-Identifier: MIT
"""Formal proofs of flow control and interpolators with SymbiYosys; `make formal` runs them."""
