# SPDX-License-Identifier: MIT
"""Long runs of the module tests: mutation, coverage, Icarus, random scenes."""
