"""The studies that need the RTL."""
