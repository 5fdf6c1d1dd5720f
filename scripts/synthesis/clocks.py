# SPDX-License-Identifier: MIT
"""The clocks that place and route reported, kept in results/clocks.json.

To route all configurations of the sweep takes more than an hour, so what was routed is kept, with
the key of what it depends on. A clock counts only where that key is today's. Where Yosys and
nextpnr are not installed, the record's own versions of them are taken for today's.
"""

from __future__ import annotations

import datetime

from phong75.model.config import Config
from phong75.model.studies.methods import CONFIGS
from phong75.scripts import recorded
from phong75.scripts.synthesis import ecp5

NAME = "clocks"
GRADE, SEED = 6, 1
SOURCE = f"nextpnr, grade {GRADE}, seed {SEED}"
#: What is kept of a configuration besides key, date and commit.
SIZES = ("dsp", "lut_sites", "lut_cells", "ff", "ebr")
FIGURES = ("clock_mhz", *SIZES, "longest_path")


def key(config: Config) -> str:
    """Key of the clock of `config` today. Raises BuildError."""
    tools = ecp5.versions() if ecp5.installed() else _recorded_tools()
    return ecp5.design_key(config, GRADE, SEED, tools)


def _recorded_tools() -> dict[str, str]:
    """{package: version} of the record; empty without one."""
    return (recorded.load(NAME) or {}).get("tools", {})


def kept(config: Config) -> dict | None:
    """FIGURES and "clock_source" of `config`; None if none are kept, or of another design.

    Raises BuildError.
    """
    found = recorded.figures(NAME).get("configurations", {}).get(config.name)
    if found is None or found["key"] != key(config):
        return None
    return {name: found.get(name) for name in FIGURES} | {"clock_source": f"{SOURCE}, kept"}


def keep(name: str, found: dict) -> None:
    """Keep FIGURES and "clock_key" in `found` for the configuration `name`; others stay as they
    are, but for those that the sweep has no more."""
    old = recorded.figures(NAME).get("configurations", {})
    old[name] = {figure: found[figure] for figure in FIGURES} | {
        "key": found["clock_key"],
        "date": datetime.date.today().isoformat(),
        "commit": recorded.commit(),
    }
    configurations = {name: old[name] for name in CONFIGS if name in old}
    tools = tuple(ecp5.versions())
    recorded.save(NAME, "make sweep ROUTE=1", tools, {"configurations": configurations})
