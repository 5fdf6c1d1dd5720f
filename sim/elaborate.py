"""What a configuration is made of: the instances that Verilator elaborates."""

from __future__ import annotations

import json
import tempfile
from collections import Counter
from collections.abc import Iterator

from phong75.model.config import DEFAULT, Config
from phong75.sim import design
from phong75.sim.build import generate_header, run_tool


def includes(config: Config = DEFAULT) -> list[str]:
    """The options that name the folders of the header of `config` and of the design."""
    return [f"-I{folder}" for folder in (generate_header(config), *design.folders())]


def instances(config: Config = DEFAULT, top: str = "phong_pipeline") -> Counter[str]:
    """How many instances of each module there are in `top`, itself included. Raises BuildError."""
    return elaborated([*includes(config), design.module_file(top)], top)


def elaborated(options: list, top: str) -> Counter[str]:
    """The same as `instances` for whatever design Verilator's `options` give. Raises BuildError."""
    with tempfile.TemporaryDirectory() as folder:
        run_tool(
            [
                "verilator", "--json-only", "--no-timing", "-Wno-fatal", "--Mdir", folder,
                "--top-module", top, *options,
            ]
        )  # fmt: skip
        with open(f"{folder}/V{top}.tree.json") as file:
            modules = {module["addr"]: module for module in json.load(file)["modulesp"]}

    def count(module: dict) -> Counter[str]:
        found = Counter([module.get("origName") or module["name"]])
        for cell in _cells(module["stmtsp"]):
            found += count(modules[cell["modp"]])
        return found

    return count(next(m for m in modules.values() if m["name"] == top))


def _cells(node) -> Iterator[dict]:
    """The instances somewhere in a tree of Verilator's."""
    if isinstance(node, dict):
        if node.get("type") == "CELL":
            yield node
        node = list(node.values())
    if isinstance(node, list):
        for child in node:
            yield from _cells(child)
