"""A sample of mutants; `make mutate` runs them all."""

import subprocess
import sys

from phong75.sim.design import PACKAGE

SAMPLE = 8
#: Files of which the default configuration builds every line.
FILES = (
    "span_walker", "linear_interpolator", "inverse_sqrt_linear", "versine_of_cross",
    "specular_weight",
    "round_saturate", "leading_zeros", "left_shifter", "narrow_multiplier", "intensity_code",
)  # fmt: skip


def test_a_sample_of_mutants_is_killed():
    command = [sys.executable, "-m", "tests.campaigns.mutation", "--sample", str(SAMPLE)]
    command += ["--files", *FILES]
    done = subprocess.run(command, cwd=PACKAGE, text=True, capture_output=True)
    assert done.returncode == 0, done.stdout + done.stderr[-2000:]
    assert f"{SAMPLE} mutants, {SAMPLE} killed" in done.stdout


def test_what_is_not_in_the_design_is_one_line():
    command = [sys.executable, "-m", "tests.campaigns.mutation", "--files", "nothing"]
    done = subprocess.run(command, cwd=PACKAGE, text=True, capture_output=True)
    assert done.returncode == 2 and done.stderr == "mutate: not in rtl/: nothing\n"
