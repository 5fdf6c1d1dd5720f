# SPDX-License-Identifier: MIT
"""`phong75` from the outside: its files, its exit codes, and one clear line for wrong input.

The RTL is stood in for by the model here; the tests of whole frames simulate it.
"""

import fcntl
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import phong75
from phong75.model import twin
from phong75.model.config import DEFAULT, TECHNIQUES
from phong75.model.spans import read_spans
from phong75.model.studies.methods import CONFIGS
from phong75.scripts import console, main, options, run
from phong75.scripts.configurations import CONFIGURATIONS, GROUPS
from phong75.sim import design
from phong75.sim.build import BuildError
from phong75.sim.frame.run_frame import SimResult, SimulationError
from tests.mesh_writers import CUBE, SQUARES, obj
from tests.wrong_results import extra_pixel, far_away, lost_pixel, wrong_colour

ROOT = Path(__file__).resolve().parent.parent
FILES = ["error.png", "frame.png", "reference.png", "report.json", "spans"]
LATENCY = 74

SMALL = """
size = [32, 24]
background = [0, 0, 1]
[[objects]]
shape = "sphere"
segments = 16
rings = 8
"""


def perfect(path, frame, config, progress):
    """A simulation that does what the model does."""
    if config.normal_method != "quadratic_spans":  # whose spans are not read back
        assert np.array_equal(read_spans(path, config).spans, frame.spans)
    pixels = twin.render(frame, config)
    cycles = len(pixels.x) + LATENCY if len(pixels.x) else 0
    return SimResult(pixels, True, cycles, LATENCY, 0, 0, 0, 0.5, 0.25)


def broken(change):
    """A simulation whose result `change` has altered."""

    def simulate(*arguments):
        result = perfect(*arguments)
        change(result)
        return result

    return simulate


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(SMALL)
    return path


@pytest.fixture
def phong(capsys):
    """Run the command line: (exit code, stdout, lines of stderr without those of progress)."""

    def phong(*arguments):
        code = main.main([str(argument) for argument in arguments])
        shown = capsys.readouterr()
        lines = [x for x in shown.err.splitlines() if not x.endswith(" ...")]
        return code, shown.out, lines

    return phong


@pytest.fixture
def start(tmp_path, phong, monkeypatch):
    """`phong75 run` with `simulate` in place of the RTL."""

    def start(*arguments, simulate=perfect, out=tmp_path / "out"):
        monkeypatch.setattr(run.run_frame, "simulate", simulate)
        return phong("run", *arguments, f"--out={out}")

    return start


# -- good runs -------------------------------------------------------------------------------------


def test_a_run_says_what_became_of_a_mesh(start, tmp_path):
    path = tmp_path / "a.obj"
    path.write_text(obj(CUBE, [s[::-1] for s in SQUARES]))
    code, shown, lines = start(path, "--size=32x24")
    assert (code, lines) == (0, [])
    assert "a: 1 body of 1 turned round: wound clockwise" in shown
    assert "12 triangles in 1 part; normals: made here, crease 56 degrees" in shown
    (mesh,) = json.loads((tmp_path / "out/report.json").read_text())["mesh"]
    assert mesh["object"] == "a" and mesh["source"] == "a.obj"
    assert (mesh["triangles"], mesh["bodies"], mesh["bodies_turned"]) == (12, 1, 1)

    path.write_text(obj([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 2, 1)]))
    code, shown, lines = start(path, "--size=32x24")
    assert "no pixel: of 1 triangles all turn away from the eye" in shown


