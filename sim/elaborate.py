# SPDX-License-Identifier: MIT
"""Elaboration: the instances of a design in one configuration, as Verilator elaborates them."""

from __future__ import annotations

import json
import re
import tempfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from phong75.model.config import DEFAULT, Config
from phong75.sim import build, design
from phong75.sim.build import BENCH_FOLDERS, digest, generate_header, run_tool


def includes(config: Config = DEFAULT) -> list[str]:
    """Verilator's options for the include folders: header of `config`, design, testbenches."""
    folders = (generate_header(config), *design.folders(), *BENCH_FOLDERS)
    return [f"-I{folder}" for folder in folders]


def elaborate(top: str, config: Config = DEFAULT, text: str | None = None) -> dict:
    """Verilator's syntax tree (JSON) of the elaborated module `top`.

    text: the Verilog text of `top`; None if `top` is a module of the design or a testbench of
    sim/frame/ or sim/module/. Raises BuildError.
    """
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder, f"{top}.v")
        if text is None:
            source = build.top_file(top)
        else:
            source.write_text(text)
        return _tree([*includes(config), source], top)


def elaborated(options: list, top: str) -> Counter[str]:
    """{module: number of its instances} of any design, given as Verilator's `options` (files, or
    -F and a file list). Raises BuildError."""
    return _count(_tree(options, top), top)


def structure(config: Config = DEFAULT, top: str = design.TOP) -> str:
    """The elaborated design as text that stays the same where the hardware does.

    Verilator has expanded macros, parameters and generate branches by then. Left out: places in the
    files, and parameters, whose values stand where they are used. Addresses of the tree's nodes
    become numbers in the order of their first appearance. Raises BuildError.
    """
    numbers: dict[str, int] = {}

    def plain(node):
        if isinstance(node, list):
            return [plain(child) for child in node if not _is_parameter(child)]
        if isinstance(node, dict):
            return {key: plain(value) for key, value in node.items() if key != "loc"}
        if isinstance(node, str) and _ADDRESS.fullmatch(node):
            return numbers.setdefault(node, len(numbers))
        return node

    tree = elaborate(top, config)
    return json.dumps([plain(tree["modulesp"]), plain(tree["miscsp"])])


_ADDRESS = re.compile(r"\([A-Z]+\)")


def _is_parameter(node) -> bool:
    return isinstance(node, dict) and node.get("type") == "VAR" and bool(node.get("isParam"))


def _tree(options: list, top: str) -> dict:
    with tempfile.TemporaryDirectory() as folder:
        run_tool(
            [
                build.VERILATOR, "--json-only", "--no-timing", "-Wno-fatal", "-Wno-lint",
                "--Mdir", folder, "--top-module", top, *options,
            ]
        )  # fmt: skip
        return json.loads(Path(folder, f"V{top}.tree.json").read_text())


def instances(
    config: Config = DEFAULT, top: str = design.TOP, text: str | None = None
) -> Counter[str]:
    """{module: number of its instances} below and including `top`, in the configuration `config`.

    The result is cached in build/elaborated/ under the hash of all files that it depends on.
    text: see `elaborate`. Raises BuildError.
    """
    key = digest(
        top,
        text or build.top_file(top),
        generate_header(config) / "phong_config.vh",
        *design.sources(),
        *design.headers(),
    )
    cache = design.BUILD / "elaborated" / f"{top}-{key}.json"
    if not cache.is_file():
        build.replace(cache, json.dumps(_count(elaborate(top, config, text), top)))
    return Counter(json.loads(cache.read_text()))


def _count(tree: dict, top: str) -> Counter[str]:
    """{module: number of its instances} in Verilator's syntax tree."""
    modules = {module["addr"]: module for module in tree["modulesp"]}

    def count(module: dict) -> Counter[str]:
        total = Counter([module.get("origName") or module["name"]])
        for cell in _cells(module["stmtsp"]):
            total += count(modules[cell["modp"]])
        return total

    return count(next(m for m in modules.values() if m["name"] == top))


def _cells(node) -> Iterator[dict]:
    """The instances (nodes of type CELL) anywhere in a part of Verilator's syntax tree."""
    if isinstance(node, dict):
        if node.get("type") == "CELL":
            yield node
        node = list(node.values())
    if isinstance(node, list):
        for child in node:
            yield from _cells(child)
