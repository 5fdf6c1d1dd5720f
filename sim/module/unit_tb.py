"""cocotb testbench of the generated module benches: vectors through files, compared by stage."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge

from phong75.model.config import DEFAULT, Config
from phong75.model.frame import Frame
from phong75.model.registers import FIELDS, writes
from phong75.sim import environment
from phong75.sim.module.units import MODULES, lanes

#: Only every so many vectors of `check` are sent: a slow simulator asks for it.
THIN = int(os.environ.get(environment.THIN, "1"))


def first_difference(module: str, inputs, expected: dict, got: dict) -> str | None:
    """One line on the first stage, in the order of the data, where `got` is not `expected`.

    Both {stage: (int arrays)}. None if all is the same.
    """
    for stage, arrays in expected.items():
        for k, (want, have) in enumerate(zip(arrays, got[stage], strict=True)):
            bad = np.flatnonzero(np.asarray(want) != have)
            if len(bad):
                i = int(bad[0])
                names = MODULES[module].inputs
                given = {name: int(column[i]) for name, column in zip(names, inputs, strict=True)}
                return (
                    f"module {module}, stage {stage} (signal {k}): {len(bad)} of {len(have)} "
                    f"vectors differ; first: inputs {given}, expected {int(want[i])}, "
                    f"got {int(have[i])}"
                )
    return None


class UnitTB:
    """Sends vectors through one module, one a clock, and compares every stage with the twin."""

    def __init__(self, dut, module: str):
        self.dut, self.module = dut, module
        self.folder = Path(os.environ[environment.VECTORS])
        self.job = 0
        self.latency: dict[str, int] = {}
        dut.start.value = 0
        for port, _ in MODULES[module].held:
            getattr(dut, port).value = 0
        Clock(dut.clk, 10, unit="ns", impl="gpi").start()

    async def hold(self, **values):
        """Set held ports, and give them a clock to arrive."""
        await FallingEdge(self.dut.clk)
        for port, value in values.items():
            getattr(self.dut, port).value = value
        await FallingEdge(self.dut.clk)

    async def write_table(self, frame: Frame, config: Config = DEFAULT):
        """Write the material table of `frame`, decoded as rtl/register_map.v does it."""
        kind = 1 << (config.material_bits + config.weight_index_bits)
        has = [port for port, _ in MODULES[self.module].held]
        for address, word in writes(frame, config):
            field = address & ((1 << config.weight_index_bits) - 1)
            to_table = not address & kind
            strobes = {"write_enable": to_table, "write_weight": to_table}
            for name, count in (("ambient", 3), ("diffuse", 3), ("exponent", 1)):
                place = field - FIELDS[name]
                hit = not to_table and 0 <= place < count
                strobes[f"write_{name}"] = hit << place if hit else 0
            strobes = {port: int(value) for port, value in strobes.items() if port in has}
            await self.hold(write_address=address & (kind - 1), write_word=word, **strobes)
        await self.hold(**dict.fromkeys(strobes, 0))

    async def send(self, *inputs) -> dict[str, list[np.ndarray]]:
        """Run the vectors `inputs` (int arrays of one length, one per input port).

        Returns the observed signals, {stage: [int64[n], ...]}, each at its stated latency.
        """
        dut, n = self.dut, len(inputs[0])
        await FallingEdge(dut.clk)  # past the start, where `running` comes from unknown to 0
        stacked = np.stack([np.asarray(i, np.int64) for i in inputs], axis=1)
        stacked.astype(">i8").tofile(self.folder / f"{self.job}.in")
        dut.job.value, dut.vectors.value = self.job, n
        dut.start.value = 1
        await FallingEdge(dut.running)
        dut.start.value = 0
        await ClockCycles(dut.clk, 2)
        observed = lanes(self.module)
        path = self.folder / f"{self.job}.out"
        out = np.fromfile(path, "<i8").reshape(-1, len(observed))
        path.unlink()
        self.job += 1
        stages: dict[str, list[np.ndarray]] = {}
        for k, lane in enumerate(observed):
            latency = self.latency[lane.stage] = int(out[0, k])
            first = 2 + latency  # one record of latencies, one clock to put the vector on
            stages.setdefault(lane.stage, []).append(out[first : first + n, k])
        return stages

    async def check(self, inputs, expected: dict, note: str = "", in_sequence: bool = False):
        """Send `inputs`; every stage of `expected` {stage: (int arrays)} must come to the bit.

        in_sequence: what comes of a vector depends on those before it.
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
        """A single `active` vector among `quiet` ones shows at `stage` after its latency only."""
        n = 400
        inputs = [np.full(n, q) for q in quiet]
        for column, value in zip(inputs, active, strict=True):
            column[300] = value
        signal = (await self.send(*inputs))[stage][0]
        changed = np.flatnonzero(signal[100:] != signal[100]) + 100
        assert changed.tolist() == [300], f"{stage}: changes at vectors {changed.tolist()}"
