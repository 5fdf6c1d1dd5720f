"""Twins of rtl/core/: the paper's pipeline."""
