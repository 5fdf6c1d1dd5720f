# SPDX-License-Identifier: MIT
"""Mesh files: from a file of any format to triangles with normals and materials, and a report.

`checks` looks at the text of a file before the library does, `library` reads the file with Assimp
in a process of its own (`child`), `load` makes a `Mesh` of what was read, `materials` turns the
file's materials into those of eq. (3), and `report` says what was decided.
"""
