# SPDX-License-Identifier: MIT
"""Twins of rtl/lights/: pixels that are a sum over several lights."""
