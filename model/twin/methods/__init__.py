"""Twins of rtl/methods/: other ways to the same result."""
