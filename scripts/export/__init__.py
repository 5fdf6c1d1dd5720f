# SPDX-License-Identifier: MIT
"""Exports one configuration as a folder that needs nothing of Phong75: `phong75 export`.

The folder holds the sources without macros and with a prefix on every module name, file lists, a
port table, a stimulus with its expected pixels, and a testbench in plain Verilog. So two exports
can stand in one design.
"""

from __future__ import annotations

import dataclasses
import importlib.metadata
import json
import os
import re
import shutil
from pathlib import Path

import phong75
from phong75.model.analysis import error_budget, pruning
from phong75.model.config import DEFAULT, Config
from phong75.model.frame import Frame, InputError, with_lights
from phong75.model.front.scene import WHITE, Material, Scene, load_scene
from phong75.model.registers import writes
from phong75.model.scene_to_frame import front_end
from phong75.model.twin.core.register_map import unsupported_write
from phong75.model.twin.lights.light_map import unsupported_light_write
from phong75.model.twin.pruning.span_guard import span_guard
from phong75.model.verilog import header
from phong75.scripts import console, options
from phong75.scripts.export import documents, stimulus, verilog
from phong75.sim import design
from phong75.sim.elaborate import instances

#: Size of the stimulus unless one is given.
SIZE = (48, 32)

#: The file that makes a folder an export.
MANIFEST = "export.json"

#: What the commands of an export's README build beside its files.
BUILT = ("obj_dir", "testbench.vvp")

#: Of the default configuration, kept in the checkout for those who take the RTL as it is: its
#: header, and its testbench with the stimulus.
HEADER = design.RTL / "include" / "phong_config.vh"
STIMULUS = stimulus.TESTBENCH.parent
REFRESH = "phong75 export --header"

_PREFIX = re.compile(r"([A-Za-z_]\w*)?", re.ASCII)


def export(
    config: Config,
    out: Path,
    prefix: str | None = None,
    scene: str | None = None,
    size: tuple[int, int] | None = None,
    prune: bool = False,
) -> list[str]:
    """Write the export of `config` into the folder `out`; returns its files, sorted.

    prefix: of every module name; None for the configuration's name. scene: what the stimulus
    shows, by name or path; None for `default_scene`, in lights and materials that `config` can
    show. size: of the
    picture, width and height; None for SIZE, or for the scene's own if `prune` is set. prune: leave
    out of the hardware what this picture does not need, which takes a scene.

    `out` appears whole or not at all. An export that is there is replaced; any other folder that
    is not empty is left alone. The same arguments always give the same files.
    Raises InputError (one line), BuildError.
    """
    out = Path(out)
    _refuse(out)
    if prune and not scene:
        raise InputError("pruning needs a scene: what to keep depends on the picture")
    frame = _frame(scene, size if size or prune else SIZE, config)
    scene = scene or default_scene(config)
    config = with_lights(config, frame)
    if prune:
        name = f"{config.name}-{Path(scene).stem}"
        config = dataclasses.replace(pruning.prune(frame, config)[0], name=name)
    if prefix is None:
        prefix = re.sub(r"\W", "_", config.name, flags=re.ASCII) + "_"
        prefix = f"_{prefix}" if prefix[0].isdigit() else prefix
    if not _PREFIX.fullmatch(prefix):
        raise InputError(f"the prefix `{prefix}` is not the beginning of a Verilog name")
    if not prune:
        _check(frame, config, scene)
    width, height = frame.width, frame.height
    shown = f"{Path(scene).name} at {width}x{height}"
    files = _files(config, prefix, stimulus.thin(frame), shown, prune)
    names = sorted([*files, MANIFEST])
    manifest = {
        "phong75": phong75.__version__,
        "configuration": config.name,
        "prefix": prefix,
        "scene": Path(scene).name,
        "size": [width, height],
        "pruned": prune,
        "fields": config.as_dict(),
        "files": names,
    }
    files[MANIFEST] = json.dumps(manifest, indent=2) + "\n"
    _write_folder(out, files)
    return names


def default_scene(config: Config) -> str:
    """The bundled scene that the stimulus of `config` shows unless another one is named: one that
    uses the lights, normals, curves and jumps of `config`."""
    if config.span_half_vector:
        return "near_light"
    if config.attenuation:
        return "warnock"
    if config.sums_lights:
        return "coloured_lights"
    if config.normal_order == 2:
        return "coarse_torus"
    return "toon" if config.curve_jumps or config.weight_jumps else "still_life"


