# SPDX-License-Identifier: MIT
"""The fast proofs and their broken twins; `make formal` runs all."""

import pytest

from phong75.sim import design
from phong75.sim.formal.engine import SetupError, broken, run, verdict
from phong75.sim.formal.proofs import PROOFS, BrokenDesign

FAST = [proof for proof in PROOFS if proof.fast]
# One broken change a proof, the rest under `make formal`.
TWINS = [(proof, proof.broken_designs[0]) for proof in FAST if proof.broken_designs]


@pytest.mark.parametrize("proof", FAST, ids=lambda p: p.name)
def test_proof(proof):
    assert not verdict(proof, run(proof, cpu_s=300))


@pytest.mark.parametrize(("proof", "change"), TWINS, ids=lambda p: getattr(p, "name", ""))
def test_broken_design_fails(proof, change):
    assert not verdict(proof, run(proof, change, cpu_s=300), change)


def test_every_broken_design_fits_the_design_once():
    for proof in PROOFS:
        for change in proof.broken_designs:
            text = design.module_file(change.module).read_text()
            assert broken(text, change) != text


def test_a_broken_design_that_fits_nowhere_is_refused():
    with pytest.raises(SetupError, match="occurs 0 times"):
        broken("module m; endmodule", BrokenDesign("m", "old", "new", "a_property"))


def test_a_broken_design_that_passes_is_an_error():
    proof = next(p for p in FAST if p.name == "interpolator")
    harmless = BrokenDesign(
        "linear_interpolator", "stepped <= ~load;", "stepped <= !load;", "a_flagged", 4
    )
    failures = verdict(proof, run(proof, harmless, cpu_s=300), harmless)
    assert len(failures) == 1 and "should fail a_flagged; it gave pass" in failures[0]
