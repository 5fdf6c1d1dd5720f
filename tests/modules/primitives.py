# SPDX-License-Identifier: MIT
"""cocotb tests of the small modules: exhaustive for small inputs, else random and corner cases.

tests/test_modules.py runs all tests in one simulation, in the bench of sim/module/primitives.py.
One vector enters per cycle; the outputs are compared at the latency that the module states. Every
test has the name of its module.
"""

from __future__ import annotations

import os

import cocotb
import numpy as np

from phong75.model.config import DEFAULT as C
from phong75.model.registers import FIELDS, address_bits, word_bits
from phong75.model.twin.pruning import normal_hold as twin
from phong75.sim import environment
from phong75.sim.module.primitives import (
    DEFAULTS,
    INSTANCES,
    ROM_WORDS,
    ROUNDERS,
    SPECULAR_BITS,
    TABLE_ADDRESS_BITS,
    PrimitivesTB,
)

SEED = int(os.environ.get(environment.SEED, "75"))
NOTE = f"seed {SEED}"
RANDOM = 20_000


def _of(module: str) -> list[cocotb.Param]:
    """The names of the instances of `module`, for parametrize."""
    names = [name for name, instance in INSTANCES.items() if instance.module == module]
    return [cocotb.Param(name, name) for name in names]


def _signed(word, bits: int):
    """The value of a two's complement `word` of `bits` bits."""
    return word - ((word >> (bits - 1) & 1) << bits)


def _corners(rng, bits: int, n: int = RANDOM) -> np.ndarray:
    """Random words, a third of them within 2 of 0 or of a power of two."""
    near = (1 << rng.integers(0, bits + 1, n)) + rng.integers(-2, 3, n)
    word = np.where(rng.random(n) < 1 / 3, near, rng.integers(0, 1 << bits, n))
    return word & ((1 << bits) - 1)


def _pairs(rng, a_bits: int, b_bits: int):
    """All pairs of words if these are at most 2**18, else random words and corner cases."""
    if a_bits + b_bits <= 18:
        pairs = np.arange(1 << (a_bits + b_bits))
        return pairs & ((1 << a_bits) - 1), pairs >> a_bits
    return _corners(rng, a_bits), _corners(rng, b_bits)


@cocotb.test()
@cocotb.parametrize(name=_of("multiplier"))
async def multiplier(dut, name):
    """All pairs of small words, corner cases of large ones, signed and unsigned."""
    p = INSTANCES[name].parameters
    a, b = _pairs(np.random.default_rng(SEED), p["A_BITS"], p["B_BITS"])
    x = _signed(a, p["A_BITS"]) if p["A_SIGNED"] else a
    y = _signed(b, p["B_BITS"]) if p["B_SIGNED"] else b
    await PrimitivesTB(dut).check(name, (a, b), {"product": x * y}, NOTE)


@cocotb.test()
@cocotb.parametrize(name=_of("narrow_multiplier"))
async def narrow_multiplier(dut, name):
    """All pairs of words."""
    p = INSTANCES[name].parameters
    a, b = _pairs(np.random.default_rng(SEED), p["A_BITS"], p["B_BITS"])
    await PrimitivesTB(dut).check(name, (a, b), {"product": a * b})


@cocotb.test()
@cocotb.parametrize(name=_of("constant_multiplier"))
async def constant_multiplier(dut, name):
    """All short words, corner cases of long ones."""
    p = INSTANCES[name].parameters
    bits = p["BITS"]
    short = np.arange(1 << bits)
    a = short if bits < 10 else _corners(np.random.default_rng(SEED), bits, 2000)
    x = _signed(a, bits) if p["IS_SIGNED"] else a
    await PrimitivesTB(dut).check(name, (a,), {"product": x * p["CONSTANT"]}, NOTE)


@cocotb.test()
@cocotb.parametrize(name=_of("leading_zeros"))
async def leading_zeros(dut, name):
    """Every position of the leading one with random bits below, zero, and all short words."""
    bits = INSTANCES[name].parameters["BITS"]
    rng = np.random.default_rng(SEED)
    top = np.repeat(np.arange(bits), 200)
    word = (1 << top) | rng.integers(0, 1 << bits, len(top)) & ((1 << top) - 1)
    word = np.concatenate([word, 1 << np.arange(bits), [0, 0]])
    word = np.arange(1 << bits) if bits <= 12 else rng.permutation(word)
    count = [bits - int(w).bit_length() for w in word]
    await PrimitivesTB(dut).check(name, (word,), {"count": count}, NOTE)


