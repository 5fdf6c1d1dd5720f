# SPDX-License-Identifier: MIT
"""The pages build without a warning. Needs requirements-docs.txt."""

import subprocess
import sys

from phong75.sim.design import PACKAGE


def test_sphinx_builds_the_pages_without_a_warning(tmp_path):
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html"]
    done = subprocess.run(
        [*command, "-d", tmp_path / "doctrees", PACKAGE / "docs", tmp_path / "html"],
        cwd=PACKAGE, text=True, capture_output=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    index = (tmp_path / "html" / "python.html").read_text()
    assert 'id="phong75.render"' in index and 'id="phong75.Config"' in index
