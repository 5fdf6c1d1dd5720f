# SPDX-License-Identifier: MIT
"""The report of a run as a table for the terminal."""

from __future__ import annotations

from rich.markup import escape
from rich.table import Table

from phong75.scripts.docs.tables import above


def table(report: dict) -> Table:
    """`report` as a table for the terminal."""
    budget, error, wall = report["budget"], report["error"], report["wall_s"]
    width, height = report["size"]
    rows = Table(
        title=f"{escape(report['scene'])}, {report['technique']}, {width} x {height}",
        show_header=False,
        title_style="bold",
    )
    rows.add_column(style="cyan")
    rows.add_column(justify="right")
    rows.add_column(style="dim")

    def count(value):
        return f"{value:,}".replace(",", " ")

    def number(value, form):
        return "-" if value is None else format(value, form)

    def verdict(good):
        return "[green]ok[/]" if good else "[bold red]FAILED[/]"

    rows.add_row("pixels shaded", count(report["pixels"]), f"in {count(report['spans'])} spans")
    if report["lights"] > 1:
        cycles = report["cycles_of_lights"]
        each = f"{cycles} cycles" if cycles > 1 else "1 cycle"
        rows.add_row("lights", count(report["lights"]), f"{each} a pixel")
    if report["illegal_spans"]:
        rows.add_row(
            "illegal spans", count(report["illegal_spans"]), "the error bound does not cover them"
        )
    if report["unsupported"]:
        rows.add_row("unsupported", count(report["unsupported"]), "spans or register writes")
    if report["zero_normals"]:
        rows.add_row("zero vectors", count(report["zero_normals"]), "pixels without a direction")
    if report["degenerate_triangles"]:
        rows.add_row("triangles skipped", count(report["degenerate_triangles"]), "without area")
    if report["lit_facing_away"]:
        rows.add_row(
            "lit, facing away", count(report["lit_facing_away"]), "lit_faces_only = true: dark"
        )
    rows.add_section()
    mismatches = report["compare"]["mismatches"]
    rows.add_row("RTL against model", verdict(not mismatches), f"{count(mismatches)} pixels differ")
    bound = error["bound_lsb"]
    if bound is None:
        rows.add_row("largest error", f"{error['max_lsb']:.4f} LSB", "no bound derived; perfect: ½")
    else:
        wide = error["max_lsb"] <= bound and bound > 1
        rows.add_row(
            "largest error",
            f"{error['max_lsb']:.4f} LSB "
            + ("[yellow]the bound exceeds 1[/]" if wide else verdict(error["max_lsb"] <= bound)),
            f"derived bound {above(bound, 4)}; perfect: ½",
        )
    if report["undecided"]:
        rows.add_row(
            "pixels at a jump", count(report["undecided"]), "the nearer side is the reference"
        )
    rows.add_row("error, RMS", f"{error['rms_lsb']:.4f} LSB", f"99.9 %: {error['p999_lsb']:.4f}")
    rows.add_row(
        "correctly rounded",
        f"{100 * error['correctly_rounded']:.4f} %",
        f"PSNR {number(error['psnr_db'], '.2f')} dB",
    )
    if report["input_error"]:
        given = report["input_error"]
        rows.add_row(
            "against the scene itself",
            f"{given['max_lsb']:.4f} LSB",
            f"RMS {given['rms_lsb']:.4f}",
        )
    rows.add_section()
    rows.add_row(
        "cycles", count(report["cycles"]), f"{number(report['cycles_per_pixel'], '.4f')} a pixel"
    )
    rows.add_row(
        "latency", count(report["latency_cycles"]), f"cycles; stalled {report['stall_cycles']}"
    )
    rows.add_row(
        f"{budget['fps']:g} frames/s, {budget['clock_hz'] / 1e6:g} MHz",
        verdict(budget["met"]),
        f"of {count(budget['cycles_available'])} cycles a frame",
    )
    rows.add_row("fastest", number(budget["max_fps"], ".1f"), "frames/s")
    rows.add_section()
    for name, value in wall.items():
        rows.add_row(name.replace("_", " "), f"{value:.2f} s")
    return rows
