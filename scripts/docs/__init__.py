# SPDX-License-Identifier: MIT
"""The documentation: tables and figures from the records and the design, pictures, Sphinx."""