def _frame(scene: str | None, size: tuple[int, int] | None, config: Config) -> Frame:
    """The frame of `scene`; for None, of `default_scene` as `config` can show it.

    Raises InputError, also if nothing of it is in the picture.
    """
    loaded = load_scene(scene or default_scene(config), size, config=config)
    if scene is None:
        _fit(loaded, config)
    frame = front_end(loaded, config).frame
    if not len(frame.spans):
        raise InputError(f"{scene}: the picture shows nothing, so that there is no stimulus")
    if reason := error_budget.refusal(frame, config):
        raise InputError(reason)
    return frame


def _fit(scene: Scene, config: Config) -> None:
    """Take from `scene` what `config` leaves out: lights, the colours of their highlights, their
    fall, and parts of materials."""
    scene.materials = [_within(material, config) for material in scene.materials]
    scene.two_sided &= config.two_sided
    scene.lights = scene.lights[: config.lights]
    if not config.highlight_colour:
        scene.lights = [dataclasses.replace(light, specular=WHITE) for light in scene.lights]
    if not config.attenuation:
        scene.lights = [
            dataclasses.replace(light, place=dataclasses.replace(light.place, falloff=None))
            for light in scene.lights
        ]


def _within(material: Material, config: Config) -> Material:
    """`material` without what `config` leaves out: colour, a varying W, any W, curves of cos(s)."""
    if not config.has_curves:
        material = dataclasses.replace(material, curve=None, n=max(material.n, 1.0))
    if config.channels == 1:
        material = dataclasses.replace(material, color=(material.color[1],) * 3)
    if not (config.specular and config.weight_function):
        weight = material.weight_values[0] if config.specular else 0.0
        material = dataclasses.replace(material, weight_zn=(0.0, 1.0), weight_values=(weight,) * 2)
    return material


def _check(frame: Frame, config: Config, scene: str) -> None:
    """Raise InputError if `frame` needs what `config` leaves out."""
    if config.spans_carry_squares:
        return
    full = dataclasses.replace(
        config, **{name: getattr(DEFAULT, name) for name in pruning.FEATURES}
    )
    needed = pruning.missing(frame, config, full) if config != full else []
    unsupported = unsupported_light_write if config.sums_lights else unsupported_write
    flagged = config.technique == "phong" and (
        span_guard(frame.spans, config).any()
        or any(unsupported(*write, config) for write in writes(frame, config))
    )
    if needed or flagged:
        why = f": {needed[0]}" if needed else ""
        raise InputError(f"{scene} needs what configuration {config.name} leaves out{why}")


def _files(config: Config, prefix: str, frame: Frame, shown: str, pruned: bool) -> dict[str, str]:
    """{path in the export: text} of everything but the manifest. Raises BuildError."""
    values, present = verilog.macros(config), instances(config)
    version = phong75.__version__
    modules = {file.stem for file in design.sources()}
    modules |= {file.stem for file in design.sources(technology=design.ECP5)}
    files: dict[str, str] = {}

    def put(sources: list[Path]) -> list[str]:
        """Add `sources`; returns where they are in the export."""
        paths = []
        for file in sources:
            folder = "rtl/ecp5" if file.parent == design.ECP5 else "rtl"
            path = f"{folder}/{prefix}{file.name}"
            place = file.relative_to(design.RTL).as_posix()
            origin = f"Phong75 {version}, configuration {config.name}: rtl/{place}, exported"
            files[path] = verilog.export_module(file, config, values, modules, prefix, origin)
            paths.append(path)
        return paths

    about = f"// Phong75 {version}, configuration {config.name}"
    listed = put(verilog.used(present))
    files["rtl.f"] = _listed(f"{about}: the design", listed)
    chip = put(verilog.used(present, design.ECP5))
    ecp5 = chip != listed
    if ecp5:
        files["rtl_ecp5.f"] = _listed(f"{about}: the design for a Lattice ECP5", chip)
    bench = f"sim/{prefix}testbench.v"
    files["testbench.f"] = _listed(f"{about}: the design and its testbench", [*listed, bench])
    given = stimulus.stimulus(frame, config)
    text = verilog.rename(stimulus.testbench(given.numbers), modules | {"testbench"}, prefix)
    files[bench] = text
    files |= {f"sim/{name}": text for name, text in given.files().items()}
    files["ports.md"] = documents.ports_page(config, f"{prefix}phong_pipeline")
    files["README.md"] = documents.readme(config, prefix, version, given, shown, pruned, ecp5)
    files["LICENSE"] = _license()
    return files