@cocotb.test()
@cocotb.parametrize(name=_of("left_shifter"))
async def left_shifter(dut, name):
    """Every count; also every word if words are short."""
    p = INSTANCES[name].parameters
    word, count = _pairs(np.random.default_rng(SEED), p["BITS"], p["COUNT_BITS"])
    await PrimitivesTB(dut).check(name, (word, count), {"shifted": word << count}, NOTE)


@cocotb.test()
@cocotb.parametrize(name=_of("round_saturate"))
async def round_saturate(dut, name):
    """Every word if words are short, for several widths, signed and unsigned."""
    p = INSTANCES[name].parameters
    bits, signed = p["IN_BITS"], p["IS_SIGNED"]
    word = np.arange(1 << bits) if name in ROUNDERS else _round_words(p)
    value = _signed(word, bits) if signed else word
    half_up = (value + (1 << (p["DROP"] - 1))) >> p["DROP"]
    low = -(1 << (p["OUT_BITS"] - 1)) if signed else 0
    clamped = np.clip(half_up, low, low + (1 << p["OUT_BITS"]) - 1)
    await PrimitivesTB(dut).check(name, (word,), {"out": clamped}, NOTE)


def _round_words(p):
    """Corner cases of all input bits, and of the bits that reach the output without saturation."""
    rng = np.random.default_rng(SEED)
    word = _corners(rng, p["IN_BITS"])
    small = _corners(rng, p["DROP"] + p["OUT_BITS"])
    mixed = np.where(rng.random(RANDOM) < 0.5, word, small)
    return mixed & ((1 << p["IN_BITS"]) - 1)


@cocotb.test()
@cocotb.parametrize(name=_of("delay"))
async def delay(dut, name):
    """Random words come out CYCLES cycles later."""
    word = np.random.default_rng(SEED).integers(0, 1 << 13, 500)
    await PrimitivesTB(dut).check(name, (word,), {"out": word}, NOTE)


@cocotb.test()
@cocotb.parametrize(name=_of("rom"))
async def rom(dut, name):
    """Every word, in order and in random order; a ROM without contents holds zeros."""
    words = np.zeros(512, np.int64) if name in DEFAULTS else np.array(ROM_WORDS)
    rng = np.random.default_rng(SEED)
    address = np.concatenate([np.arange(len(words)), rng.integers(0, len(words), 500)])
    await PrimitivesTB(dut).check(name, (address,), {"word": words[address]}, NOTE)


@cocotb.test()
@cocotb.parametrize(name=_of("ram"))
async def ram(dut, name):
    """See `_memory`."""
    await _memory(dut, name)


@cocotb.test()
@cocotb.parametrize(name=_of("small_ram"))
async def small_ram(dut, name):
    """See `_memory`."""
    await _memory(dut, name)


async def _memory(dut, name):
    """Random writes and reads in the same cycles; a read of a word being written gives the old."""
    p = INSTANCES[name].parameters
    size, rng = 1 << p["ADDRESS_BITS"], np.random.default_rng(SEED)
    n = 2 * size + 4000
    write = np.concatenate([np.ones(size, int), rng.integers(0, 2, n - size)])
    write_address = np.concatenate([np.arange(size), rng.integers(0, size, n - size)])
    write_word = rng.integers(0, 1 << p["WORD_BITS"], n)
    address = np.where(rng.random(n) < 0.3, write_address, rng.integers(0, size, n))
    tb = PrimitivesTB(dut)
    b = write << p["ADDRESS_BITS"] | write_address
    await tb.send(name, address[:size], b[:size], write_word[:size])
    contents, expected = write_word[:size].copy(), np.empty(n, np.int64)
    for k in range(n):
        expected[k] = contents[address[k]]
        if write[k]:
            contents[write_address[k]] = write_word[k]
    await tb.check(name, (address, b, write_word), {"word": expected}, NOTE)


