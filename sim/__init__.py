# SPDX-License-Identifier: MIT
"""The simulation: benches, their cocotb testbench classes, and the build with Verilator."""
