"""Twins of rtl/techniques/: Gouraud's and flat shading."""
