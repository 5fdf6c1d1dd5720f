"""Synthesis, place and route for a Lattice ECP5."""
