"""cocotb tests of the small modules: exhaustive where the input fits, random and corners beyond.

Run by tests/test_modules.py in one simulation, through the bench of sim/primitives.py. A vector
enters every clock and is compared at the clock that the module's LATENCY states.
"""

from __future__ import annotations

import os

import cocotb
import numpy as np

from phong75.model.config import DEFAULT as C
from phong75.model.registers import FIELDS, address_bits, word_bits
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
    return [cocotb.Param(name, name) for name, about in INSTANCES.items() if about.module == module]


def _signed(word, bits: int):
    return word - ((word >> (bits - 1) & 1) << bits)


def _corners(rng, bits: int, n: int = RANDOM) -> np.ndarray:
    """Random words, a third of them within 2 of 0 or of a power of two."""
    near = (1 << rng.integers(0, bits + 1, n)) + rng.integers(-2, 3, n)
    word = np.where(rng.random(n) < 1 / 3, near, rng.integers(0, 1 << bits, n))
    return word & ((1 << bits) - 1)


def _pairs(rng, a_bits: int, b_bits: int):
    """All pairs of words if they are few, else random ones and corners."""
    if a_bits + b_bits <= 18:
        both = np.arange(1 << (a_bits + b_bits))
        return both & ((1 << a_bits) - 1), both >> a_bits
    return _corners(rng, a_bits), _corners(rng, b_bits)


@cocotb.test()
@cocotb.parametrize(name=_of("multiplier"))
async def multiplier(dut, name):
    """All pairs of small words, corners of large ones, in all combinations of signs."""
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
    """All short words, corners of long ones."""
    p = INSTANCES[name].parameters
    bits = p["BITS"]
    short = np.arange(1 << bits)
    a = short if bits < 10 else _corners(np.random.default_rng(SEED), bits, 2000)
    x = _signed(a, bits) if p["IS_SIGNED"] else a
    await PrimitivesTB(dut).check(name, (a,), {"product": x * p["CONSTANT"]}, NOTE)


@cocotb.test()
@cocotb.parametrize(name=_of("leading_zeros"))
async def leading_zeros(dut, name):
    """Every place of the highest one with random bits below, no one at all, all short words."""
    bits = INSTANCES[name].parameters["BITS"]
    rng = np.random.default_rng(SEED)
    place = np.repeat(np.arange(bits), 200)
    word = (1 << place) | rng.integers(0, 1 << bits, len(place)) & ((1 << place) - 1)
    word = np.concatenate([word, 1 << np.arange(bits), [0, 0]])
    word = np.arange(1 << bits) if bits <= 12 else rng.permutation(word)
    count = [bits - int(w).bit_length() for w in word]
    await PrimitivesTB(dut).check(name, (word,), {"count": count}, NOTE)


@cocotb.test()
@cocotb.parametrize(name=_of("left_shifter"))
async def left_shifter(dut, name):
    """Every count; every word too if they are short."""
    p = INSTANCES[name].parameters
    word, count = _pairs(np.random.default_rng(SEED), p["BITS"], p["COUNT_BITS"])
    await PrimitivesTB(dut).check(name, (word, count), {"shifted": word << count}, NOTE)


@cocotb.test()
@cocotb.parametrize(name=_of("round_saturate"))
async def round_saturate(dut, name):
    """Every word if they are short, for several widths, signed and unsigned."""
    p = INSTANCES[name].parameters
    bits, signed = p["IN_BITS"], p["IS_SIGNED"]
    word = np.arange(1 << bits) if name in ROUNDERS else _round_words(p)
    value = _signed(word, bits) if signed else word
    half_up = (value + (1 << (p["DROP"] - 1))) >> p["DROP"]
    low = -(1 << (p["OUT_BITS"] - 1)) if signed else 0
    clamped = np.clip(half_up, low, low + (1 << p["OUT_BITS"]) - 1)
    await PrimitivesTB(dut).check(name, (word,), {"out": clamped}, NOTE)


