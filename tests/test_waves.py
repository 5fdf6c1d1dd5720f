# SPDX-License-Identifier: MIT
"""The waveform of a short run: an FST file with named fields, and a view of its first pixel."""

import re
import shlex
import struct
from bisect import bisect_right
from pathlib import Path

import numpy as np
import pylibfst
import pytest

from phong75.model import twin
from phong75.model.config import DEFAULT
from phong75.model.front.scene import load_scene
from phong75.model.scene_to_frame import front_end
from phong75.scripts import main, waves
from phong75.sim.frame import waveform

MODULE = "normalizer"


@pytest.fixture(scope="module")
def wave(tmp_path_factory):
    """The waveform of a run; the folder has a space in its name."""
    return waves.record(MODULE, folder=tmp_path_factory.mktemp("waves") / "of a run")


@pytest.fixture(scope="module")
def save(wave):
    return wave.path.with_suffix(".gtkw").read_text()


@pytest.fixture(scope="module")
def frame():
    return front_end(load_scene(str(waves.SCENE), waves.SIZE)).frame


class Reader:
    """An FST file through GTKWave's own library: names, and the value of a signal at a time."""

    def __init__(self, path):
        file = pylibfst.lib.fstReaderOpen(str(path).encode())
        assert file != pylibfst.ffi.NULL
        _, signals = pylibfst.get_scopes_signals2(file)
        # The file has a space between name and range, which viewers leave out.
        signals = {name.replace(" ", ""): signal for name, signal in signals.by_name.items()}
        self.bits = {name: signal.length for name, signal in signals.items()}
        self._handle = {name: signal.handle for name, signal in signals.items()}
        self._changes = {}
        pylibfst.lib.fstReaderSetFacProcessMaskAll(file)
        pylibfst.fstReaderIterBlocks(file, self._change)
        pylibfst.lib.fstReaderClose(file)

    def _change(self, _, time, handle, value):
        times, values = self._changes.setdefault(handle, ([], []))
        times.append(time)
        values.append(pylibfst.string(value))

    def changes(self, name):
        """The times and the values (binary digits) of all changes of a signal."""
        return self._changes[self._handle[name]]

    def at(self, name, time):
        """The value of a signal when `time` ends, as an unsigned number."""
        times, values = self.changes(name)
        return int(values[bisect_right(times, time) - 1], 2)


@pytest.fixture(scope="module")
def reader(wave):
    return Reader(wave.path)


def test_the_file_is_fst(wave, reader):
    """A header block of 329 bytes with start and end time, and e in the machine's byte order."""
    assert wave.path.suffix == ".fst"
    block, length, start, end, e = struct.unpack(">BQQQ8s", wave.path.read_bytes()[:33])
    assert (block, length, start) == (0, 329, 0) and end > wave.first_pixel
    assert struct.unpack("=d", e)[0] == np.e
    assert len(reader.bits) > 1000


def cycles(reader, wave, valid, ready):
    """The ends of the clock cycles in which a handshake takes place."""
    times, values = reader.changes("frame_bench.clk")
    edges = [t for t, v in zip(times, values, strict=True) if v == "1"]
    before = [edge - 1 for edge in edges]
    return [
        t for t in before
        if t >= 0 and reader.at(f"frame_bench.{valid}", t) and reader.at(f"frame_bench.{ready}", t)
    ]  # fmt: skip


def field(reader, name, times):
    return np.array([reader.at(name, t) for t in times])


def test_the_fields_of_the_spans_are_those_of_the_scene(reader, wave, frame):
    times = cycles(reader, wave, "s_valid", "s_ready")
    assert len(times) == len(frame.spans) > 10
    spans = frame.spans
    for name in ("x", "y", "length", "material"):
        shown = field(reader, f"frame_bench.span.{name}[{widths(reader)[name]}:0]", times)
        np.testing.assert_array_equal(shown, spans[name], name)
    bits = DEFAULT.normal.bits
    for what in ("start", "step"):
        for k, axis in enumerate("xyz"):
            shown = field(reader, f"frame_bench.span.{what}_{axis}[{bits - 1}:0]", times)
            np.testing.assert_array_equal(shown, spans[what][:, k] % (1 << bits))


def widths(reader):
    """The left index of each field of a span, {name: index}."""
    matches = (re.fullmatch(r"frame_bench\.span\.(\w+)\[(\d+):0\]", name) for name in reader.bits)
    return {match[1]: int(match[2]) for match in matches if match}


def test_the_fields_of_the_pixels_are_those_of_the_model(reader, wave, frame):
    times = cycles(reader, wave, "m_valid", "m_ready")
    pixels = twin.render(frame)
    assert len(times) == len(pixels.x) > 200
    place, colour = DEFAULT.coordinate_bits - 1, DEFAULT.colour_bits - 1
    for name, expected, top in (
        ("x", pixels.x, place), ("y", pixels.y, place), ("red", pixels.rgb[:, 0], colour),
        ("green", pixels.rgb[:, 1], colour), ("blue", pixels.rgb[:, 2], colour),
    ):  # fmt: skip
        shown = field(reader, f"frame_bench.pixel.{name}[{top}:0]", times)
        np.testing.assert_array_equal(shown, expected, name)


