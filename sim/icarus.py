# SPDX-License-Identifier: MIT
"""Module benches in Icarus Verilog, where a register holds X until it is written.

Verilator simulates only 0 and 1. In Icarus Verilog an output that depends on the contents of a
register at power-up is X, which no expected value equals. Icarus Verilog has about 1/1000 of
Verilator's speed, so that the tests send only a part of their vectors (THIN).
"""

from __future__ import annotations

import shutil
from pathlib import Path

from cocotb_tools.runner import Icarus

from phong75.model.config import DEFAULT, Config
from phong75.sim import design
from phong75.sim.build import BuildError, generate_header
from phong75.sim.design import BUILD, SIM

#: The datapath's tests send one of this many vectors.
THIN = 400


class IcarusBench(Icarus):
    """cocotb's runner for Icarus Verilog, with the arguments of `sim.build.Bench`."""

    def __init__(self, top: str, config: Config = DEFAULT, sources: dict[str, str] | None = None):
        """A bench with top level `top`: sim/module/<top>.v, or a text of `sources` {name: text}.

        Raises BuildError if Icarus Verilog is not installed.
        """
        if not shutil.which("iverilog"):
            raise BuildError("Icarus Verilog is missing: apt-get install iverilog")
        super().__init__()
        self._top, self._config, self._texts = top, config, dict(sources or {})

    def run(self, test_module: str, folder: Path, **arguments) -> Path:
        """Build, then run the cocotb tests of `test_module` in `folder` (scratch).

        Returns the path of the results. Raises BuildError that names the compiler's log.
        """
        build = BUILD / "icarus" / self._top
        build.mkdir(parents=True, exist_ok=True)
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in self._texts.items():
            (build / name).write_text(text)
        name = f"{self._top}.v"
        top = build / name if name in self._texts else SIM / "module" / name
        log = build / "iverilog.log"
        try:
            self.build(
                sources=[*design.sources(), top],
                includes=[generate_header(self._config), *design.folders()],
                hdl_toplevel=self._top, build_dir=build, log_file=log, always=True,
                timescale=("1ns", "1ns"),
            )  # fmt: skip
        except (SystemExit, RuntimeError):
            raise BuildError(f"iverilog failed on {self._top}, see {log}") from None
        return self.test(
            test_module=test_module, hdl_toplevel=self._top, hdl_toplevel_lang="verilog",
            build_dir=build, test_dir=folder, log_file=folder / "sim.log",
            results_xml=str(folder / "results.xml"), **arguments,
        )  # fmt: skip
