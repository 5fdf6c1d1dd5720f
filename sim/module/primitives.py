"""The bench of the small modules, generated: all of them side by side, vectors through files.

Every instance sees the same three 64-bit input words a, b, c, a set of them every clock; the
outputs of the selected one go to a file, each output in a word of 64 bits, after its latency as
the RTL states it. One build serves all, and exhaustive tests run at the speed of the simulator.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge

from phong75.model.config import DEFAULT as C
from phong75.model.config import levels
from phong75.model.registers import address_bits, word_bits
from phong75.sim import environment
from phong75.sim.module.unit_tb import THIN

TOP = "primitives_bench"
EXHAUSTIVE = 1 << 16  # more vectors than that are all there are, and their order means nothing


@dataclass(frozen=True)
class Instance:
    """A module under test.

    inputs: {port: Verilog expression of a, b, c}; outputs: {port: bits}; latency: a Verilog
    expression, `dut` standing for the instance; wiring: declarations that `inputs` refer to.
    """

    module: str
    inputs: dict[str, str]
    outputs: dict[str, int]
    parameters: dict[str, int | str] = field(default_factory=dict)
    latency: str = "dut.LATENCY"
    wiring: str = ""


def _multiplier(a_bits, b_bits, a_signed, b_signed):
    return Instance(
        "multiplier",
        {"a": f"a[0+:{a_bits}]", "b": f"b[0+:{b_bits}]"},
        {"product": a_bits + b_bits},
        dict(A_BITS=a_bits, B_BITS=b_bits, A_SIGNED=a_signed, B_SIGNED=b_signed),
    )


def _narrow(a_bits, b_bits):
    return Instance(
        "narrow_multiplier",
        {"a": f"a[0+:{a_bits}]", "b": f"b[0+:{b_bits}]"},
        {"product": a_bits + b_bits},
        dict(A_BITS=a_bits, B_BITS=b_bits),
    )


def _constant(bits, signed, constant, constant_bits, wait=0):
    return Instance(
        "constant_multiplier", {"word": f"a[0+:{bits}]"}, {"product": bits + constant_bits},
        dict(BITS=bits, IS_SIGNED=signed, CONSTANT=constant, CONSTANT_BITS=constant_bits,
             LATENCY=levels(constant) + wait),
    )  # fmt: skip


def _leading_zeros(bits, count_bits):
    return Instance(
        "leading_zeros", {"word": f"a[0+:{bits}]"}, {"count": count_bits},
        dict(BITS=bits, COUNT_BITS=count_bits),
    )  # fmt: skip


def _left_shifter(bits, count_bits):
    return Instance(
        "left_shifter", {"word": f"a[0+:{bits}]", "count": f"b[0+:{count_bits}]"},
        {"shifted": bits}, dict(BITS=bits, COUNT_BITS=count_bits),
    )  # fmt: skip


def _round_saturate(in_bits, drop, out_bits, signed):
    return Instance(
        "round_saturate", {"in": f"a[0+:{in_bits}]"}, {"out": out_bits},
        dict(IN_BITS=in_bits, DROP=drop, OUT_BITS=out_bits, IS_SIGNED=signed),
    )  # fmt: skip


def _memory(module, address_bits, word_bits):
    return Instance(
        module,
        {
            "write_enable": f"b[{address_bits}]", "write_address": f"b[0+:{address_bits}]",
            "write_word": f"c[0+:{word_bits}]", "address": f"a[0+:{address_bits}]",
        },
        {"word": word_bits}, dict(ADDRESS_BITS=address_bits, WORD_BITS=word_bits),
    )  # fmt: skip


def _interpolator(bits):
    return Instance(
        "linear_interpolator",
        {
            "load": "c[0]", "advance": "c[1]",
            "start": f"a[0+:{bits}]", "step": f"b[0+:{bits}]",
        },
        {"value": bits, "overflow": 1}, dict(NORMAL_BITS=bits), latency="1",
    )  # fmt: skip


#: Contents of the ROM under test.
ROM_ADDRESS_BITS, ROM_WORD_BITS = 5, 7
ROM_WORDS = tuple((37 * k * k + 11 * k + 5) % (1 << ROM_WORD_BITS) for k in range(32))
_PACKED = sum(word << (k * ROM_WORD_BITS) for k, word in enumerate(ROM_WORDS))
_ROM = dict(
    ADDRESS_BITS=ROM_ADDRESS_BITS, WORD_BITS=ROM_WORD_BITS,
    CONTENTS=f"{len(ROM_WORDS) * ROM_WORD_BITS}'h{_PACKED:x}",
)  # fmt: skip

TABLE_ADDRESS_BITS = address_bits(C) - 1
SPECULAR_BITS = C.weight.bits + C.power.bits

MULTIPLIERS = {
    f"multiplier_{'us'[s]}{'us'[t]}_{m}x{n}": _multiplier(m, n, s, t)
    for s in (0, 1) for t in (0, 1) for m, n in ((5, 4), (18, 18))
}  # fmt: skip
ROUNDERS = {
    f"round_{'us'[signed]}_{n}_{drop}_{out}": _round_saturate(n, drop, out, signed)
    for n, drop, out in ((10, 4, 3), (10, 4, 6), (9, 1, 5), (9, 1, 8), (12, 7, 2))
    for signed in (0, 1)
}
#: All short constants; long ones with few, many and the most digits; one that waits.
CONSTANTS = {
    f"constant_{'us'[signed]}_{constant}": _constant(6, signed, constant, 5)
    for constant in range(32) for signed in (0, 1)
} | {
    f"constant_{'us'[signed]}_{constant}": _constant(18, signed, constant, 18)
    for constant in (1 << 17, (1 << 18) - 1, 0x15555, 0x2AAAA, 0x2DB6D, 26214, 98765)
    for signed in (0, 1)
} | {"constant_waits": _constant(18, 1, 0x2DB6D, 18, wait=2)}  # fmt: skip
MEMORIES = {
    "ram_4x9": _memory("ram", 4, 9), "ram_9x36": _memory("ram", 9, 36),
    "small_ram_3x9": _memory("small_ram", 3, 9), "small_ram_4x17": _memory("small_ram", 4, 17),
}  # fmt: skip
DELAYS = {
    f"delay_{n}": Instance(
        "delay", {"in": "a[0+:13]"}, {"out": 13}, dict(BITS=13, CYCLES=n), latency="dut.CYCLES"
    )
    for n in (0, 1, 2, 7)
}

#: Instances whose parameters are the ones that the modules have if nothing is said.
DEFAULTS = {
    "default_multiplier": _multiplier(18, 18, 1, 1),
    "default_constant_multiplier": _constant(18, 1, 1, 18, wait=3),
    "default_narrow_multiplier": _narrow(11, 7),
    "default_leading_zeros": _leading_zeros(31, 5),
    "default_left_shifter": _left_shifter(32, 5),
    "default_round_saturate": _round_saturate(36, 18, 18, 1),
    "default_ram": _memory("ram", 9, 36),
    "default_small_ram": _memory("small_ram", 4, 17),
    "default_delay": Instance("delay", {"in": "a[0]"}, {"out": 1}, latency="dut.CYCLES"),
    "default_rom": Instance("rom", {"address": "a[0+:9]"}, {"word": 36}),
}

INSTANCES: dict[str, Instance] = {
    **MULTIPLIERS,
    **CONSTANTS,
    "narrow_11x7": _narrow(11, 7), "narrow_5x8": _narrow(5, 8), "narrow_6x3": _narrow(6, 3),
    "zeros_31": _leading_zeros(31, 5), "zeros_22": _leading_zeros(22, 5),
    "zeros_10": _leading_zeros(10, 4), "zeros_12": _leading_zeros(12, 4),
    "shifter_10": _left_shifter(10, 4), "shifter_32": _left_shifter(32, 5),
    **ROUNDERS,
    **DELAYS,
    "rom_5x7": Instance("rom", {"address": f"a[0+:{ROM_ADDRESS_BITS}]"}, {"word": 7}, _ROM),
    **MEMORIES,
    "interpolator": _interpolator(C.normal.bits), "interpolator_5": _interpolator(5),
    "hold": Instance(
        "normal_hold",
        {
            "two_sided": "c[0]", "valid": "c[1]", "x": f"a[0+:{C.normal.bits}]",
            "y": f"b[0+:{C.normal.bits}]", "z": f"c[2+:{C.normal.bits}]",
        },
        {
            "held_valid": 1, "shown": 1, "held_x": C.normal.bits, "held_y": C.normal.bits,
            "held_z": C.normal.bits,
        },
        latency="1",
    ),
    "register_map": Instance(
        "register_map",
        {
            "write_enable": "b[0]", "write_address": f"a[0+:{address_bits(C)}]",
            "write_word": f"c[0+:{word_bits(C)}]",
        },
        {
            "half_x": C.half_vector.bits, "half_z": C.half_vector.bits, "two_sided": 1,
            "write_weight": 1, "write_exponent": 1, "write_ambient": 3, "write_diffuse": 3,
            "table_address": TABLE_ADDRESS_BITS, "table_word": word_bits(C),
            "unsupported": 1,
        },
        latency="1",
    ),
    # a: {material, lit, cosine}; b: specular; c: {diffuse, ambient, address, word} to write.
    # The material goes in first; cosine and lit wait for its table, specular for the product.
    "colour_channel": Instance(
        "colour_channel",
        {
            "write_diffuse": f"c[{C.coefficient.bits + C.material_bits + 1}]",
            "write_ambient": f"c[{C.coefficient.bits + C.material_bits}]",
            "write_address": f"c[{C.coefficient.bits}+:{C.material_bits}]",
            "write_word": f"c[0+:{C.coefficient.bits}]",
            "material_early": f"a[{C.cosine.bits + 1}+:{C.material_bits}]",
            "lit": "late_lit", "cosine": "late_cosine", "specular": "late_specular",
        },
        {"colour": C.colour_bits},
        latency="dut.LATENCY + `PHONG_SMALL_RAM_LATENCY",
        wiring=f"""\
  wire late_lit;
  wire [{C.cosine.bits - 1}:0] late_cosine;
  wire [{SPECULAR_BITS - 1}:0] late_specular;
  delay #(.BITS({C.cosine.bits + 1}), .CYCLES(`PHONG_SMALL_RAM_LATENCY)) u_late_cosine (
      .clk(clk), .in(a[{C.cosine.bits}:0]), .out({{late_lit, late_cosine}}));
  delay #(.BITS({SPECULAR_BITS}),
          .CYCLES(`PHONG_SMALL_RAM_LATENCY + `PHONG_MULTIPLIER_LATENCY)) u_late_specular (
      .clk(clk), .in(b[{SPECULAR_BITS - 1}:0]), .out(late_specular));