def test_a_good_run(start, scene, tmp_path):
    code, shown, lines = start(scene)
    assert (code, lines) == (0, [])
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == FILES
    assert "0 pixels differ" in shown and "FAILED" not in shown

    report = json.loads((tmp_path / "out/report.json").read_text())
    assert list(report) == [
        "schema", "scene", "technique", "size", "pixels", "spans", "lights", "cycles_of_lights",
        "illegal_spans", "unsupported", "zero_normals", "cycles",
        "cycles_per_pixel", "latency_cycles", "stall_cycles", "utilization", "budget", "compare",
        "error", "input_error", "degenerate_triangles", "mesh", "lit_facing_away", "empty",
        "undecided", "notes", "config", "versions", "wall_s",
    ]  # fmt: skip
    assert report["scene"] == "small" and report["size"] == [32, 24]
    pixels, cycles = report["pixels"], report["cycles"]
    assert cycles == pixels + LATENCY > 100 + LATENCY
    assert report["cycles_per_pixel"] == cycles / pixels
    assert report["utilization"] == pixels / cycles
    assert report["budget"] == {
        "fps": 30, "clock_hz": 200_000_000, "cycles_available": 6_666_666, "cycles_used": cycles,
        "met": True, "max_fps": 200e6 / cycles,
    }  # fmt: skip
    assert report["compare"] == {
        "pixels": pixels, "mismatches": 0, "zero_normals": 0, "pruned_model_mismatches": 0
    }  # fmt: skip
    keys = {"max_lsb", "mean_lsb", "rms_lsb", "p999_lsb", "correctly_rounded", "psnr_db"}
    assert set(report["error"]) == keys | {"bound_lsb"} and set(report["input_error"]) == keys
    assert report["config"]["normal"] == str(DEFAULT.normal)
    assert list(report["wall_s"]) == ["front_end", "model", "reference", "build", "simulate"]
    assert (report["wall_s"]["build"], report["wall_s"]["simulate"]) == (0.5, 0.25)

    frame = read_spans(tmp_path / "out/spans", DEFAULT)
    pixels = twin.render(frame)
    with Image.open(tmp_path / "out/frame.png") as picture:
        shown = np.asarray(picture)
    np.testing.assert_array_equal(shown[pixels.y, pixels.x], pixels.rgb)
    assert shown[0, 0].tolist() == [0, 0, 255]
    with Image.open(tmp_path / "out/reference.png") as picture:
        assert abs(np.asarray(picture).astype(int) - shown).max() <= 1


def test_two_runs_differ_in_wall_times_only(start, scene, tmp_path):
    contents = []
    for name in "ab":
        start(scene, out=tmp_path / name)
        files = {f: (tmp_path / name / f).read_bytes() for f in FILES}
        report = json.loads(files.pop("report.json"))
        assert report.pop("wall_s")
        contents.append((files, report))
    assert contents[0] == contents[1]


def test_a_span_file_instead_of_a_scene(start, scene, tmp_path):
    start(scene, out=tmp_path / "first")
    spans = tmp_path / "first" / "spans"
    code, _, lines = start("teapot", f"--spans={spans}", out=tmp_path / "second")
    assert (code, lines) == (0, [])
    for name in ("frame.png", "reference.png", "spans"):  # error.png shows the name of the scene
        assert (tmp_path / "second" / name).read_bytes() == spans.with_name(name).read_bytes()
    report = json.loads((tmp_path / "second/report.json").read_text())
    assert report["input_error"] is None and report["scene"] == "spans"
    # Its own folder is a fine place for the results too.
    assert start(f"--spans={spans}", out=tmp_path / "first")[0] == 0


def test_an_empty_frame_is_good(start, scene, tmp_path):
    camera = '[camera]\nprojection = "orthographic"\neye = [0, 0, 99]\ntarget = [50, 0, 99]\n'
    scene.write_text(SMALL.replace("[[", f"{camera}up = [0, 1, 0]\nheight = 2\n[[", 1))
    code, _, lines = start(scene)
    assert (code, lines) == (0, [])
    report = json.loads((tmp_path / "out/report.json").read_text())
    assert (report["pixels"], report["spans"], report["cycles"]) == (0, 0, 0)
    assert report["cycles_per_pixel"] is None and report["utilization"] is None
    assert report["budget"]["met"] and report["budget"]["max_fps"] is None
    with Image.open(tmp_path / "out/frame.png") as picture:
        assert (np.asarray(picture) == (0, 0, 255)).all()