def _listed(comment: str, paths: list[str]) -> str:
    return "\n".join([verilog.SPDX, f"{comment}. Paths are relative to this file.", *paths]) + "\n"


def _license() -> str:
    """The text of the licence: of the checkout, or of the installed package."""
    file = design.PACKAGE / "LICENSE"
    if file.is_file():
        return file.read_text()
    for path in importlib.metadata.files("phong75") or ():
        if path.name == "LICENSE":
            return path.read_text()
    raise InputError("the installed package has no LICENSE file")


# -- writing ---------------------------------------------------------------------------------------


def _refuse(out: Path) -> None:
    """Raise InputError if `out` holds something that a new export would destroy."""
    if not out.exists():
        return
    if not out.is_dir():
        raise InputError(f"{out} is a file, not a folder")
    there = {path.name for path in out.iterdir()}
    if not there:
        return
    try:
        known = set(json.loads((out / MANIFEST).read_text())["files"])
    except (OSError, ValueError, KeyError, TypeError):
        raise InputError(f"{out} is not empty and not an export: name another folder") from None
    for path in sorted(out.rglob("*")):
        place = path.relative_to(out)
        if path.is_file() and place.as_posix() not in known and place.parts[0] not in BUILT:
            raise InputError(f"{path} is not part of the export in {out}: move it away first")


def _write_folder(out: Path, files: dict[str, str]) -> None:
    """Put `files` in place of the folder `out`, all at once. Raises InputError."""
    part = out.with_name(f".{out.name}.{os.getpid()}")
    old = out.with_name(f".{out.name}.{os.getpid()}.old")
    try:
        for name, text in files.items():
            path = part / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        if out.exists():
            out.replace(old)
        part.replace(out)
    except OSError as error:
        if old.exists() and not out.exists():
            old.replace(out)
        raise InputError(f"cannot write {out}: {error.strerror}") from None
    finally:
        shutil.rmtree(part, ignore_errors=True)
        shutil.rmtree(old, ignore_errors=True)


# -- what the checkout keeps of the default configuration ------------------------------------------


def kept() -> dict[Path, str]:
    """{file: text} of what the checkout keeps of the default configuration. Raises BuildError."""
    given = stimulus.stimulus(_frame(None, SIZE, DEFAULT), DEFAULT)
    return {
        HEADER: _default_header(),
        stimulus.TESTBENCH: stimulus.testbench(given.numbers),
        **{STIMULUS / name: text for name, text in given.files().items()},
    }


def _default_header() -> str:
    """The header of the default configuration, with a line that says how to renew it."""
    text = header(DEFAULT).removeprefix(verilog.SPDX + "\n")
    return f"{verilog.SPDX}\n// Do not edit: `{REFRESH}` writes this file.\n{text}"


def refresh() -> list[Path]:
    """Write the files of `kept` that are not current; returns these. Raises BuildError."""
    stale = [
        (path, text)
        for path, text in kept().items()
        if not path.is_file() or path.read_text() != text
    ]
    for path, text in stale:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return [path for path, _ in stale]


# -- command line ----------------------------------------------------------------------------------


def renew() -> int:
    """Renew what the checkout keeps and print its paths; returns the exit code."""
    for path in refresh():
        console.say(console.shown(path))
    return console.GOOD


def main(
    config: Config, out: Path | None, prefix: str | None, scene: str | None,
    size: tuple[int, int] | None, prune: str,
) -> int:  # fmt: skip
    """Export, and say where; returns the exit code. Arguments and errors as for `export`.

    prune: as for --prune: the scene to prune to, which the stimulus then shows, or options.SELF for
    the `scene` that is given.
    """
    if out is None:
        raise InputError("--out is missing: the folder to write")
    prune = options.prune_scene(prune)
    if prune and prune != options.SELF:
        if scene not in (None, prune):
            raise InputError(f"--prune {prune} shows that scene: leave out --scene {scene}")
        scene = prune
    names = export(config, out, prefix, scene, size, bool(prune))
    console.say(f"{out}: {len(names)} files; README.md says how to simulate and integrate them")
    return console.GOOD