""",
    ),
    **DEFAULTS,
}  # fmt: skip

_BENCH = """\
// {top}: generated by sim/primitives.py
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module {top} (
    input wire clk,
    input wire        start,
    input wire [31:0] job,      // vectors of <dir>/<job>.in, outputs to <dir>/<job>.out
    input wire [31:0] vectors,
    input wire [31:0] select,   // number of the instance
    output reg        running
);

  reg [191:0] record;
  reg [63:0] a, b, c;

{instances}
  reg [1023:0] dir, name;
  reg [31:0] clocks;
  integer in_file, out_file, got;
  initial begin
    running = 0;
    if (!$value$plusargs("dir=%s", dir)) dir = ".";
  end

  always @(posedge clk) begin
    if (!running & start) begin
      $sformat(name, "%0s/%0d.in", dir, job);
      in_file = $fopen(name, "rb");
      $sformat(name, "%0s/%0d.out", dir, job);
      out_file = $fopen(name, "wb");
      case (select)
{latencies}
        default: ;
      endcase
      clocks <= 0;
      running <= 1;
    end else if (running) begin
      clocks <= clocks + 1;
      if (clocks < vectors) begin
        got = $fread(record, in_file);
        {{a, b, c}} <= record;
      end
      case (select)
{writes}
        default: ;
      endcase
      if (clocks == vectors + 16) begin
        running <= 0;
        $fclose(in_file);
        $fclose(out_file);
      end
    end
  end
