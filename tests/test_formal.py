"""The fast proofs and their broken twins; `make formal` runs all."""

import pytest

from sim.build import RTL
from sim.formal.engine import SetupError, broken, run, verdict
from sim.formal.proofs import PROOFS, Twin

FAST = [proof for proof in PROOFS if proof.fast]
# One broken twin a proof, the rest under `make formal`.
TWINS = [(proof, proof.twins[0]) for proof in FAST if proof.twins]


@pytest.mark.parametrize("proof", FAST, ids=lambda p: p.name)
def test_proof(proof):
    assert not verdict(proof, run(proof, timeout=120))


@pytest.mark.parametrize(("proof", "twin"), TWINS, ids=lambda p: getattr(p, "name", ""))
def test_broken_twin_fails(proof, twin):
    assert not verdict(proof, run(proof, twin, timeout=120), twin)


def test_every_broken_twin_fits_the_design_once():
    for proof in PROOFS:
        for twin in proof.twins:
            text = (RTL / f"{twin.module}.v").read_text()
            assert broken(text, twin) != text


def test_a_broken_twin_that_fits_nowhere_is_refused():
    with pytest.raises(SetupError, match="fits 0 times"):
        broken("module m; endmodule", Twin("m", "old", "new", "a_property"))


def test_a_broken_twin_that_passes_is_an_error():
    proof = next(p for p in FAST if p.name == "interpolator")
    harmless = Twin("normal_interpolator", "stepped <= ~load;", "stepped <= !load;", "a_flagged", 4)
    said = verdict(proof, run(proof, harmless, timeout=120), harmless)
    assert len(said) == 1 and "should fail a_flagged; it gave pass" in said[0]
