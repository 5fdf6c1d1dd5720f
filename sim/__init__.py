# SPDX-License-Identifier: MIT
"""Simulation: Verilog testbenches, cocotb testbench classes, proofs, and their builds."""