endmodule
"""


def source(modules: tuple[str, ...] = ()) -> str:
    """The Verilog text of the bench: of all instances, or of those of `modules`."""
    instances, latencies, writes = [], [], []
    for k, (name, about) in enumerate(INSTANCES.items()):
        if modules and about.module not in modules:
            continue
        given = {} if name in DEFAULTS else about.parameters
        parameters = ", ".join(f".{n}({v})" for n, v in given.items())
        parameters = f" #({parameters})" if parameters else ""
        ports = [f".{port}({expression})" for port, expression in about.inputs.items()]
        ports += [f".{port}(o{k}_{port})" for port in about.outputs]
        ports.insert(0, ".clk(clk)")
        wires = [f"  wire [{bits - 1}:0] o{k}_{port};" for port, bits in about.outputs.items()]
        words = [
            f"{{{64 - bits}'d0, o{k}_{port}}}" for port, bits in reversed(about.outputs.items())
        ]
        instances.append(
            f"  // {name}\n{about.wiring}" + "\n".join(wires)
            + f"\n  {about.module}{parameters} dut_{k} (\n      {', '.join(ports)});\n"
            + f"  wire [{64 * len(words) - 1}:0] word_{k} = {{{', '.join(words)}}};\n"
            # An unknown, which a file cannot hold, becomes a value that no output has.
            + f"  wire [{64 * len(words) - 1}:0] seen_{k} =\n"
            + f"      ^word_{k} === 1'bx ? {{{64 * len(words)}{{1'b1}}}} : word_{k};\n"
            + f"  wire [63:0] latency_{k} = {about.latency.replace('dut.', f'dut_{k}.')};\n"
        )  # fmt: skip
        latencies.append(f'        {k}: $fwrite(out_file, "%u", latency_{k});')
        writes.append(f'        {k}: $fwrite(out_file, "%u", seen_{k});')
    return _BENCH.format(
        top=TOP, instances="\n".join(instances), latencies="\n".join(latencies),
        writes="\n".join(writes),
    )  # fmt: skip


class PrimitivesTB:
    """Sends vectors through one instance, one a clock, and compares what comes out."""

    def __init__(self, dut):
        self.dut = dut
        self.folder = Path(os.environ[environment.VECTORS])
        self.job = 0
        dut.start.value = 0
        Clock(dut.clk, 10, unit="ns", impl="gpi").start()

    async def send(self, name: str, a, b=0, c=0) -> dict[str, np.ndarray]:
        """Run vectors (int arrays of one length, or constants) through instance `name`.

        Returns {output: uint64[n]}, each at the instance's stated latency.
        """
        dut = self.dut
        await FallingEdge(dut.clk)  # past the start, where `running` comes from unknown to 0
        a, b, c = np.broadcast_arrays(*(np.asarray(v, np.int64) for v in (a, b, c)))
        n = len(a)
        np.stack([a, b, c], axis=1).astype(">i8").tofile(self.folder / f"{self.job}.in")
        dut.job.value, dut.vectors.value = self.job, n
        dut.select.value = list(INSTANCES).index(name)
        dut.start.value = 1
        await FallingEdge(dut.running)
        dut.start.value = 0
        await ClockCycles(dut.clk, 2)
        words = np.fromfile(self.folder / f"{self.job}.out", "<u8")
        (self.folder / f"{self.job}.out").unlink()
        self.job += 1
        outputs = INSTANCES[name].outputs
        first = 1 + int(words[0])  # a clock to put the first vector on
        rows = words[1:].reshape(-1, len(outputs))
        return {port: rows[first : first + n, k] for k, port in enumerate(outputs)}

    async def check(self, name: str, inputs, expected: dict, note: str = ""):
        """Send `inputs` (a, b, c); `expected` {output: int array} must come, modulo its width."""
        every = THIN if max(np.size(v) for v in inputs) > EXHAUSTIVE else 1
        inputs = [np.asarray(v)[::every] if np.ndim(v) else v for v in inputs]
        expected = {port: np.asarray(want)[::every] for port, want in expected.items()}
        got = await self.send(name, *inputs)
        about = INSTANCES[name]
        for port, want in expected.items():
            mask = np.uint64((1 << about.outputs[port]) - 1)
            want = np.asarray(want).astype(np.int64).astype(np.uint64) & mask
            bad = np.flatnonzero(want != got[port])
            if len(bad):
                i = int(bad[0])
                given = [hex(int(np.broadcast_to(v, want.shape)[i]) & (2**64 - 1)) for v in inputs]
                raise AssertionError(
                    f"module {about.module} ({name}), output {port}: {len(bad)} of {len(want)} "
                    f"vectors differ; first: number {i}, inputs {given}, expected {int(want[i])}, "
                    f"got {int(got[port][i])}; {note}"
                )
