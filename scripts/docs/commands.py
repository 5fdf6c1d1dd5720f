# SPDX-License-Identifier: MIT
"""The reference of the command line, as Markdown: from the definitions of `phong75` and from the
Makefile."""

from __future__ import annotations

import re

import typer
from typer.core import TyperArgument, TyperCommand, TyperGroup

from phong75.scripts.docs.tables import markdown
from phong75.scripts.main import app
from phong75.sim.design import PACKAGE


def commands() -> str:
    """Every command of `phong75`: what it does, its arguments and options."""
    group = typer.main.get_command(app)
    assert isinstance(group, TyperGroup)
    parts = []
    for name, command in sorted(group.commands.items()):
        parts.append(_command(name, command))
    return "\n\n".join(parts)


def _command(name: str, command: TyperCommand) -> str:
    arguments = [p for p in command.params if isinstance(p, TyperArgument)]
    usage = " ".join([f"phong75 {name}", *(f"[{a.metavar or a.name.upper()}]" for a in arguments)])
    text = " ".join((command.help or "").split("\b")[0].split())
    rows = []
    for parameter in command.params:
        if isinstance(parameter, TyperArgument):
            title = parameter.metavar or parameter.name.upper()
        else:
            value = "" if getattr(parameter, "is_flag", False) else f" {parameter.metavar or ''}"
            title = f"{', '.join(parameter.opts)}{value}".strip()
        shown = parameter.default not in (None, False, "", ()) and not callable(parameter.default)
        default = f"`{parameter.default}`" if shown else ""
        rows.append((f"`{title}`", default, parameter.help or ""))
    table = markdown(("option", "default", "meaning"), rows, left=3) if rows else ""
    return f"### `{usage}`\n\n{text}" + (f"\n\n{table}" if table else "")


def targets() -> str:
    """Every target of the Makefile that takes variables, and those variables."""
    makefile = (PACKAGE / "Makefile").read_text()
    taken = re.findall(r"^variables_([\w-]+) := (.*)$", makefile, re.MULTILINE)
    rows = ((f"`make {name}`", " ".join(f"`{v}=`" for v in given.split())) for name, given in taken)
    return markdown(("target", "variables"), rows, left=2)
