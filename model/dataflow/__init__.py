# SPDX-License-Identifier: MIT
"""The twin as a graph of integer operations, and what is generated from the graph.

The functions of `phong75.model.twin` say once what the hardware computes. `trace` runs them on
words that stand for any pixel (`words`) and gets the graph (`graph`); `cpp` writes the graph in
C++. So the generated program cannot say anything else than the twin does.
"""
