# SPDX-License-Identifier: MIT
"""A sample of mutants; `make mutate` runs them all."""

import subprocess
import sys

from phong75.sim import design
from phong75.sim.design import PACKAGE
from tests.campaigns import mutation
from tests.campaigns.relevant_benches import BENCHES, FIRST, instances_of, relevant_benches

SAMPLE = 8
#: Files that the default configuration builds completely, and of which no mutant in the sample
#: hangs: that takes BENCH_SECONDS.
FILES = (
    "span_walker", "linear_interpolator", "inverse_sqrt_linear", "versine_of_cross",
    "specular_weight", "round_saturate", "left_shifter", "narrow_multiplier", "intensity_code",
)  # fmt: skip


def test_every_file_of_the_design_has_benches():
    unseen = {file.stem for file in design.sources()}
    for name in BENCHES:
        unseen -= set(instances_of(name))
        if not unseen:
            break
    assert not unseen, "no bench contains these modules"


def test_the_benches_of_a_file_come_first():
    for header in design.headers():
        assert next(relevant_benches(header)) == FIRST
    power = relevant_benches(design.module_file("specular_power_squaring"))
    assert [next(power), next(power)] == [
        "specular_power_squaring", "specular_power_squaring@squaring_14"
    ]  # fmt: skip
    assert next(relevant_benches(design.module_file("normalizer"))) == FIRST


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
