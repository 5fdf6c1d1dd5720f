# SPDX-License-Identifier: MIT
"""A sample of mutants; `make mutate` runs them all."""

import subprocess
import sys

from phong75.sim import design
from phong75.sim.design import PACKAGE
from tests.campaigns import mutation
from tests.campaigns.relevant_benches import BENCHES, relevant_benches

SAMPLE = 8
#: Files that the default configuration builds completely, and of which no mutant in the sample
#: hangs: that takes BENCH_SECONDS.
FILES = (
    "span_walker", "linear_interpolator", "inverse_sqrt_linear", "versine_of_cross",
    "specular_weight", "round_saturate", "left_shifter", "narrow_multiplier", "intensity_code",
)  # fmt: skip


def test_every_file_of_the_design_has_benches():
    for file in design.sources():
        benches = relevant_benches(file)
        assert benches, f"no bench contains {file.stem}"
        assert benches[0] == "default" or "default" not in benches, file.stem
    for header in design.headers():
        assert set(relevant_benches(header)) == set(BENCHES)
    newton = relevant_benches(design.module_file("newton_step"))
    assert newton[0] == "newton_step" and {"fast_inverse_2", "table_32_newton"} < set(newton)


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


def test_the_explained_mutants_exist():
    files = [*design.sources(), *design.headers()]
    assert set(mutation.explained()) <= {m.key for path in files for m in mutation.mutants(path)}
