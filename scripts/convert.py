# SPDX-License-Identifier: MIT
"""Write a scene file of the lecture notes as a TOML scene file: `phong75 convert`."""

from __future__ import annotations

import os
from pathlib import Path

import tomli_w

from phong75.model.frame import InputError
from phong75.model.front import notes
from phong75.scripts import console


def main(scene: Path, out: Path | None) -> int:
    """Convert `scene` to `out`, by default beside it; returns the exit code. Raises InputError.

    Mesh files stay where they are; `out` names them relative to its own folder.
    """
    out = out or scene.with_suffix(".toml")
    if out.exists():
        raise InputError(f"--out {out} exists: name another file, or remove it")
    table, remarks = notes.scene_table(scene)
    for item in table["objects"]:
        item["mesh"] = os.path.relpath(scene.parent / item["mesh"], out.parent)
    head = "".join(f"# {line}\n" for line in (f"From {scene.name}.", *remarks))
    text = head + "\n" + tomli_w.dumps(table)
    try:
        out.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"cannot write --out {out}: {error.strerror}") from None
    for remark in remarks:
        console.note(remark)
    console.say(str(out))
    return console.GOOD