@cocotb.test()
@cocotb.parametrize(name=_of("linear_interpolator"))
async def linear_interpolator(dut, name):
    """Random values, loaded or added; overflow stays 1 after a sum left the word, until a load."""
    bits = INSTANCES[name].parameters["NORMAL_BITS"]
    rng = np.random.default_rng(SEED)
    n = RANDOM
    start, step = (_signed(_corners(rng, bits, n), bits) for _ in range(2))
    step = np.where(rng.random(n) < 0.5, step >> rng.integers(0, bits, n), step)
    load = rng.random(n) < 0.15
    advance = rng.random(n) < 0.7
    load[0] = advance[0] = True
    value, overflow = np.empty(n, np.int64), np.empty(n, np.int64)
    exact = held = 0
    for k in range(n):
        if advance[k] and load[k]:
            exact, held, over = int(start[k]), int(step[k]), False
        elif advance[k]:
            exact += held
            over |= not -(1 << (bits - 1)) <= exact < 1 << (bits - 1)
        value[k], overflow[k] = exact, over
    control = load | advance << 1
    expected = {"value": value, "overflow": overflow}
    await PrimitivesTB(dut).check(name, (start, step, control), expected, NOTE)


@cocotb.test()
@cocotb.parametrize(name=_of("second_difference_interpolator"))
async def second_difference_interpolator(dut, name):
    """Random values, loaded or added, of small and large bends. Overflow stays 1 after a value left
    the word, or a step that led to a pixel, until a load."""
    p = INSTANCES[name].parameters
    bits, extra = p["NORMAL_BITS"], p["EXTRA_BITS"]
    wide, rng, n = bits + extra, np.random.default_rng(SEED), 2 * RANDOM
    start, step = (_signed(_corners(rng, bits, n), bits) for _ in range(2))
    bend = _signed(_corners(rng, wide, n), wide)
    step = np.where(rng.random(n) < 0.5, step >> rng.integers(0, bits, n), step)
    bend = np.where(rng.random(n) < 0.8, bend >> rng.integers(0, wide, n), bend)
    load = rng.random(n) < 0.15
    advance = rng.random(n) < 0.7
    load[0] = advance[0] = True
    value, overflow = np.empty(n, np.int64), np.empty(n, np.int64)
    exact = held = held_bend = 0

    def leaves(code):
        return not -(1 << (wide - 1)) <= code < 1 << (wide - 1)

    steep = fell = 0  # steps and values that left the word
    for k in range(n):
        if advance[k] and load[k]:
            exact, held, held_bend = (
                int(w) for w in (start[k] << extra, step[k] << extra, bend[k])
            )
            over = False
        elif advance[k]:
            steep += leaves(held) and not over
            over |= leaves(held)
            exact += held
            fell += leaves(exact) and not over
            over |= leaves(exact)
            held += held_bend
        value[k] = exact >> extra | (exact % (1 << extra) != 0)
        overflow[k] = over
    assert min(steep, fell) > 100, (steep, fell)
    control = load | advance << 1
    inputs = start, step, bend % (1 << wide) | control << wide
    expected = {"value": value, "overflow": overflow}
    await PrimitivesTB(dut).check(name, inputs, expected, NOTE)


@cocotb.test()
async def normal_hold(dut):
    """The last normal that may be lit is held during other normals and cycles without a pixel."""
    rng = np.random.default_rng(SEED)
    x, y, z = (_corners(rng, C.normal.bits) for _ in range(3))
    two_sided, valid = rng.random(RANDOM) < 0.3, rng.random(RANDOM) < 0.5
    valid[0] = two_sided[0] = True
    normal = np.stack([_signed(word, C.normal.bits) for word in (x, y, z)])
    held = twin.normal_hold(normal[:, valid], two_sided[valid])[0][:, np.cumsum(valid) - 1]
    expected = {"held_valid": valid, "shown": two_sided | (normal[2] >= 0)}
    expected |= dict(zip(("held_x", "held_y", "held_z"), held, strict=True))
    inputs = x, y, z << 2 | valid << 1 | two_sided
    await PrimitivesTB(dut).check("hold", inputs, expected, NOTE)


