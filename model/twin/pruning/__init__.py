# SPDX-License-Identifier: MIT
"""Twins of rtl/pruning/: modules of builds that leave something out."""
