"""Single modules through the RTL."""