def _round_words(p):
    rng = np.random.default_rng(SEED)
    word = _corners(rng, p["IN_BITS"])
    small = _corners(rng, p["DROP"] + p["OUT_BITS"])
    both = np.where(rng.random(RANDOM) < 0.5, word, small)
    return both & ((1 << p["IN_BITS"]) - 1)


@cocotb.test()
@cocotb.parametrize(name=_of("delay"))
async def delay(dut, name):
    """A random word comes out CYCLES clocks later."""
    word = np.random.default_rng(SEED).integers(0, 1 << 13, 500)
    await PrimitivesTB(dut).check(name, (word,), {"out": word}, NOTE)


@cocotb.test()
@cocotb.parametrize(name=_of("rom"))
async def rom(dut, name):
    """Every word, in order and not; a ROM without contents holds zeros."""
    words = np.zeros(512, np.int64) if name in DEFAULTS else np.array(ROM_WORDS)
    rng = np.random.default_rng(SEED)
    address = np.concatenate([np.arange(len(words)), rng.integers(0, len(words), 500)])
    await PrimitivesTB(dut).check(name, (address,), {"word": words[address]}, NOTE)


@cocotb.test()
@cocotb.parametrize(name=_of("ram") + _of("small_ram"))
async def memory(dut, name):
    """Random writes and reads at once; a read of the word being written gives the old one."""
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
    """Random values, loaded or summed; overflow stays once a sum left the word, until a load."""
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
async def normal_hold(dut):
    """The last normal that may be lit stays, through others and through clocks without a pixel."""
    rng = np.random.default_rng(SEED)
    x, y, z = (_corners(rng, C.normal.bits) for _ in range(3))
    two_sided, valid = rng.random(RANDOM) < 0.3, rng.random(RANDOM) < 0.5
    shown = two_sided | (z >> (C.normal.bits - 1) == 0)
    taken = valid & shown
    taken[0] = valid[0] = two_sided[0] = shown[0] = True
    last = np.maximum.accumulate(np.where(taken, np.arange(RANDOM), 0))
    expected = {"held_valid": valid, "shown": shown}
    expected |= {"held_x": x[last], "held_y": y[last], "held_z": z[last]}
    inputs = x, y, z << 2 | valid << 1 | two_sided
    await PrimitivesTB(dut).check("hold", inputs, expected, NOTE)


@cocotb.test()
async def register_map(dut):
    """Every address, written or not, gives its register or its strobe and nothing else."""
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
        expected[port] = np.append(before, held[:-1])  # a clock after the strobes
    tb = PrimitivesTB(dut)
    inputs = (address, enable, word)
    await tb.send("register_map", *(v[: len(registers)] for v in inputs))
    await tb.check("register_map", inputs, expected, NOTE)


@cocotb.test()
async def colour_channel(dut):
    """Random, dark and saturated sums of every material, lit and not, against exact integers."""
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

    n = 10 * RANDOM
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
    # A fifth of the sums at a half between two codes, or one unit of the cut below it.
    place = rng.integers(0, 255, n) * 2 + 1
    cut = 1 << (fraction - C.intensity.fraction)
    edge = -(-place * C.intensity.one // 510) * cut - rng.integers(0, 2, n)
    fits = (edge - base - rise >= 0) & (edge - base - rise <= 1 << fraction)
    near = lit & fits & (rng.random(n) < 0.5)
    specular = np.where(near, edge - base - rise, specular)
    exact = np.where(near, edge, exact)
    s = np.minimum(exact, 1 << fraction) // cut
    code = (s * 510 + C.intensity.one) // (2 * C.intensity.one)
    word = material << (C.cosine.bits + 1) | lit << C.cosine.bits | cosine
    assert near.sum() > n // 20, "the edges between codes are hardly tried"
    await tb.check("colour_channel", (word, specular), {"colour": code}, NOTE)
    # A strobe off writes nothing.
    quiet = rng.integers(0, 1 << to_write, n)
    await tb.check("colour_channel", (word, specular, quiet), {"colour": code}, NOTE)