@cocotb.test()
async def register_map(dut):
    """Every address sets its register or its strobe and no other, and only with write_enable."""
    rng = np.random.default_rng(SEED)
    registers = {"half_x": C.half_vector.bits, "half_z": C.half_vector.bits, "control": 1}
    address = np.concatenate([
        [1 << TABLE_ADDRESS_BITS | FIELDS[name] for name in registers],
        rng.permutation(1 << address_bits(C)), rng.integers(0, 1 << address_bits(C), RANDOM),
    ])  # fmt: skip
    enable = rng.random(len(address)) < 0.8
    enable[: len(registers)] = True
    word = rng.integers(0, 1 << word_bits(C), len(address))
    to_field = enable & (address >> TABLE_ADDRESS_BITS == 1)
    index = address & ((1 << C.weight_index_bits) - 1)
    expected = {
        "write_weight": enable & ~to_field,
        "write_exponent": to_field & (index == FIELDS["exponent"]),
        "table_address": address,
        "table_word": word,
        "unsupported": np.zeros(len(address), np.int64),
    }
    for table in ("ambient", "diffuse"):
        channels = [to_field & (index == FIELDS[table] + c) for c in range(3)]
        expected[f"write_{table}"] = sum(hit.astype(int) << c for c, hit in enumerate(channels))
    for name in registers:
        writes = to_field & (index == FIELDS[name])
        latest = np.maximum.accumulate(np.where(writes, np.arange(len(address)), 0))
        port = "two_sided" if name == "control" else name
        before = word[list(registers).index(name)]
        held = np.where(latest > 0, word[latest], before)
        expected[port] = np.append(before, held[:-1])  # one cycle after the strobes
    tb = PrimitivesTB(dut)
    inputs = (address, enable, word)
    await tb.send("register_map", *(v[: len(registers)] for v in inputs))
    await tb.check("register_map", inputs, expected, NOTE)


@cocotb.test()
async def colour_channel(dut):
    """Random, dark and saturated sums of every material, lit and unlit, against exact integers."""
    rng = np.random.default_rng(SEED)
    one = C.coefficient.one
    ambient = np.append(rng.integers(0, one // 2, C.materials - 2), [0, one])
    diffuse = np.append(rng.integers(0, one // 2, C.materials - 2), [one, 0])
    material = np.arange(C.materials)
    to_write = C.coefficient.bits + C.material_bits
    tb = PrimitivesTB(dut)
    for k, column in enumerate((ambient, diffuse)):
        strobe = 1 << (to_write + k)
        await tb.send("colour_channel", 0, 0, strobe | material << C.coefficient.bits | column)

    n = 5 * RANDOM
    material = rng.integers(0, C.materials, n)
    cosine = _corners(rng, C.cosine.bits, n)
    lit = rng.random(n) < 0.8
    fraction = C.weight.fraction + C.power.fraction
    specular = _corners(rng, SPECULAR_BITS, n) >> rng.integers(0, 12, n)
    specular = np.minimum(specular, 1 << fraction)
    base = ambient[material] << (fraction - C.coefficient.fraction)
    rise = diffuse[material] * cosine << (
        fraction - C.coefficient.fraction - C.cosine.fraction
    )  # fmt: skip
    exact = base + np.where(lit, rise + specular, 0)
    # Some of the sums are moved to the middle between two codes, or just below: S is truncated to
    # multiples of `unit` before it is rounded to a code.
    middle = rng.integers(0, 255, n) * 2 + 1
    unit = 1 << (fraction - C.intensity.fraction)
    edge = -(-middle * C.intensity.one // 510) * unit - rng.integers(0, 2, n)
    fits = (edge - base - rise >= 0) & (edge - base - rise <= 1 << fraction)
    near = lit & fits & (rng.random(n) < 0.5)
    specular = np.where(near, edge - base - rise, specular)
    exact = np.where(near, edge, exact)
    s = np.minimum(exact, 1 << fraction) // unit
    code = (s * 510 + C.intensity.one) // (2 * C.intensity.one)
    word = material << (C.cosine.bits + 1) | lit << C.cosine.bits | cosine
    assert near.sum() > n // 20, "too few sums are at the middle between two codes"
    await tb.check("colour_channel", (word, specular), {"colour": code}, NOTE)
    # Without a strobe nothing is written.
    some = slice(0, RANDOM)
    quiet = rng.integers(0, 1 << to_write, RANDOM)
    inputs = word[some], specular[some], quiet
    await tb.check("colour_channel", inputs, {"colour": code[some]}, NOTE)
