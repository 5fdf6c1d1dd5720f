# SPDX-License-Identifier: MIT
"""The front end: from scene files and meshes to spans."""
