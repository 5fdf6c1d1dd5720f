# SPDX-License-Identifier: MIT
"""Clocks a second of the simulation, pixels a second of the twin and triangles a second of mesh
files: `phong75 bench`.

The two ways to simulate run in turns, several times, on the same frame: under cocotb as `phong75
run` does it, through files, and in a bare Verilator C++ loop that feeds the pipeline from memory.
What counts is their ratio; the best of each is taken, since other work on the machine only slows
down.
"""

from __future__ import annotations

import dataclasses
import json
import os
import re
import struct
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
from rich.table import Table

from phong75.model import twin
from phong75.model.config import DEFAULT as CONFIG
from phong75.model.config import Config
from phong75.model.frame import Frame
from phong75.model.front.mesh_files.load import load_mesh_file
from phong75.model.front.scene import load_scene
from phong75.model.registers import writes
from phong75.model.scene_to_frame import front_end
from phong75.model.spans import pack, record_bits, span_fields
from phong75.model.twin.core.phong_unit import interpolate, shade
from phong75.model.twin.core.span_walker import BLOCK, span_walker
from phong75.scripts import console, recorded
from phong75.sim import compiled_twin
from phong75.sim.build import Bench
from phong75.sim.design import BUILD
from phong75.sim.frame.run_frame import SimJob, simulate_jobs

ROUNDS = 5
SCENE, SIZE = "teapot", (640, 480)
COPIES = 8  # frames a measurement, so that it lasts long enough
MESH_STEPS, MESH_ROUNDS = (1024, 512), 3  # a torus of 1024 x 512 quads


def repeated(frame: Frame, copies: int) -> Frame:
    """`copies` times `frame` in one, for a run that lasts long enough."""
    spans = np.tile(frame.spans, copies)
    spans["last"][:-1] = False
    return dataclasses.replace(frame, spans=spans)


def write_bare(frame: Frame, config: Config, file: Path) -> Path:
    """Write `frame` for the bare loop of sim/main.cpp, which says what is in `file`; returns it."""
    words = record_bits(config) // 32
    spans = pack(frame.spans, config)
    spans = np.frombuffer(spans, ">u4").reshape(-1, words)[:, ::-1]
    written = writes(frame, config)
    last_bit = span_fields(config)[-1].lsb
    pixels = int(frame.spans["length"].sum())
    head = [len(written)]
    for address, word in written:
        head += [address, word & 0xFFFFFFFF, word >> 32]
    head += [len(spans), words, last_bit, pixels]
    file.write_bytes(np.array(head, "<u4").tobytes() + spans.astype("<u4").tobytes())
    return file


def bare(bench: Bench, file: Path) -> float:
    """Clocks a second of the bare loop on what `write_bare` wrote: the pipeline alone."""
    said = subprocess.run(
        [bench.make() / "phong_pipeline", "--bare", file],
        check=True, text=True, stdout=subprocess.PIPE,
    ).stdout  # fmt: skip
    clocks, seconds = re.search(r"clocks (\d+) seconds ([\d.]+)", said).groups()
    return int(clocks) / float(seconds)


def under_cocotb(bench: Bench, frame) -> float:
    """Clocks a second under cocotb on `frame`, from its start until cocotb has the result."""
    result = simulate_jobs([SimJob(frame)], CONFIG, bench)[0]
    return result.cycles / result.simulate_s


def model_seconds(count: int) -> float:
    """Seconds of the twin's pixel stages for `count` lit pixels of one material, best of five."""
    frame = front_end(load_scene("sphere", SIZE)).frame
    span, k, *_ = span_walker(frame.spans, 0, int(frame.spans["length"].sum()), CONFIG)
    normal, _ = interpolate(frame.spans, span, k, CONFIG)
    normal = np.resize(normal.T, (count, 3)).T.copy()
    material = np.resize(frame.spans["material"][span].astype(np.int64), count)
    best = float("inf")
    for _ in range(ROUNDS):
        start = time.perf_counter()
        for first in range(0, count, BLOCK):
            block = slice(first, first + BLOCK)
            shade(normal[:, block], material[block], frame, CONFIG)
        best = min(best, time.perf_counter() - start)
    return best


