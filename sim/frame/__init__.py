# SPDX-License-Identifier: MIT
"""Whole frames through the RTL."""
