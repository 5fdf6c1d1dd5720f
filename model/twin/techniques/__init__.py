# SPDX-License-Identifier: MIT
"""Twins of rtl/techniques/: Gouraud's and flat shading."""