def twin_rates(frame) -> dict[str, float]:
    """Pixels a second of `frame` by the twin in numpy and by the compiled one, both in turn, best
    of several rounds."""
    best = {"numpy": float("inf"), "compiled": float("inf")}
    pixels = len(compiled_twin.render(frame, CONFIG))  # compiled by now
    for _ in range(ROUNDS):
        for name, render in (("numpy", twin.render), ("compiled", compiled_twin.render)):
            start = time.perf_counter()
            render(frame, CONFIG)
            best[name] = min(best[name], time.perf_counter() - start)
    return {name: pixels / seconds for name, seconds in best.items()}


def write_torus(path: Path, segments: int, sides: int) -> int:
    """Write a torus of 2 `segments` `sides` triangles as OBJ, binary PLY, binary STL or GLB.

    Returns the number of triangles. The file has no normals, and is written in pieces because it
    may be large.
    """
    around = np.arange(segments + 1) * 2 * np.pi / segments
    about = np.arange(sides + 1) * 2 * np.pi / sides
    around[-1], about[-1] = 0.0, 0.0  # the same points at the seams, to the bit
    radius, height = 1 + 0.4 * np.cos(about), 0.4 * np.sin(about)
    index = np.arange(sides)
    points, triangles = segments * sides, 2 * segments * sides

    def ring(k: int) -> np.ndarray:
        """The points of ring k, the first of them at its end once more: float32[sides + 1, 3]."""
        x, y = np.cos(around[k]) * radius, np.sin(around[k]) * radius
        return np.column_stack([x, y, height]).astype("<f4")

    def faces(k: int) -> np.ndarray:
        """The points of the triangles between ring k and the next one: uint32[2 sides, 3]."""
        a, b = k * sides, (k + 1) % segments * sides
        quads = [a + index, b + index, b + (index + 1) % sides, a + (index + 1) % sides]
        corners = np.stack([quads[i] for i in (0, 1, 2, 0, 2, 3)], axis=1)
        return corners.reshape(-1, 3).astype("<u4")

    with open(path, "wb") as file:
        if path.suffix == ".stl":
            file.write(b" " * 80 + np.uint32(triangles).astype("<u4").tobytes())
            kind = [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")]
            for k in range(segments):
                a, b = ring(k), ring(k + 1)
                records = np.zeros(2 * sides, kind)
                records["corners"][::2] = np.stack([a[:-1], b[:-1], b[1:]], axis=1)
                records["corners"][1::2] = np.stack([a[:-1], b[1:], a[1:]], axis=1)
                file.write(records.tobytes())
            return triangles
        if path.suffix == ".obj":
            for k in range(segments):
                np.savetxt(file, ring(k)[:-1], "v %.6f %.6f %.6f")
            for k in range(segments):
                np.savetxt(file, faces(k) + 1, "f %d %d %d")
            return triangles
        if path.suffix == ".ply":
            axes = "".join(f"property float {axis}\n" for axis in "xyz")
            file.write(
                f"ply\nformat binary_little_endian 1.0\nelement vertex {points}\n{axes}"
                f"element face {triangles}\nproperty list uchar uint vertex_indices\n"
                "end_header\n".encode()
            )
        else:
            file.write(_glb_head(points, triangles))
        for k in range(segments):
            file.write(ring(k)[:-1].tobytes())
        for k in range(segments):
            corners = faces(k)
            if path.suffix == ".ply":
                rows = np.full(len(corners), 3, [("count", "u1"), ("corners", "<u4", 3)])
                rows["corners"] = corners
                corners = rows
            file.write(corners.tobytes())
    return triangles


def _glb_head(points: int, triangles: int) -> bytes:
    """The bytes of a GLB file before the points and the indices of its one mesh."""
    sizes = 12 * points, 12 * triangles
    ends = [1.5, 1.5, 0.5]
    root = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": points, "type": "VEC3",
             "min": [-end for end in ends], "max": ends},
            {"bufferView": 1, "componentType": 5125, "count": 3 * triangles, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": sizes[0]},
                        {"buffer": 0, "byteOffset": sizes[0], "byteLength": sizes[1]}],
        "buffers": [{"byteLength": sum(sizes)}],
    }  # fmt: skip
    text = json.dumps(root).encode()
    text += b" " * (-len(text) % 4)
    length = 12 + 8 + len(text) + 8 + sum(sizes)
    return b"".join([
        struct.pack("<4sII", b"glTF", 2, length), struct.pack("<I4s", len(text), b"JSON"), text,
        struct.pack("<I4s", sum(sizes), b"BIN\0"),
    ])  # fmt: skip