def test_size_fps_and_clock(start, scene, tmp_path):
    assert start(scene, "--size=9x7", "--fps=59.94", "--clock=0.1")[0] == 0
    report = json.loads((tmp_path / "out/report.json").read_text())
    assert report["size"] == [9, 7]
    assert report["budget"]["cycles_available"] == int(100_000 / 59.94)


@pytest.mark.parametrize(
    ("arguments", "out"),
    [
        ({}, "build/teapot"),
        ({"scene": "some where/my mesh.v2.obj"}, "build/my mesh.v2"),
        ({"spans": Path("a/frame.spans")}, "build/frame"),
        ({"spans": Path("a/spans"), "out": Path("-x")}, "-x"),
        ({"scene": "cone", "config": TECHNIQUES["gouraud"]}, "build/cone-gouraud"),
        ({"config": TECHNIQUES["flat"], "out": Path("here")}, "here"),
        ({"config": CONFIGS["dot_first_14"]}, "build/teapot-dot_first_14"),
    ],
)
def test_where_the_results_go(arguments, out):
    assert run.request(**arguments).out == Path(out)


def test_a_pruned_run(start, scene, tmp_path):
    code, shown, lines = start(scene, "--prune=self")
    assert (code, lines) == (0, [])
    report = json.loads((tmp_path / "out/report.json").read_text())
    assert report["config"]["name"] == "default-pruned" and report["unsupported"] == 0
    assert report["config"]["weight_function"] is False
    code, _, _ = start(scene, "--prune=0")
    assert code == 0
    assert json.loads((tmp_path / "out/report.json").read_text())["config"]["name"] == "default"


@pytest.mark.parametrize("technique", ["gouraud", "flat"])
def test_the_older_techniques_can_be_pruned_to_grey(start, scene, tmp_path, technique):
    grey = tmp_path / "grey.toml"
    grey.write_text(SMALL + "material = { color = [0.5, 0.5, 0.5] }\n")
    code, _, lines = start(grey, f"--technique={technique}", "--prune=self")
    assert (code, lines) == (0, [])
    report = json.loads((tmp_path / "out/report.json").read_text())
    assert (report["technique"], report["config"]["channels"]) == (technique, 1)
    refused = start(scene, f"--technique={technique}", f"--prune={grey}")
    assert_refused(refused, "its spans have no place for this scene: channels: red, green and blue")


# -- exit code 1 -----------------------------------------------------------------------------------


@pytest.mark.parametrize("change", [wrong_colour, lost_pixel, extra_pixel, far_away])
def test_a_mismatch(start, scene, tmp_path, change):
    code, shown, lines = start(scene, simulate=broken(change))
    assert code == 1 and "FAILED" in shown
    assert any(x.startswith("FAILED: 1 of ") and x.endswith("model differ") for x in lines)
    report = json.loads((tmp_path / "out/report.json").read_text())
    assert report["compare"]["mismatches"] == 1


def test_a_mismatch_says_where(start, scene):
    _, _, lines = start(scene, simulate=broken(wrong_colour))
    assert "pixel 5 of the stream: model x " in "".join(lines)


def test_a_missed_budget(start, scene, tmp_path):
    code, _, lines = start(scene, "--fps=1000000")
    assert code == 1 and len(lines) == 1
    assert lines[0].startswith("FAILED: the frame takes ")
    assert lines[0].endswith("200 are there at 1e+06 frames a second")
    assert not json.loads((tmp_path / "out/report.json").read_text())["budget"]["met"]


def test_a_missed_bound(start, scene, monkeypatch):
    """RTL and model agree, but both are wrong."""
    monkeypatch.setattr(run.error_budget, "bound_lsb", lambda frame, config: 0.25)
    code, _, lines = start(scene)
    assert code == 1 and len(lines) == 1
    assert lines[0].startswith("FAILED: the largest error is ") and "bound 0.25" in lines[0]


