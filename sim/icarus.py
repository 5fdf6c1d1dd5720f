# SPDX-License-Identifier: MIT
"""The module benches in Icarus Verilog, whose registers hold X until something is written to them.

Verilator knows 0 and 1 only. Here whatever depends on a register's contents at power-up comes out
as X, which no expected value equals. Slow: a thousandth of Verilator's speed, so that the tests
take few vectors (see THIN).
"""

from __future__ import annotations

import shutil
from pathlib import Path

from cocotb_tools.runner import Icarus

from phong75.model.config import DEFAULT, Config
from phong75.sim import design
from phong75.sim.build import BuildError, generate_header
from phong75.sim.design import BUILD, SIM

#: Of the vectors of the datapath's tests, one in so many.
THIN = 400


class IcarusBench(Icarus):
    """cocotb's runner for Icarus Verilog, with the arguments of `sim.build.Bench`."""

    def __init__(self, top: str, config: Config = DEFAULT, sources: dict[str, str] | None = None):
        """A bench with top level `top`: sim/<top>.v, or a text in `sources` (file name: text).

        Raises BuildError if Icarus is not installed.
        """
        if not shutil.which("iverilog"):
            raise BuildError("Icarus Verilog is missing: apt-get install iverilog")
        super().__init__()
        self._top, self._config, self._texts = top, config, dict(sources or {})

    def run(self, test_module: str, folder: Path, **arguments) -> Path:
        """Build, and run cocotb tests in `folder` (scratch). Returns the path of the results.

        Raises BuildError with the place of the compiler's log.
        """
        made = BUILD / "icarus" / self._top
        made.mkdir(parents=True, exist_ok=True)
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in self._texts.items():
            (made / name).write_text(text)
        name = f"{self._top}.v"
        top = made / name if name in self._texts else SIM / "module" / name
        log = made / "iverilog.log"
        try:
            self.build(
                sources=[*design.sources(), top],
                includes=[generate_header(self._config), *design.folders()],
                hdl_toplevel=self._top, build_dir=made, log_file=log, always=True,
                timescale=("1ns", "1ns"),
            )  # fmt: skip
        except (SystemExit, RuntimeError):
            raise BuildError(f"iverilog refused {self._top}: {log}") from None
        return self.test(
            test_module=test_module, hdl_toplevel=self._top, hdl_toplevel_lang="verilog",
            build_dir=made, test_dir=folder, log_file=folder / "sim.log",
            results_xml=str(folder / "results.xml"), **arguments,
        )  # fmt: skip