def mesh_rates() -> dict[str, float]:
    """Triangles a second from a mesh file to triangles with normals, the best of several rounds,
    by the suffix of the file."""
    rates = {}
    with tempfile.TemporaryDirectory(dir=BUILD) as name:
        for suffix in ("obj", "ply", "stl", "glb"):
            path = Path(name) / f"torus.{suffix}"
            count = write_torus(path, *MESH_STEPS)
            best = float("inf")
            for k in range(MESH_ROUNDS):
                console.phase(f"{suffix}, {count} triangles, round {k + 1} of {MESH_ROUNDS}")
                start = time.perf_counter()
                load_mesh_file(path)
                best = min(best, time.perf_counter() - start)
            rates[suffix] = count / best
    return rates


def main(record: bool) -> int:
    """Measure and print; the numbers also go to build/bench.json. Returns the exit code.

    Raises BuildError, SimulationError.
    """
    recorded.check(record)
    frame = repeated(front_end(load_scene(SCENE, SIZE)).frame, COPIES)
    pipeline, bench = Bench("phong_pipeline", CONFIG), Bench("frame_bench", CONFIG)
    pipeline.make(console.phase)
    bench.make(console.phase)
    rates: dict[str, list[float]] = {"bare": [], "cocotb": []}
    with tempfile.TemporaryDirectory(dir=BUILD) as name:
        file = write_bare(frame, CONFIG, Path(name) / "bare")
        for k in range(ROUNDS):
            console.phase(f"round {k + 1} of {ROUNDS}")
            rates["bare"].append(bare(pipeline, file))
            rates["cocotb"].append(under_cocotb(bench, frame))
    pixels = SIZE[0] * SIZE[1]
    console.phase("the model alone")
    seconds = model_seconds(pixels)
    console.phase("the twin, in numpy and compiled")
    twins = twin_rates(frame)
    meshes = mesh_rates()
    best = {name: max(values) for name, values in rates.items()}
    found = {
        "simulation": {
            "scene": SCENE, "size": SIZE, "frames": COPIES,
            "bare_clocks_per_s": round(best["bare"]),
            "cocotb_clocks_per_s": round(best["cocotb"]),
            "ratio": round(best["cocotb"] / best["bare"], 3),
        },
        "model": {"pixels": pixels, "seconds": round(seconds, 4), "fps": round(1 / seconds, 1)},
        "twin_pixels_per_s": {name: round(rate) for name, rate in twins.items()},
        "mesh_triangles_per_s": {suffix: round(rate) for suffix, rate in meshes.items()},
        "cpus": os.cpu_count(),
    }  # fmt: skip
    (BUILD / "bench.json").write_text(json.dumps(found, indent=2) + "\n")
    table = Table(title=f"{SCENE} {SIZE[0]}x{SIZE[1]}, best of {ROUNDS}")
    table.add_column("what")
    table.add_column("rate", justify="right")
    table.add_row("bare Verilator loop", f"{best['bare'] / 1e6:.2f} Mclock/s")
    table.add_row("under cocotb", f"{best['cocotb'] / 1e6:.2f} Mclock/s")
    table.add_row("ratio (1/3 at least)", f"{best['cocotb'] / best['bare']:.2f}")
    table.add_row(f"model, {pixels} lit pixels, one core", f"{1 / seconds:.1f} frames/s")
    table.add_row("twin in numpy, with the walk", f"{twins['numpy'] / 1e6:.1f} Mpixel/s")
    table.add_row("twin compiled", f"{twins['compiled'] / 1e6:.1f} Mpixel/s")
    table.add_row("ratio (3 at least)", f"{twins['compiled'] / twins['numpy']:.1f}")
    for suffix, rate in meshes.items():
        table.add_row(f"reading {suffix.upper()}", f"{rate / 1e3:.0f} thousand triangles/s")
    console.show(table)
    if record:
        recorded.record(
            "bench", "make bench", ("verilator", "cocotb", "numpy", "cmeel-assimp"),
            {"cocotb_to_bare": found["simulation"]["ratio"],
             "model_frames_per_s": found["model"]["fps"],
             "compiled_to_numpy": round(twins["compiled"] / twins["numpy"], 2),
             "mesh_triangles_per_s": found["mesh_triangles_per_s"]},
            {"rounds": ROUNDS},
        )  # fmt: skip
    return console.GOOD
