# SPDX-License-Identifier: MIT
"""The waveform of frame_bench: spans and pixels split into fields, written as FST.

Verilator writes a VCD file. This module copies it into an FST file and adds two scopes to
frame_bench: `span` has the fields of s_data (model.spans.span_fields), `pixel` those of m_data. The
fields are signals of the file, so every viewer shows them by name.

pylibfst, which brings GTKWave's FST library, is pinned for Linux. Where it is not installed the
copy is a VCD file with the same signals.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from phong75.model.config import Config
from phong75.model.spans import span_fields

BENCH = "frame_bench"
#: Words of the bench, and the scope with the fields of each.
SPAN, PIXEL = "s_data", "m_data"
SCOPES = {"span": SPAN, "pixel": PIXEL}


@dataclass(frozen=True)
class Field:
    """Bits [lsb + bits - 1 : lsb] of a word; fraction: of them, the bits behind the binary point.

    signed: two's complement.
    """

    name: str
    lsb: int
    bits: int
    signed: bool = False
    fraction: int = 0

    def of(self, word: str) -> str:
        """The field of a word, both in binary digits; leading zeros of `word` may be left out."""
        return word.zfill(self.lsb + self.bits)[::-1][self.lsb : self.lsb + self.bits][::-1]


def fields(config: Config) -> dict[str, list[Field]]:
    """The fields of a span and of a pixel, {scope: fields in the order of reading}."""
    span = []
    for name, lsb, bits in span_fields(config):
        if name == "last":  # stands in s_last
            continue
        signed = name.startswith(("start_", "step_", "half_"))
        word = config.normal
        if name.startswith("half_"):
            word = config.half_vector
        elif "_depth" in name:
            word = config.depth
        fraction = word.fraction if signed and bits == word.bits else 0
        span.append(Field(name, lsb, bits, signed, fraction))
    colour, place = config.colour_bits, config.coordinate_bits
    pixel = [
        Field("x", 3 * colour, place),
        Field("y", 3 * colour + place, place),
        *(Field(name, k * colour, colour) for k, name in ((2, "red"), (1, "green"), (0, "blue"))),
    ]
    first = [f for f in span if f.name in ("x", "y", "length", "material")]
    return {"span": [*first, *(f for f in span if f not in first)], "pixel": pixel}


@dataclass(frozen=True)
class Signal:
    """A signal of a VCD file: its code there, its kind (wire, parameter), its width in bits, its
    name, and its range, such as [7:0], which is empty for a single bit."""

    code: str
    kind: str
    bits: int
    name: str
    range: str

    @property
    def shown(self) -> str:
        """Name and range as a viewer shows them."""
        return self.name + self.range


@dataclass
class Scope:
    """An instance in the waveform: its path, its signals, and the scopes in it."""

    path: str
    signals: list[Signal] = field(default_factory=list)
    scopes: list[Scope] = field(default_factory=list)

    @property
    def name(self) -> str:
        """The last part of the path."""
        return self.path.rpartition(".")[2]

    def walk(self) -> Iterator[Scope]:
        """This scope and all below it."""
        yield self
        for scope in self.scopes:
            yield from scope.walk()


@dataclass
class Waveform:
    """A waveform: its file, the scopes of its top level, and the times of two events.

    Times are in units of `timescale` ("1ps"), None if the event never happens. period: of the
    clock. first_span: the pipeline accepts a span. first_pixel: it offers one that is taken.
    """

    path: Path
    timescale: str
    top: list[Scope]
    period: int | None
    first_span: int | None
    first_pixel: int | None

    def scopes(self) -> list[Scope]:
        """All scopes, an instance before those in it."""
        return [scope for top in self.top for scope in top.walk()]


def split(vcd: Path, out: Path, config: Config) -> Waveform:
    """Copy the VCD file `vcd` of frame_bench to `out` with the fields of spans and pixels.

    The suffix of `out` becomes .fst, or .vcd where pylibfst is not installed. Raises OSError.
    """
    with open(vcd) as file:
        timescale, top = _header(file)
        bench = next(s for t in top for s in t.walk() if s.name == BENCH)
        codes = {signal.name: signal.code for signal in bench.signals}
        pieces: dict[str, list[tuple[str, Field]]] = {}
        for scope, members in fields(config).items():
            word = pieces.setdefault(codes[SCOPES[scope]], [])
            added = Scope(f"{bench.path}.{scope}")
            for member in members:
                code = f"{scope}.{member.name}"
                span = f"[{member.bits - 1}:0]" if member.bits > 1 else ""
                added.signals.append(Signal(code, "wire", member.bits, member.name, span))
                word.append((code, member))
            bench.scopes.append(added)
        path = out.with_suffix(".fst" if fst_installed() else ".vcd")
        writer = (_FstFile if fst_installed() else _VcdFile)(path, timescale, top)
        events, shown = _Events(codes), {}
        for time, code, value in _changes(file):
            writer.change(time, code, value)
            events.change(time, code, value)
            for piece, member in pieces.get(code, ()):
                part = member.of(value)
                if shown.get(piece) != part:
                    writer.change(time, piece, part)
                    shown[piece] = part
        writer.close()
    rises = events.rises
    period = rises[1] - rises[0] if len(rises) > 1 else None
    return Waveform(path, timescale, top, period, events.first["span"], events.first["pixel"])


def fst_installed() -> bool:
    """Whether an FST file can be written."""
    return importlib.util.find_spec("pylibfst") is not None


def _header(file) -> tuple[str, list[Scope]]:
    """Read the declarations of a VCD file: the timescale, and the scopes of the top level."""
    timescale, top, path = "1ps", [], []
    for line in file:
        words = line.split()
        if not words:
            continue
        if words[0] == "$timescale":
            timescale = "".join(words[1:-1])
        elif words[0] == "$scope":
            scope = Scope(".".join([*(s.name for s in path), words[2]]))
            (path[-1].scopes if path else top).append(scope)
            path.append(scope)
        elif words[0] == "$upscope":
            path.pop()
        elif words[0] == "$var":
            _, kind, bits, code, name, *span, _ = words
            path[-1].signals.append(Signal(code, kind, int(bits), name, "".join(span)))
        elif words[0] == "$enddefinitions":
            break
    return timescale, top


def _changes(file) -> Iterator[tuple[int, str, str]]:
    """The changes of a VCD file behind its declarations: time, code, value in binary digits."""
    time = 0
    for line in file:
        if line[0] == "#":
            time = int(line[1:])
        elif line[0] in "01xzXZ":
            yield time, line[1:].rstrip(), line[0]
        elif line[0] in "bB":
            value, code = line[1:].split()
            yield time, code, value


class _Events:
    """Finds the first span accepted, the first pixel taken, and the rising edges of the clock."""

    def __init__(self, codes: dict[str, str]):
        self._pairs = {
            "span": (codes["s_valid"], codes["s_ready"]),
            "pixel": (codes["m_valid"], codes["m_ready"]),
        }
        self._clock = codes["clk"]
        self._values: dict[str, str] = {}
        self._time = 0
        self.first: dict[str, int | None] = dict.fromkeys(self._pairs)
        self.rises: list[int] = []

    def change(self, time: int, code: str, value: str) -> None:
        """Follow a change; what counts are the values when a time step ends."""
        if time != self._time:
            for event, pair in self._pairs.items():
                if self.first[event] is None and all(self._values.get(c) == "1" for c in pair):
                    self.first[event] = self._time
            self._time = time
        if code == self._clock and value == "1" and len(self.rises) < 2:
            self.rises.append(time)
        self._values[code] = value


class _FstFile:
    """An FST file that is written (pylibfst)."""

    def __init__(self, path: Path, timescale: str, top: list[Scope]):
        from pylibfst import lib

        self._lib = lib
        self._file = lib.fstWriterCreate(str(path).encode(), 1)
        if not self._file:
            raise OSError(None, "cannot be written", str(path))
        lib.fstWriterSetPackType(self._file, lib.FST_WR_PT_LZ4)
        lib.fstWriterSetTimescaleFromString(self._file, timescale.encode())
        lib.fstWriterSetVersion(self._file, b"Phong75")
        lib.fstWriterSetDate(self._file, b"")  # the same run gives the same file
        self._handles: dict[str, tuple[int, int]] = {}
        self._time: int | None = None
        for scope in top:
            self._declare(scope)

    def _declare(self, scope: Scope) -> None:
        lib = self._lib
        lib.fstWriterSetScope(self._file, lib.FST_ST_VCD_MODULE, scope.name.encode(), b"")
        for signal in scope.signals:
            kind = lib.FST_VT_VCD_PARAMETER if signal.kind == "parameter" else lib.FST_VT_VCD_WIRE
            name = f"{signal.name} {signal.range}".rstrip()
            alias, _ = self._handles.get(signal.code, (0, 0))
            handle = lib.fstWriterCreateVar(
                self._file, kind, lib.FST_VD_IMPLICIT, signal.bits, name.encode(), alias
            )
            self._handles.setdefault(signal.code, (handle, signal.bits))
        for inner in scope.scopes:
            self._declare(inner)
        lib.fstWriterSetUpscope(self._file)

    def change(self, time: int, code: str, value: str) -> None:
        """Write that a signal has `value` from `time` on."""
        if time != self._time:
            self._lib.fstWriterEmitTimeChange(self._file, time)
            self._time = time
        handle, bits = self._handles[code]
        self._lib.fstWriterEmitValueChange(self._file, handle, value.zfill(bits).encode())

    def close(self) -> None:
        """Write what is left, and close the file."""
        self._lib.fstWriterClose(self._file)


class _VcdFile:
    """A VCD file that is written."""

    def __init__(self, path: Path, timescale: str, top: list[Scope]):
        self._file = open(path, "w")
        self._time: int | None = None
        self._file.write(f"$version Phong75 $end\n$timescale {timescale} $end\n")
        self._bits: dict[str, int] = {}
        for scope in top:
            self._declare(scope)
        self._file.write("$enddefinitions $end\n")

    def _declare(self, scope: Scope) -> None:
        self._file.write(f"$scope module {scope.name} $end\n")
        for signal in scope.signals:
            words = ["$var", signal.kind, str(signal.bits), signal.code, signal.name]
            self._file.write(" ".join([*words, *filter(None, [signal.range]), "$end\n"]))
            self._bits[signal.code] = signal.bits
        for inner in scope.scopes:
            self._declare(inner)
        self._file.write("$upscope $end\n")

    def change(self, time: int, code: str, value: str) -> None:
        """Write that a signal has `value` from `time` on."""
        if time != self._time:
            self._file.write(f"#{time}\n")
            self._time = time
        single = self._bits[code] == 1
        self._file.write(f"{value}{code}\n" if single else f"b{value} {code}\n")

    def close(self) -> None:
        """Close the file."""
        self._file.close()
