# SPDX-License-Identifier: MIT
"""The command line `phong75`: its commands, what each accepts, and whom it calls.

A command imports what it needs when it is called, so that help and completion are quick.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
import typer.core

from phong75.scripts import console, options


class OneLineErrors(typer.core.TyperGroup):
    """A group of commands whose errors are one line, and whose results are exit codes."""

    def main(self, *arguments: Any, standalone_mode: bool = True, **more: Any) -> Any:
        """Run the command line; ends the program unless `standalone_mode` is False."""
        run = super().main
        code = console.exit_code(lambda: run(*arguments, standalone_mode=False, **more))
        if standalone_mode:
            sys.exit(code)
        return code


#: How every command line of the project looks: plain help, no boxes, no tracebacks in colour.
STYLE: dict[str, Any] = {
    "context_settings": {"help_option_names": ["-h", "--help"]},
    "rich_markup_mode": None,
    "pretty_exceptions_enable": False,
}

app = typer.Typer(
    name="phong75",
    cls=OneLineErrors,
    help="Phong's 1975 shading hardware: render, compare, measure, synthesize, prove.",
    epilog="Exit codes: 0; 1 a pixel differs or a bound is missed; 2 wrong input or set-up.",
    **STYLE,
)


def main(arguments: Sequence[str]) -> int:
    """Run the command line `arguments` (without the program's name); returns the exit code."""
    return app(list(arguments), prog_name="phong75", standalone_mode=False)


def single(command: Callable[..., int], arguments: Sequence[str], name: str) -> int:
    """Run a program `name` that has one `command` with the command line `arguments`; returns the
    exit code. For the campaigns in tests/, whose options are declared like those here."""
    program = typer.Typer(add_completion=False, **STYLE)
    program.command()(command)
    return console.exit_code(
        lambda: program(list(arguments), prog_name=name, standalone_mode=False)
    )


def _version(wanted: bool) -> None:
    if wanted:
        from phong75 import __version__

        console.say(f"phong75 {__version__}")
        raise typer.Exit()


@app.callback(invoke_without_command=True)
def phong75(
    context: typer.Context,
    version: Annotated[
        bool,
        typer.Option("--version", help="Show the version.", callback=_version, is_eager=True),
    ] = False,
) -> None:
    """What comes before a command."""
    if context.invoked_subcommand is None:
        console.say(context.get_help())


# -- pictures --------------------------------------------------------------------------------------


@app.command()
def run(
    scene: options.Scene = "teapot",
    size: options.AnySize = None,
    technique: options.Technique = None,
    config: options.ConfigName = None,
    units: options.Units = 1,
    fps: options.Fps = 30,
    clock: options.Clock = 200,
    prune: options.Prune = "",
    spans: options.Spans = None,
    out: options.Out = None,
) -> int:
    """Render a scene through the RTL and the model, and compare.

    Writes frame.png, reference.png, error.png, spans and report.json into --out, by default
    build/NAME of the scene. Exit code 1 if a pixel differs, or the cycle budget or the error bound
    is missed.
    """
    from phong75.scripts import run as engine

    return engine.main(
        engine.request(
            scene=scene,
            spans=spans,
            size=size,
            config=options.configuration(technique, config),
            units=units,
            fps=fps,
            clock_mhz=clock,
            prune=prune,
            out=out,
        )
    )


@app.command()
def compare(
    scene: options.Scene = "teapot",
    size: options.AnySize = None,
    clock: options.Clock = 200,
    out: options.Out = None,
    record: options.Record = False,
) -> int:
    """Shade a scene in every way, side by side on one sheet.

    Flat, Gouraud, Phong and others, each through its RTL: pictures, cycles, hardware, error, and
    the difference from the true surface. Writes sheet.png and comparison.json into --out, by
    default build/NAME-compare. Exit code 1 if a pixel differs or an error bound is missed.
    --record is for the scene and the size that the documentation shows.
    """
    from phong75.scripts import compare as engine

    return engine.main(engine.request(scene, size, clock, out), record)


@app.command()
def prune(
    scene: Annotated[
        str,
        typer.Argument(
            metavar="SCENE",
            help="A bundled scene, the path of a scene file or a mesh, or `all`.",
            autocompletion=options.scenes,
        ),
    ] = "teapot",
    size: options.AnySize = None,
    seeds: options.SeedsOrNone = 3,
    gates: options.Gates = False,
    record: options.Record = False,
) -> int:
    """Show what a scene needs of the pipeline, and why.

    `all` measures what that saves, for every bundled scene (hours); --seeds, --gates and --record
    are for it.
    """
    from phong75.scripts import prune as engine

    if scene == "all":
        return engine.measure_all(seeds, gates, record)
    return engine.main(scene, size)


@app.command()
def scenes(record: options.Record = False) -> int:
    """Measure every bundled scene at three sizes.

    Pixels, cycles, errors and frames a second at 512x512, 640x480 and 1920x1080.
    """
    from phong75.scripts import scene_results

    return scene_results.main(record)


@app.command()
def convert(
    scene: Annotated[
        Path, typer.Argument(metavar="SCENE", help="A scene file of lecture notes (.scn).")
    ],
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE", help="The TOML file; default: beside SCENE."),
    ] = None,
) -> int:
    """Write a scene file of lecture notes (.scn, .des) as a TOML scene file."""
    from phong75.scripts import convert as engine

    return engine.main(scene, out)


