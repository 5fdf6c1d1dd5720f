"""Whole frames through the RTL."""
