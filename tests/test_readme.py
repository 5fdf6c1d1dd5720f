"""The README's numbers and examples, held to what they are about."""

import re

import numpy as np

from phong75.model import registers, spans
from phong75.model.analysis import error_budget
from phong75.model.config import DEFAULT as C
from phong75.model.config import TECHNIQUES
from phong75.model.studies.methods import CONFIGS
from phong75.scripts import recorded
from phong75.sim import design
from phong75.sim.design import PACKAGE
from phong75.sim.elaborate import instances
from phong75.sim.formal.proofs import PROOFS
from phong75.sim.latency import latencies
from tests.campaigns import mutation
from tests.test_error import frame_of

README = (PACKAGE / "README.md").read_text()


def test_latencies():
    of = latencies()
    assert f"{of['normalizer']} clocks       {of['shading_unit']} clocks" in README
    parts = {
        "reflection": 0,
        "specular_power_tables": 0,
        "specular_weight": 0,
        "inverse_sqrt_linear": 0,
    }
    for block in parts:
        assert f"{block} ({of[block]})" in README, block
    assert f"colour_channel ×3 ({of['colour_channel']})" in README
    assert f"the first comes {of['pixel'] + 3} clocks after its span" in README
    for technique in ("gouraud", "flat"):
        pixel = latencies(TECHNIQUES[technique])["pixel"]
        assert f"the first pixel {pixel + 3} clocks after its span" in " ".join(README.split())


def test_bounds():
    worst = {n: max(error_budget.bound_lsb(frame_of(a, n)) for a in np.linspace(0, np.pi, 33))
             for n in (32, 128)}  # fmt: skip
    said = re.search(r"at most (0\.\d+) LSB of 8 bits for n ≤ 32 and (0\.\d+) for n = 128", README)
    for n, text in zip((32, 128), said.groups(), strict=True):
        assert worst[n] <= float(text) <= worst[n] + 0.01, n
    jump = np.where(np.arange(C.weight_points) < C.weight_points // 2, 0.0, 1.0)
    more = error_budget.bound_lsb(frame_of(0.5, 32, weight=jump)) - worst[32]
    text = re.search(r"a jump of W from 0 to 1 adds (0\.\d+)", README)[1]
    assert more <= float(text) <= more + 0.01


def test_formats():
    last = spans.span_fields(C)[-2]
    assert last.name == "material" and f"material ({last.bits} bits)" in README
    assert f"`write_address` of {registers.address_bits(C)} bits" in README
    assert f"`write_word` of {registers.word_bits(C)}" in README
    for name, fmt in (("n", C.exponent), ("hx, hz", C.half_vector)):
        assert f"{name} ({fmt})" in README


def test_the_multipliers_are_counted():
    """In the default configuration, as it is elaborated."""
    count = instances()["multiplier"]
    assert f"The default configuration has {count} multipliers" in README
    assert count <= 19


def test_the_table_of_hardware_is_that_of_the_records():
    assert recorded.table() in README, "the README's table is old: make hardware"


def test_the_proofs_are_counted():
    unbounded = sum(proof.mode == "prove" for proof in PROOFS)
    twins = sum(len(proof.broken_designs) for proof in PROOFS)
    said = (
        f"{len(PROOFS)} of {len(PROOFS)} proofs hold, {unbounded} of them by unbounded induction; "
        f"{twins} of {twins} broken designs fail"
    )
    assert said in recorded.table(), "the record is old: make formal"


def test_the_explained_mutants_exist():
    files = [*design.sources(), *design.headers()]
    assert set(mutation.explained()) <= {m.key for path in files for m in mutation.mutants(path)}


def test_the_python_example_runs(capsys):
    code = re.search(r"```python\n(.*?)```", README, re.S)[1]
    exec(compile(code, "README.md", "exec"), {})
    assert float(capsys.readouterr().out) < 0.6


def test_the_spread_of_clocks():
    """Those whose longest path starts in what all configurations share; and what goes beyond."""
    by_name = recorded.load("clocks")["configurations"]
    kept, text = by_name.values(), " ".join(README.split())
    starts = ("span_walker", "pixel_fifo", "phong_pipeline", "phong_unit", "harness")
    shared = [c["clock_mhz"] for c in kept if c["longest_path"].split()[0] in starts]
    said = re.search(
        r"In (\d+) of (\d+) the longest path starts in the flow control or the harness, which all "
        r"share, and their clocks alone run from (\d+) to (\d+) MHz",
        text,
    )
    found = (len(shared), len(kept), round(min(shared)), round(max(shared)))
    assert tuple(map(int, said.groups())) == found
    for name, clock in by_name.items():
        if clock["longest_path"].startswith("rom "):
            assert f"{name} {clock['clock_mhz']:.0f}" in text
    missing = len(CONFIGS) - len(by_name)
    said = re.search(r"(\d+) of which are not routed yet", text)
    assert (int(said[1]) if said else 0) == missing
    own = [c["clock_mhz"] for name, c in by_name.items() if name.startswith("quadratic_spans")]
    assert f"their additions, {min(own):.0f} to {max(own):.0f} MHz" in text
