# SPDX-License-Identifier: MIT
"""Twins of rtl/primitives/: arithmetic that several stages share."""
