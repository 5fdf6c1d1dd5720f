# SPDX-License-Identifier: MIT
"""The twin compiled: the same pixels as `phong75.model.twin.render`, several times as fast.

The C++ text is generated from the functions of the twin (`phong75.model.dataflow`) and compiled
once for each configuration and number of lights, which takes about two seconds. That pays for many
frames. The twin in numpy stays the definition; tests/test_compiled_twin.py compares both.
"""

from __future__ import annotations

import ctypes
import functools
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np

from phong75.model.arrays import Ints
from phong75.model.config import DEFAULT, Config
from phong75.model.dataflow import cpp
from phong75.model.dataflow.trace import Program, arguments, trace
from phong75.model.frame import Frame, fitted, walked, with_lights
from phong75.model.twin import Pixels
from phong75.model.twin.core.span_walker import pixel_count
from phong75.sim import build
from phong75.sim.build import silent

#: Integers wrap as numpy's do. No native instructions: a cached build may move to another machine.
CXX_FLAGS = ("-std=c++20", "-O3", "-fwrapv", "-fno-trapping-math", "-fPIC", "-shared")


class CompiledTwin:
    """The compiled twin of one configuration, for frames of a number of lights.

    program: what was compiled. library: the file.
    """

    def __init__(self, config: Config, lights: int = 1, progress: Callable[[str], None] = silent):
        """Compile if necessary. progress: called with what a phase does before each that takes
        seconds. Raises BuildError, InputError (see `trace`)."""
        self.config, self.lights = config, lights
        self.program: Program = trace(config, lights)
        text = cpp.source(self.program)
        key = build.digest(text, *CXX_FLAGS)
        self.library: Path = build.BUILD / "compiled" / f"{config.name}-{key}.so"
        with build.locked(self.library):
            if not self.library.is_file():
                progress("compiling the twin (once)")
                self._compile(text)
        self._shade = ctypes.CDLL(str(self.library)).shade
        self._shade.restype = None

    def _compile(self, text: str) -> None:
        file = self.library.with_suffix(".cpp")
        build.replace(file, text)
        part = self.library.with_suffix(f".{os.getpid()}")
        build.run_tool(["g++", *CXX_FLAGS, file, "-o", part])
        part.replace(self.library)

    def render(self, frame: Frame) -> Pixels:
        """All pixels of `frame`, as `twin.render` gives them in this configuration."""
        assert frame.lights == self.lights, f"compiled for {self.lights} lights"
        given = arguments(frame, self.config)
        memories = [np.ascontiguousarray(given[name], np.int64) for name in self.program.memories]
        scalars = np.array([given[name] for name in self.program.scalars], np.int64)
        spans = frame.spans
        length = walked(spans)
        end = np.cumsum(length)
        total = pixel_count(spans)
        column, codes = np.empty(total, np.int64), np.empty((total, 3), np.int64)
        pointers = (ctypes.c_void_p * max(1, len(memories)))(*map(_address, memories))
        self._shade(
            pointers, _address(scalars), _address(length), ctypes.c_int64(len(spans)),
            _address(column), _address(codes),
        )  # fmt: skip
        last = np.zeros(total, bool)
        last[end - 1] = spans["last"]
        return Pixels(column, np.repeat(spans["y"].astype(np.int64), length), codes, last)


def _address(array: Ints) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


@functools.cache
def compiled(config: Config, lights: int = 1) -> CompiledTwin:
    """The compiled twin of `config`, loaded once per process. Raises BuildError, InputError."""
    return CompiledTwin(config, lights)


def render(frame: Frame, config: Config = DEFAULT) -> Pixels:
    """All pixels of `frame`: the same as `twin.render(frame, config)`, by the compiled twin.

    Raises BuildError, InputError as `CompiledTwin` and `twin.render`.
    """
    config = fitted(config, frame) if config == DEFAULT else config
    config = with_lights(config, frame)
    return compiled(config, frame.lights).render(frame)
