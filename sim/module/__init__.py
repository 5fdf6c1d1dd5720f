# SPDX-License-Identifier: MIT
"""Simulation of single modules: generated testbenches and cocotb testbench classes."""
