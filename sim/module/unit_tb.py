# SPDX-License-Identifier: MIT
"""cocotb testbench class of the benches of `units`: compares every stage with the twin."""

from __future__ import annotations

import numpy as np
from cocotb.triggers import FallingEdge

from phong75.model.config import DEFAULT, Config
from phong75.model.frame import Frame
from phong75.model.registers import FIELDS, writes
from phong75.sim.module.units import MODULES, lanes
from phong75.sim.module.vector_bench import THIN, VectorTB


def first_difference(module: str, inputs, expected: dict, got: dict) -> str | None:
    """A message about the first stage, in data order, where `got` differs from `expected`.

    inputs: int arrays [n], one per input port. expected, got: {stage: int arrays [n]}. Returns None
    if all stages are equal.
    """
    for stage, arrays in expected.items():
        for k, (want, have) in enumerate(zip(arrays, got[stage], strict=True)):
            bad = np.flatnonzero(np.asarray(want) != have)
            if len(bad):
                i = int(bad[0])
                names = MODULES[module].inputs
                vector = {name: int(column[i]) for name, column in zip(names, inputs, strict=True)}
                return (
                    f"module {module}, stage {stage} (signal {k}): {len(bad)} of {len(have)} "
                    f"vectors differ; first: inputs {vector}, expected {int(want[i])}, "
                    f"got {int(have[i])}"
                )
    return None


class UnitTB(VectorTB):
    """Sends vectors through one module, one per cycle, and compares every stage with the twin."""

    def __init__(self, dut, module: str):
        super().__init__(dut)
        self.module = module
        for port, _ in MODULES[module].held:
            getattr(dut, port).value = 0

    async def hold(self, **values):
        """Set held ports to `values`; one cycle later the module has them."""
        await FallingEdge(self.dut.clk)
        for port, value in values.items():
            getattr(self.dut, port).value = value
        await FallingEdge(self.dut.clk)

    async def write_table(self, frame: Frame, config: Config = DEFAULT):
        """Write the material table of `frame`, decoded as in rtl/core/register_map.v."""
        kind = 1 << (config.material_bits + config.weight_index_bits)
        ports = [port for port, _ in MODULES[self.module].held]
        for address, word in writes(frame, config):
            field = address & ((1 << config.weight_index_bits) - 1)
            to_table = not address & kind
            strobes = {"write_enable": to_table, "write_weight": to_table}
            for name, count in (("ambient", 3), ("diffuse", 3), ("exponent", 1)):
                channel = field - FIELDS[name]
                hit = not to_table and 0 <= channel < count
                strobes[f"write_{name}"] = hit << channel if hit else 0
            strobes = {port: int(value) for port, value in strobes.items() if port in ports}
            await self.hold(write_address=address & (kind - 1), write_word=word, **strobes)
        await self.hold(**dict.fromkeys(strobes, 0))

    async def send(self, *inputs) -> dict[str, list[np.ndarray]]:
        """Send vectors; returns {stage: observed signals, int64[n] each}.

        inputs: int arrays [n], one per input port. Each signal is read at the latency that the
        RTL states, so that row i belongs to vector i.
        """
        n = len(inputs[0])
        observed = lanes(self.module)
        rows = (await self.run(inputs)).reshape(-1, len(observed))
        stages: dict[str, list[np.ndarray]] = {}
        for k, lane in enumerate(observed):
            latency = int(rows[0, k])
            first = 2 + latency  # one row of latencies; one cycle until the first vector is applied
            stages.setdefault(lane.stage, []).append(rows[first : first + n, k])
        return stages

    async def check(self, inputs, expected: dict, note: str = "", in_sequence: bool = False):
        """Send `inputs`; every stage must equal `expected` bit for bit.

        expected: {stage: int arrays [n]}, in data order. note: appended to the message of a
        failure. in_sequence: the module has state, so that vectors must stay in order.
        """
        if THIN > 1:
            some = slice(len(inputs[0]) // THIN) if in_sequence else slice(None, None, THIN)
            inputs = [np.asarray(column)[some] for column in inputs]
            expected = {k: [np.asarray(a)[some] for a in v] for k, v in expected.items()}
        got = await self.send(*inputs)
        difference = first_difference(self.module, inputs, expected, got)
        assert not difference, f"{difference}; {note}"
        missing = set(got) - set(expected)
        assert not missing, f"stages without expectation: {missing}"

    async def check_latency(self, quiet, active, stage: str):
        """Check the latency of `stage`: one `active` vector among `quiet` ones changes one row."""
        n = 400
        inputs = [np.full(n, q) for q in quiet]
        for column, value in zip(inputs, active, strict=True):
            column[300] = value
        signal = (await self.send(*inputs))[stage][0]
        changed = np.flatnonzero(signal[100:] != signal[100]) + 100
        assert changed.tolist() == [300], f"{stage}: changes at vectors {changed.tolist()}"
