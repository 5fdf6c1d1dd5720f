# SPDX-License-Identifier: MIT
"""Studies: corner cases, worst cases, methods, true surfaces."""
