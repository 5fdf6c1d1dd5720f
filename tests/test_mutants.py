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


def mutate(*arguments):
    command = [sys.executable, "-m", "tests.campaigns.mutation", *arguments]
    return subprocess.run(command, cwd=PACKAGE, text=True, capture_output=True)


def test_a_sample_of_mutants_is_killed():
    done = mutate(f"--sample={SAMPLE}", *FILES)
    assert done.returncode == 0, done.stdout + done.stderr[-2000:]
    assert f"{SAMPLE} mutants, {SAMPLE} killed" in done.stdout


def test_a_sample_of_none_is_none():
    done = mutate("--sample=0", "rom")
    assert done.returncode == 0 and done.stdout.startswith("0 mutants, 0 killed, 0 survived;")


def test_what_is_not_in_the_design_is_one_line():
    for arguments, says in (
        (["span_wlaker"], "MODULE: there is no `span_wlaker`; did you mean span_walker?"),
        (["--kind=x"], "--kind is `x`, not one of constant, operator"),
        (["--sample=x"], "Invalid value for '--sample': "),
    ):
        done = mutate(*arguments)
        assert done.returncode == 2 and done.stderr.count("\n") == 1
        assert done.stderr.startswith(f"Error: {says}")