@app.command()
def report() -> int:
    """Write one page of all results, build/report/index.html.

    Bundled scenes without a current result are run first. A part whose data is missing names the
    command that makes it.
    """
    console.require("page", "jinja2", "plotly")
    from phong75.scripts.page import report as engine

    return engine.main()


@app.command()
def configs() -> int:
    """List the names that --config takes."""
    from phong75.scripts.configurations import GROUPS

    for title, group in GROUPS.items():
        console.say(f"{title}:")
        for name in group:
            console.say(f"  {name}")
    return console.GOOD


# -- studies ---------------------------------------------------------------------------------------


@app.command()
def sweep(
    area: Annotated[
        bool, typer.Option("--area", help="Synthesize each configuration, too, for its size.")
    ] = False,
    route: Annotated[
        str,
        typer.Option(
            "--route",
            metavar="NAMES",
            help="Place and route these configurations (name,name or `all`) for their clocks; "
            "all take 2 hours. Else the clocks kept in results/ count, while they hold.",
            autocompletion=options.configs,
        ),
    ] = "",
    record: options.Record = False,
) -> int:
    """Measure error, run time and hardware over widths and methods.

    Tables and charts go to build/sweep/. Runs `tessellation`, too.
    """
    from phong75.scripts.studies import sweep as engine
    from phong75.scripts.studies import tessellation_runs

    return max(engine.main(area, engine.names(route), record), tessellation_runs.main(record))


@app.command()
def tessellation(record: options.Record = False) -> int:
    """Measure the error against true surfaces (a minute).

    Also Mach bands, flicker and orientation, as Phong (1975) argues for interpolated normals.
    """
    from phong75.scripts.studies import tessellation_runs

    return tessellation_runs.main(record)


@app.command()
def stability(record: options.Record = False) -> int:
    """Run stiff and extreme cases: error, bound, RTL against model."""
    from phong75.scripts import stability as engine

    return engine.main(record)


@app.command()
def adversarial(
    record: Annotated[
        bool,
        typer.Option(
            "--record",
            help="Keep an input that is worse than the kept one; `stability` replays it.",
        ),
    ] = False,
) -> int:
    """Search for the input with the largest error."""
    from phong75.scripts import adversarial as engine

    return engine.main(record)


