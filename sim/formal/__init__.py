# SPDX-License-Identifier: MIT
"""Proofs of the control and the interpolators with SymbiYosys; `make formal` runs them."""
