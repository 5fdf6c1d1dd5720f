# SPDX-License-Identifier: MIT
"""Generated bench of the small modules: all instances side by side in one build.

In every cycle all instances get the same vector of three 64-bit words a, b, c. A job selects one
instance, whose outputs go to the file, one 64-bit word per output. The RTL states the latency of
each instance.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from phong75.model.config import DEFAULT as C
from phong75.model.registers import address_bits, word_bits
from phong75.model.twin.pruning.constant_multiplier import levels
from phong75.sim.module.vector_bench import THIN, VectorTB, bench_text, known, write

TOP = "primitives_bench"

#: Cycles that the bench runs after the last vector: more than the latency of any instance.
TAIL = 16

#: A test with more vectors than this is exhaustive; the order of its vectors does not matter.
EXHAUSTIVE = 1 << 16


@dataclass(frozen=True)
class Instance:
    """One instance of a module under test.

    module: its name. inputs: {input port: Verilog expression of a, b, c}. outputs: {output port:
    width}. parameters: of the instance. latency: cycles from inputs to outputs, a Verilog
    expression in which `dut` stands for the instance. wiring: Verilog declarations that `inputs`
    use.
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


def _second_differences(bits, extra):
    return Instance(
        "second_difference_interpolator",
        {
            "load": f"c[{bits + extra}]", "advance": f"c[{bits + extra + 1}]",
            "start": f"a[0+:{bits}]", "step": f"b[0+:{bits}]", "bend": f"c[0+:{bits + extra}]",
        },
        {"value": bits, "overflow": 1}, dict(NORMAL_BITS=bits, EXTRA_BITS=extra), latency="1",
    )  # fmt: skip


#: Size and contents of the ROM under test.
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
#: All constants of 5 bits; constants of 18 bits with few, many and the most digits; one multiplier
#: with a longer latency than necessary.
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

#: Instances with the default parameters of their modules; `parameters` only says what these are.
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
    "second_differences": _second_differences(C.normal.bits, C.bend_fraction_bits),
    "second_differences_7": _second_differences(7, 3),
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
    # a: {material, lit, cosine}. b: specular. c: {write diffuse, write ambient, address, word}.
    # The material is applied first. Cosine and lit are delayed by the latency of the material's
    # table, specular by that of the table and of the multiplier.
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


def modules() -> list[str]:
    """The modules that INSTANCES has instances of."""
    return list(dict.fromkeys(instance.module for instance in INSTANCES.values()))


def source(only: tuple[str, ...] = ()) -> str:
    """The Verilog text of the bench. only: modules whose instances the bench contains, else all."""
    lines, latencies, writes = ["  wire [63:0] a, b, c;", "  assign {a, b, c} = vector;"], [], []
    for k, (name, instance) in enumerate(INSTANCES.items()):
        if only and instance.module not in only:
            continue
        lines.append(f"  // {name}\n{instance.wiring}".rstrip())
        ports = [".clk(clk)"]
        ports += [f".{port}({expression})" for port, expression in instance.inputs.items()]
        words = []
        for port, bits in instance.outputs.items():
            output = f"{port}_{k}"
            lines.append(f"  wire [{bits - 1}:0] {output};")
            lines.append(f"  wire [63:0] word_{output} = {{{64 - bits}'d0, {output}}};")
            ports.append(f".{port}({output})")
            words.insert(0, known(f"word_{output}"))
        values = {} if name in DEFAULTS else instance.parameters
        values = ", ".join(f".{parameter}({value})" for parameter, value in values.items())
        lines += [
            f"  {instance.module}{f' #({values})' if values else ''} dut_{k} (",
            f"      {', '.join(ports)});",
            f"  wire [64*{len(words)}-1:0] signals_{k} = {{{', '.join(words)}}};",
            f"  wire [63:0] latency_{k} = {instance.latency.replace('dut.', f'dut_{k}.')};",
        ]
        latencies.append(f"        {k}: {write(f'latency_{k}')}")
        writes.append(f"        {k}: {write(f'signals_{k}')}")

    def selected(statements: list[str]) -> str:
        cases = "\n".join(statements)
        return f"      case (select)\n{cases}\n        default: ;\n      endcase"

    return bench_text(
        TOP, "sim/module/primitives.py", 3, "\n".join(lines), selected(latencies),
        selected(writes), TAIL,
        ports="    input wire [31:0] select,   // number of the instance\n",
    )  # fmt: skip


class PrimitivesTB(VectorTB):
    """Sends vectors through one instance, one per cycle, and compares its outputs."""

    async def send(self, name: str, a, b=0, c=0) -> dict[str, np.ndarray]:
        """Send vectors through the instance `name`; returns {output: int64[n]}.

        a, b, c: words of the vectors, int arrays of one length or constants. Outputs are read at
        the latency that the RTL states, so that row i belongs to vector i.
        """
        inputs = np.broadcast_arrays(*(np.asarray(word, np.int64) for word in (a, b, c)))
        words = await self.run(inputs, select=list(INSTANCES).index(name))
        outputs = INSTANCES[name].outputs
        first = 1 + int(words[0])  # one cycle until the first vector is applied
        rows = words[1:].reshape(-1, len(outputs))[first : first + len(inputs[0])]
        return {port: rows[:, k] for k, port in enumerate(outputs)}

    async def check(self, name: str, inputs, expected: dict, note: str = ""):
        """Send `inputs` (a, b, c) through the instance `name` and compare its outputs.

        expected: {output: int array [n]}, compared modulo the output's width. note: appended to the
        message of a failure.
        """
        every = THIN if max(np.size(v) for v in inputs) > EXHAUSTIVE else 1
        inputs = [np.asarray(v)[::every] if np.ndim(v) else v for v in inputs]
        expected = {port: np.asarray(want)[::every] for port, want in expected.items()}
        got = await self.send(name, *inputs)
        instance = INSTANCES[name]
        for port, want in expected.items():
            want = want.astype(np.int64) & ((1 << instance.outputs[port]) - 1)
            bad = np.flatnonzero(want != got[port])
            if len(bad):
                i = int(bad[0])
                vector = [hex(int(np.broadcast_to(v, want.shape)[i]) & (2**64 - 1)) for v in inputs]
                raise AssertionError(
                    f"module {instance.module} ({name}), output {port}: {len(bad)} of {len(want)} "
                    f"vectors differ; first: number {i}, inputs {vector}, expected {int(want[i])}, "
                    f"got {int(got[port][i])}; {note}"
                )