def test_the_view_starts_at_the_first_pixel(reader, wave, save):
    for time, handshake in ((wave.first_span, "s"), (wave.first_pixel, "m")):
        first = cycles(reader, wave, f"{handshake}_valid", f"{handshake}_ready")[0]
        assert time <= first < time + wave.period
    start = int(re.search(r"^\[timestart\] (\d+)$", save, re.MULTILINE)[1])
    assert wave.first_pixel - 8 * wave.period < start < wave.first_pixel
    zoom, marker = re.search(r"^\*(\S+) (\d+) ", save, re.MULTILINE).groups()
    assert int(marker) == wave.first_pixel
    # 200 pixels of the window show 2 ** -zoom units of time: one clock is well to be seen.
    assert 10 < 200 / 2 ** -float(zoom) * wave.period < 50


def test_every_signal_of_the_save_file_is_in_the_waveform(reader, save):
    shown = re.findall(r"^(frame_bench\..*)$", save, re.MULTILINE)
    assert set(shown) <= set(reader.bits)
    for signal in (
        "clk", "s_ready", "span.length[12:0]", "pixel.red[7:0]", "u_normalizer.unit_x[17:0]",
        "u_normalizer.sum_p11[35:0]",
    ):  # fmt: skip
        assert any(name.endswith(f".{signal}") for name in shown), signal
    assert any("gen_component[2].mantissa_p7" in name for name in shown)


def test_normals_are_shown_as_fractions(save):
    lines = save.splitlines()
    place = next(k for k, line in enumerate(lines) if line.startswith("frame_bench.span.start_z"))
    # In a save file 0x400 is signed, 0x20 right-justified, 0x40000000 with a binary point.
    assert lines[place - 2 : place] == [f"[fpshift_count] {DEFAULT.normal.fraction}", "@40000420"]


def test_the_command_opens_it_from_the_current_folder(wave, monkeypatch, tmp_path):
    for folder in (tmp_path, wave.path.parent):
        monkeypatch.chdir(folder)
        program, *files = shlex.split(waves.command(wave).splitlines()[0])
        assert program == "gtkwave"
        assert [Path(file).resolve() for file in files] == [
            wave.path, wave.path.with_suffix(".gtkw")
        ]  # fmt: skip
        assert all(Path(file).is_file() for file in files)


def test_the_save_file_names_the_waveform_wherever_it_is_opened(wave, save):
    assert f'[dumpfile] "{wave.path}"' in save
    assert f'[savefile] "{wave.path.with_suffix(".gtkw")}"' in save


def test_what_is_missing_is_said(wave, monkeypatch):
    monkeypatch.setattr(waves.shutil, "which", lambda name: None)
    assert "apt-get install gtkwave" in waves.command(wave)
    monkeypatch.setattr(waves.shutil, "which", lambda name: f"/usr/bin/{name}")
    assert "\n" not in waves.command(wave)


VCD = """$timescale 1ps $end
 $scope module frame_bench $end
  $var wire 1 a clk $end
  $var wire 1 b s_valid $end
  $var wire 1 c s_ready $end
  $var wire 1 d m_valid $end
  $var wire 1 e m_ready $end
  $var wire 233 f s_data [232:0] $end
  $var wire 48 g m_data [47:0] $end
 $upscope $end
$enddefinitions $end
#0
0a
0b
1c
0d
0e
b0 f
b0 g
#10
1a
1b
1d
b{word:0233b} f
#15
0a
#20
1a
1e
b{pixel:048b} g
#30
0d
"""


@pytest.fixture
def small(tmp_path):
    fields = {f.name: f for f in waveform.fields(DEFAULT)["span"]}
    word = (1 << fields["length"].bits) - 3 << fields["length"].lsb
    (tmp_path / "run.vcd").write_text(VCD.format(word=word, pixel=5 << 36 | 7 << 24 | 0x0A0B0C))
    return tmp_path / "run.vcd"


def test_without_the_library_the_file_is_vcd(small, tmp_path, monkeypatch):
    monkeypatch.setattr(waveform, "fst_installed", lambda: False)
    wave = waveform.split(small, tmp_path / "out", DEFAULT)
    assert wave.path == tmp_path / "out.vcd"
    text = wave.path.read_text()
    assert "$scope module span $end" in text and "$scope module pixel $end" in text
    assert "$var wire 13 span.length length [12:0] $end" in text
    assert f"#10\n1a\n1b\n1d\nb{1 << 0:b}" not in text
    assert f"b{(1 << 13) - 3:013b} span.length" in text.partition("#10\n")[2].partition("#15")[0]
    later = text.partition("#20\n")[2].partition("#30")[0]
    for value, name in ((5, "y"), (7, "x")):
        assert f"b{value:012b} pixel.{name}\n" in later
    for value, name in ((10, "red"), (11, "green"), (12, "blue")):
        assert f"b{value:08b} pixel.{name}\n" in later
    assert "VCD in place of FST" in waves.command(wave)


def test_the_first_pixel_is_the_first_one_taken(small, tmp_path):
    wave = waveform.split(small, tmp_path / "out", DEFAULT)
    assert (wave.first_span, wave.first_pixel, wave.period) == (10, 20, 10)
    small.write_text(small.read_text().replace("1e\n", "0e\n"))
    assert waveform.split(small, tmp_path / "out", DEFAULT).first_pixel is None


def test_an_unknown_module_is_named_with_the_known_ones(capsys):
    assert main.main(["waves", "walker"]) == 2
    said = capsys.readouterr().err
    assert said == "Error: MODULE: there is no `walker`; did you mean span_walker?\n"
