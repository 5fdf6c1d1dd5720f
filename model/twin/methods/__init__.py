# SPDX-License-Identifier: MIT
"""Twins of rtl/methods/: other ways to the same result, for the sweep."""