@app.command()
def prove(
    config: options.ConfigName = None,
    again: Annotated[
        bool,
        typer.Option("--again", help="Exhaust cos(s)^n, too, though its errors are recorded."),
    ] = False,
    methods: Annotated[
        bool,
        typer.Option("--methods", help="Certify the other methods with the powers of the default."),
    ] = False,
    record: options.Record = False,
) -> int:
    """Certify the largest error of a colour, over all inputs.

    1/sqrt and cos(s)^n are exhausted; branch and bound with intervals that are rounded outward
    covers all normals, directions of the eye, exponents and coefficients. Exit code 1 if a
    certified bound is too far above the worst input that `adversarial` found; the message says how
    far that may be.
    """
    from phong75.scripts import prove as engine

    if methods:
        return engine.methods(record)
    return engine.main(options.configuration(None, config), again, record)


# -- hardware --------------------------------------------------------------------------------------


@app.command()
def synth(
    config: options.ConfigName = None,
    prune: Annotated[
        str,
        typer.Option(
            "--prune",
            metavar="SCENE",
            help="Build only what this SCENE needs.",
            autocompletion=options.scenes,
        ),
    ] = "",
    grade: options.Grade = 6,
    seeds: options.SeedsOrNone = 3,
    gates: options.Gates = False,
    record: options.Record = False,
) -> int:
    """Synthesize, place and route for a Lattice ECP5.

    Writes build/synth/NAME/report.json.
    """
    from phong75.scripts import synth as engine

    return engine.main(
        engine.pruned(options.configuration(None, config), prune), grade, seeds, gates, record
    )


@app.command()
def netlist(record: options.Record = False) -> int:
    """Run whole frames through the netlist in ECP5 cells."""
    from phong75.scripts import netlist as engine

    return engine.main(record)


@app.command()
def formal(
    proofs: Annotated[
        list[str] | None, typer.Argument(metavar="PROOF", help="Names of proofs; else all.")
    ] = None,
    fast: Annotated[bool, typer.Option("--fast", help="Only the fast ones.")] = False,
    record: options.Record = False,
) -> int:
    """Prove flow control and interpolators; broken designs must fail."""
    from phong75.scripts import formal as engine

    return engine.main(proofs or [], fast, record)


@app.command()
def activity(record: options.Record = False) -> int:
    """Count register toggles a pixel of every bundled scene."""
    from phong75.scripts import activity as engine

    return engine.main(record)


@app.command()
def waves(
    module: Annotated[
        str,
        typer.Argument(metavar="MODULE", help="A module of rtl/.", autocompletion=options.modules),
    ] = "phong_pipeline",
    config: options.ConfigName = None,
) -> int:
    """Write a waveform of a short run, grouped for GTKWave."""
    from phong75.scripts import waves as engine

    return engine.main(module, options.configuration(None, config))


@app.command()
def export(
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder of the export.")
    ] = None,
    config: options.ConfigName = None,
    prefix: Annotated[
        str | None,
        typer.Option(
            "--prefix",
            metavar="TEXT",
            help="Beginning of every module name; default: the name of the configuration.",
        ),
    ] = None,
    scene: Annotated[
        str | None,
        typer.Option(
            "--scene",
            metavar="SCENE",
            help="What the stimulus shows: a bundled scene, or the path of a scene or a mesh.",
            autocompletion=options.scenes,
        ),
    ] = None,
    size: options.AnySize = None,
    prune: options.Prune = "",
    header: Annotated[
        bool, typer.Option("--header", help="Renew the generated files that the checkout keeps.")
    ] = False,
) -> int:
    """Write a configuration as a folder of plain Verilog, with a testbench and its stimulus."""
    from phong75.scripts import export as engine

    if header:
        return engine.renew()
    return engine.main(options.configuration(None, config), out, prefix, scene, size, prune)


@app.command()
def bench(record: options.Record = False) -> int:
    """Measure the speed of the simulation and of the model."""
    from phong75.scripts import benchmark

    return benchmark.main(record)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
