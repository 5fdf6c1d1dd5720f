# SPDX-License-Identifier: MIT
"""Twins of rtl/reflectance/: curves of cos(s) by table, and jumps."""
