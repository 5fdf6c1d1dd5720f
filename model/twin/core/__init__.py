# SPDX-License-Identifier: MIT
"""Twins of rtl/core/: Phong's pipeline, from a span to a pixel."""
