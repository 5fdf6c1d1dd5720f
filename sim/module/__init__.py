# SPDX-License-Identifier: MIT
"""Single modules through the RTL."""
