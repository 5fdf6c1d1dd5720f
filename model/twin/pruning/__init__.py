"""Twins of rtl/pruning/: what pruned builds add."""
