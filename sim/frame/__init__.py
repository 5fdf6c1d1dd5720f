# SPDX-License-Identifier: MIT
"""Simulation of whole frames: the RTL pipeline with span files in and pixel files out."""