def test_a_build_pruned_to_another_scene(start):
    """The torus needs W(i), which the teapot's build leaves out: the reason is said."""

    def flagged(result):
        result.unsupported = 32

    arguments = "torus", "--size=32x24", "--prune=teapot"
    code, _, lines = start(*arguments, simulate=broken(flagged))
    assert code == 1
    assert "left out, but needed: weight_function: W depends on i in 1 of 1 material" in lines
    assert "FAILED: 32 spans or register writes need what this build leaves out" in lines


# -- exit code 2 -----------------------------------------------------------------------------------


def assert_refused(found, says):
    code, shown, lines = found
    assert code == 2 and not shown
    assert len(lines) == 1, lines
    assert lines[0].startswith("Error: ") and says in lines[0]


@pytest.mark.parametrize(
    ("argument", "says"),
    [
        ("--size=640", "--size is `640`, not WIDTHxHEIGHT such as 640x480"),
        ("--size=640x", "--size is `640x`"),
        ("--size=640X480", "--size is `640X480`"),
        ("--size=-1x480", "--size is `-1x480`"),
        ("--size=6.5x480", "--size is `6.5x480`"),
        ("--size=٣x٣", "--size is `٣x٣`"),
        ("--size=0x480", "--size is 0x480: each side must be from 1 to 4096"),
        ("--size=640x0", "--size is 640x0"),
        ("--size=640x4097", "--size is 640x4097"),
        ("--fps=0", "--fps is `0`, not a number from 1e-9 to 1e9"),
        ("--fps=fast", "--fps is `fast`"),
        ("--fps=nan", "--fps is `nan`"),
        ("--clock=-200", "--clock is `-200`"),
        ("--clock=inf", "--clock is `inf`"),
        ("--clock=1e308", "--clock is `1e308`"),
        ("--technique=Phong", "--technique: there is no `Phong`; did you mean phong?"),
        ("--technique=ray", "--technique: there is no `ray`; there is phong, gouraud, flat"),
        ("--config=quadratic_18", "no `quadratic_18`; did you mean quadratic_spans_18?"),
        ("--config=x", "--config: there is no `x`; `phong75 configs` lists them"),
        ("teapto", "did you mean teapot?"),
        ("nowhere/scene.toml", "nowhere/scene.toml: no such file"),
        ("nowhere.obj", "nowhere.obj: no such file"),
        ("--spans=nowhere", "cannot read nowhere: No such file"),
        ("--colour=red", "No such option: --colour"),
        ("--szie=3x3", "No such option: --szie (Possible options: --size)"),
    ],
)
def test_wrong_arguments(start, argument, says):
    assert_refused(start(argument), says)


SPHERE = '[[objects]]\nshape = "sphere"\n'
MATERIAL = '[materials.m]\n{}\n[[objects]]\nshape = "sphere"\nmaterial = "m"\n'


@pytest.mark.parametrize(
    ("name", "text", "says"),
    [
        ("a.toml", "size = [1, 2]\nsize = [\n", "line "),
        ("a.toml", "\udcff", "not UTF-8"),
        ("a.toml", f"colour = 1\n{SPHERE}", "colour"),
        ("a.toml", f"size = [0, 480]\n{SPHERE}", "size"),
        ("a.toml", f"size = [640, 4097]\n{SPHERE}", "size"),
        ("a.toml", f"[light]\ndirection = [0, 0, 0]\n{SPHERE}", "direction"),
        ("a.toml", f"[camera]\neye = [1, 1, 1]\ntarget = [1, 1, 1]\n{SPHERE}", "camera"),
        ("a.toml", MATERIAL.format("n = -0.5"), "-0.5"),
        ("a.toml", MATERIAL.format("n = 129"), "129"),
        ("a.toml", MATERIAL.format("W = 1.5"), "1.5"),
        ("a.toml", MATERIAL.format("d = -0.5"), "-0.5"),
        ("a.toml", MATERIAL.format("color = [0, 2, 0]"), "2"),
        ("a.toml", '[[objects]]\nmesh = "nowhere.obj"\n', "nowhere.obj"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "no faces"),
        ("a.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "not finite"),
        ("a.obj", "v 0 0 0\nv inf 0 0\nv 0 1 0\nf 1 2 3\n", "not finite"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "out of range"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "degenerate"),
        ("a.ply", "ply\nrubbish\n", "a.ply"),
        ("a.jpeg", "", "neither a scene"),
    ],
)
def test_wrong_files(start, tmp_path, name, text, says):
    path = tmp_path / name
    path.write_text(text, errors="surrogateescape")
    assert_refused(start(path), says)
    assert not (tmp_path / "out").exists(), "nothing is left half-written"


def test_a_wrong_span_file(start, tmp_path):
    path = tmp_path / "spans"
    path.write_bytes(b"phong75-spans 1\n{}\n")
    assert_refused(start(f"--spans={path}"), f"{path}: line 2 has no key `width`")
    assert_refused(start(f"--spans={tmp_path}"), "Is a directory")


def test_results_that_cannot_be_written(start, scene, tmp_path):
    (tmp_path / "file").touch()
    for out in (tmp_path / "file", tmp_path / "file" / "below"):
        assert_refused(start(scene, out=out), f"cannot write to --out {out}: ")
    (tmp_path / "out" / "frame.png").mkdir(parents=True)
    assert_refused(start(scene), "frame.png: Is a directory")


@pytest.mark.parametrize("kind", [BuildError, SimulationError])
def test_a_set_up_that_does_not_work(start, scene, tmp_path, monkeypatch, kind):
    monkeypatch.setattr(design, "BUILD", tmp_path)

    def simulate(*arguments):
        raise kind("g++ failed:\nno room\nat all")

    out = tmp_path / "out"
    start(scene)
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    assert_refused(start(scene, simulate=simulate), "Error: g++ failed; more is in ")
    assert (tmp_path / "failure.log").read_text() == "g++ failed:\nno room\nat all\n"
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before


def test_two_runs_into_one_folder(start, scene, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    with open(out / ".lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        assert_refused(start(scene), f"another run writes to --out {out}: wait for it")
    # The process that held the lock has ended without removing its file.
    assert start(scene)[0] == 0
    assert sorted(path.name for path in out.iterdir()) == FILES


def test_what_is_no_user_error_is_not_hidden():
    def broken():
        raise RuntimeError("a defect of the program")

    with pytest.raises(RuntimeError):
        console.exit_code(broken)


def test_ctrl_c(start, scene, tmp_path):
    def interrupted(*arguments):
        raise KeyboardInterrupt

    code, shown, lines = start(scene, simulate=interrupted)
    assert (code, shown, lines) == (130, "", [])
    assert not (tmp_path / "out").exists()


# -- configurations by name ------------------------------------------------------------------------


def test_every_name_of_the_tables_can_be_asked_for(phong):
    code, shown, _ = phong("configs")
    names = [line.strip() for line in shown.splitlines() if line.startswith("  ")]
    assert code == 0 and len(names) == len(set(names)) == sum(map(len, GROUPS.values()))
    assert {*CONFIGS, "gouraud", "flat", "paper", "diffuse", "diffuse_grey"} <= set(names)
    assert options.configuration(None, "diffuse grey").channels == 1
    assert options.configuration(None, "diffuse-grey") is CONFIGURATIONS["diffuse_grey"]


@pytest.mark.parametrize("name", ["quadratic_spans_18", "not_normalized", "width_12", "paper"])
def test_a_run_of_a_configuration(start, scene, tmp_path, name):
    code, shown, lines = start(scene, f"--config={name}")
    assert (code, lines) == (0, [])
    report = json.loads((tmp_path / "out/report.json").read_text())
    assert report["config"]["name"] == name
    bounded = report["error"]["bound_lsb"] is not None
    assert bounded != ("no bound derived" in shown)
    assert bounded == (name != "not_normalized")


def test_spans_that_a_method_cannot_take(start, scene, monkeypatch):
    reason = "span 7 is not for quadratic_spans"
    monkeypatch.setattr(run.error_budget, "refusal", lambda frame, config: reason)
    assert_refused(start(scene, "--config=quadratic_spans_18"), reason)


def test_technique_and_config_exclude_each_other(start, scene):
    refused = start(scene, "--technique=flat", "--config=gouraud")
    assert_refused(refused, "--technique and --config both name what to build")


# -- the command line itself -----------------------------------------------------------------------


def test_version_and_help(phong):
    assert phong("--version") == (0, f"phong75 {phong75.__version__}\n", [])
    code, shown, _ = phong()
    assert code == 0 and shown == phong("--help")[1] == phong("-h")[1]
    for command in FORWARDED:
        assert re.search(rf"^  {command} ", shown, re.MULTILINE), command


def test_a_misspelt_command(phong):
    assert phong("rnu") == (2, "", ["Error: No such command 'rnu'. Did you mean 'run'?"])


def test_completion_by_tab():
    assert options.scenes("s")[:2] == ["sphere", "still_life"]
    assert "quadratic_spans_18" in options.configs("quad")
    assert options.techniques("g") == ["gouraud"]
    assert "span_walker" in options.modules("span")


def test_a_phase_says_what_it_does(scene, tmp_path, monkeypatch, capsys):
    def slow(path, frame, config, progress):
        progress("compiling the testbench (once)")
        progress("simulating")
        return perfect(path, frame, config, progress)

    monkeypatch.setattr(run.run_frame, "simulate", slow)
    assert main.main(["run", str(scene), f"--out={tmp_path / 'out'}"]) == 0
    phases = [x for x in capsys.readouterr().err.splitlines() if x.endswith(" ...")]
    assert phases == [
        "front end ...", "model ...", "compiling the testbench (once) ...", "simulating ...",
        "reference ...", "pictures ...",
    ]  # fmt: skip


# -- the real programs -----------------------------------------------------------------------------


def outside(*command, **environment):
    """Run `command` in the project; `make` must not think that another make runs it."""
    inherited = {k: v for k, v in os.environ.items() if not k.startswith(("MAKE", "MFLAGS"))}
    return subprocess.run(
        command, cwd=ROOT, env=inherited | environment, capture_output=True, text=True
    )


def test_the_program_without_traceback():
    done = outside(sys.executable, "-m", "phong75.scripts.main", "run", "--size=0x0")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "Error: --size is 0x0: each side must be from 1 to 4096\n"


def test_help_needs_no_model():
    code = (
        "import sys; from phong75.scripts.main import main; main(['run', '--help']); "
        "print(*sorted({'numpy', 'rich', 'cocotb', 'matplotlib'} & set(sys.modules)))"
    )
    done = outside(sys.executable, "-c", code)
    assert "--technique" in done.stdout and done.stdout.splitlines()[-1] == ""


def make(*arguments):
    """What `make` would run, without running it."""
    return outside("make", "--dry-run", *arguments)


def command_of(done):
    """The words of the last command that `make` would run."""
    return shlex.split(done.stdout.replace("\\\n", "").splitlines()[-1])


def test_make_passes_arguments_on():
    odd = 'it\'s $(odd) "here".toml'
    done = make("run", f"SCENE={odd.replace('$', '$$')}", "SIZE=3x3", "FPS=", "PRUNE=1")
    assert command_of(done)[1:] == [
        "-m", "phong75.scripts.main", "run", "--size=3x3", "--prune=1", "--", odd
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["run", "SIZEE=3x3"], "`make run` has no variable SIZEE; it takes SCENE SIZE "),
        (["compare", "SIZ=3x3"], "`make compare` has no variable SIZ; it takes SCENE SIZE "),
        (["lint", "RECORD=1"], "`make lint` has no variable RECORD; it takes none"),
        (["synth", "RECORD=yes"], "RECORD is `yes`, not 0 or 1"),
        (["synth", "CONFIG=flat", "AREA=1"], "`make synth` has no variable AREA"),
    ],
)
def test_make_refuses_a_misspelt_variable(arguments, says):
    done = make(*arguments)
    assert (done.returncode, done.stdout) == (2, "") and done.stderr.count("\n") == 1
    assert says in done.stderr


def test_make_does_not_look_at_the_environment():
    done = outside("make", "--dry-run", "run", SIZE="3x3", SCENE="cone")
    assert "--size" not in done.stdout and "cone" not in done.stdout


#: The variables of each target that forwards: those with a value, and those that are 0 or 1.
FORWARDED = {
    "run": ("SCENE SIZE TECHNIQUE CONFIG FPS CLOCK_MHZ PRUNE SPANS OUT", ""),
    "compare": ("SCENE SIZE CLOCK_MHZ OUT", "RECORD"),
    "prune": ("SCENE SIZE SEEDS", "GATES RECORD"),
    "scenes": ("", "RECORD"),
    "sweep": ("ROUTE", "AREA RECORD"),
    "tessellation": ("", "RECORD"),
    "stability": ("", "RECORD"),
    "adversarial": ("", "KEEP RECORD"),
    "prove": ("CONFIG", "AGAIN METHODS RECORD"),
    "report": ("", ""),
    "synth": ("CONFIG SCENE GRADE SEEDS", "GATES RECORD"),
    "netlist": ("", "RECORD"),
    "formal": ("", "RECORD"),
    "activity": ("", "RECORD"),
    "waves": ("MODULE CONFIG", ""),
    "bench": ("", "RECORD"),
    "export": ("CONFIG OUT SCENE SIZE", ""),
    "configs": ("", ""),
}


@pytest.mark.parametrize("target", FORWARDED)
def test_every_option_that_make_gives_is_one_of_the_command(target, phong):
    values, flags = (variables.split() for variables in FORWARDED[target])
    done = make(target, *(f"{v}=6" for v in values), *(f"{v}=1" for v in flags))
    _, _, program, name, *arguments = command_of(done)
    assert (program, name) == ("phong75.scripts.main", target)
    code, text, _ = phong(target, "--help")
    assert code == 0
    given = {argument.partition("=")[0] for argument in arguments if argument.startswith("--")}
    for option in given - {"--"}:
        assert f" {option} " in text, option
    positional = int("--" in arguments)
    both_record = target == "adversarial"
    assert len(given - {"--"}) + positional == len(values) + len(flags) - both_record


def test_make_help_names_every_target():
    text = (ROOT / "Makefile").read_text()
    lines = re.findall(r"^\.PHONY: (.*(?:\\\n.*)*)", text, re.MULTILINE)
    targets = " ".join(lines).replace("\\", " ").split()
    shown = outside("make").stdout
    for target in set(targets) - {"help"}:
        if not target.endswith("-setup"):
            assert re.search(rf"make {target}(?![-\w])", shown), target
    assert all(len(line) <= 88 for line in shown.splitlines())


@pytest.mark.parametrize("missing", [["g++"], ["perl", "git"]])
def test_missing_programs_are_named_on_the_first_line(tmp_path, missing):
    for program in {"sh", "dirname", "cksum", "cat", "make", "g++", "perl", "git"} - set(missing):
        (tmp_path / program).symlink_to(shutil.which(program))
    (tmp_path / "python3").symlink_to(sys.executable)
    done = outside("scripts/setup.sh", PATH=str(tmp_path))
    wanted = f"Phong75 needs {', '.join(missing)}: apt-get install {' '.join(missing)}\n"
    assert (done.returncode, done.stderr) == (2, wanted)
