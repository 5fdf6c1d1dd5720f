# SPDX-License-Identifier: MIT
"""The proofs: claims about modules, their sizes, and the broken designs that must fail them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class BrokenDesign:
    """A broken design: in `module`, the text `old`, which occurs once, is replaced by `new`.

    breaks: the property that must fail. depth: number of cycles from reset within which the
    property must fail. skip: number of first cycles that are not checked.
    """

    module: str
    old: str
    new: str
    breaks: str
    depth: int = 12
    skip: int = 0


@dataclass(frozen=True)
class Proof:
    """A claim about the module `top`.

    The properties are in sim/formal/<top>.vh. If sim/formal/<top>.v exists, it is the top level and
    compares several modules.
    mode: "prove" (k-induction, unbounded), "bmc" (bounded: the first `depth` cycles), "cover"
    (the state is reachable) or "structure" (a Yosys `script` on the flattened netlist, which fails
    if the claim is wrong).
    size: of the proven design, for the table.
    parameters: of `top`.
    latency: value of PHONG_PIXEL_LATENCY, in cycles; 0 for the real one.
    fast: whether the tests run the proof; `make formal` runs all proofs.
    """

    name: str
    claim: str
    top: str
    mode: str
    depth: int = 1
    size: str = ""
    parameters: Mapping[str, int] = field(default_factory=dict)
    latency: int = 0
    script: str = ""
    fast: bool = True
    broken_designs: tuple[BrokenDesign, ...] = ()


#: Narrow data words: the FIFO only stores data, so that their width does not matter.
_NARROW = {"COORDINATE_BITS": 1, "COLOUR_BITS": 1}
_FIFO = "no pixel lost, repeated, reordered; stable while stalled; no overflow; constant latency"
_FIFO_BROKEN = (
    BrokenDesign(
        "pixel_fifo",
        "if (pop) read_slot <=",
        "if (pop & ~pixel_valid) read_slot <=",
        "a_colour",
        16,
    ),
    BrokenDesign(
        "pixel_fifo",
        "if (pixel_valid) place_slot <=",
        "if (pixel_valid & ~pop) place_slot <=",
        "a_order_and_place",
        22,
    ),
    BrokenDesign("pixel_fifo", "if (reset) in_flight <=", "if (1'b0) in_flight <=", "a_not_early"),
    BrokenDesign("pixel_fifo", "ALL = SLOTS;", "ALL = SLOTS + 1;", "a_no_overflow", 22, 20),
    BrokenDesign(
        "pixel_fifo",
        "out_valid <= pop | (out_valid & ~out_ready);",
        "out_valid <= pop;",
        "a_stable_valid",
        16,
    ),
    BrokenDesign("pixel_fifo", "(~out_valid | out_ready)", "1'b1", "a_stable_data", 16),
    BrokenDesign(
        "pixel_fifo",
        "colour_valid = in_flight[LATENCY-1]",
        "colour_valid = in_flight[LATENCY-2]",
        "a_not_early",
        16,
    ),
    BrokenDesign("pixel_fifo", "credits <= ALL;", "credits <= LATENCY;", "a_full_rate", 16),
)
_READY = "span_ready = credit & ~walking;"
_WALKER_BROKEN = (
    BrokenDesign("span_walker", "pixel_valid = busy & credit;", "pixel_valid = busy;", "a_credit"),
    BrokenDesign("span_walker", _READY, "span_ready = ~walking;", "a_ready"),
    BrokenDesign(
        "span_walker", "next_ends <= remaining == 2;", "next_ends <= remaining == 3;", "a_load"
    ),
    BrokenDesign("span_walker", "<= {beyond, pixel_x} + 1'b1;", "<= {beyond, pixel_x};", "a_place"),
    BrokenDesign(
        "span_walker", "illegal <= (beyond != 0) | overflow;", "illegal <= overflow;", "a_illegal"
    ),
    BrokenDesign("span_walker", "busy <= 1'b0;", "busy <= 1'b1;", "a_no_bubble"),
)
_INTERPOLATOR_BROKEN = (
    BrokenDesign(
        "linear_interpolator",
        "overflow_held <= ~load & overflow;",
        "overflow_held <= 1'b0;",
        "a_flagged",
    ),
    BrokenDesign(
        "linear_interpolator",
        "(sign_before == step_held[SIGN]) &",
        "(sign_before & step_held[SIGN]) &",
        "a_no_wrap",
    ),
)
_PIPELINE = "spans in, their pixels out, in order, after a constant time, at full rate; flags"
_PIPELINE_BROKEN = (
    BrokenDesign(
        "phong_unit",
        "overflow = overflow_x | overflow_y | overflow_z;",
        "overflow = overflow_x | overflow_y;",
        "a_illegal",
    ),
    BrokenDesign("normalizer", "& ~sign_p3 &", "&", "a_zero"),
    BrokenDesign("phong_pipeline", ".out_ready(m_axis_tready),", ".out_ready(1'b1),", "a_stable"),
    BrokenDesign("phong_pipeline", ".span_y(span_y),", ".span_y(span_x),", "a_order_and_place"),
)

#: Removes all clocked cells; a path between two ports is then combinational logic.
_CUT = "delete t:$dff t:$sdff t:$dffe t:$sdffe t:$sdffce t:$mem_v2 t:$memrd_v2"


def _no_path(source: str, target: str) -> str:
    """Yosys commands that fail if there is combinational logic from `source` to `target`."""
    return (
        f"{_CUT}; select -assert-any i:{source}; select -assert-any o:{target}; "
        f"select -set cone o:{target} %ci*; select -assert-none @cone i:{source} %i"
    )


PROOFS = (
    Proof(
        "walker",
        "a span is exactly its pixels; no bubble; spans out of the counter are flagged",
        "span_walker",
        "prove",
        1,
        "12-bit coordinates, any length",
        broken_designs=_WALKER_BROKEN,
    ),
    Proof(
        "interpolator",
        "no wrap in a legal span; overflow iff start + k step leaves the word",
        "linear_interpolator",
        "prove",
        1,
        "32 bits, k < 2^13",
        broken_designs=_INTERPOLATOR_BROKEN,
    ),
    Proof(
        "fifo",
        _FIFO,
        "pixel_fifo",
        "prove",
        1,
        "latency 6, 16 slots",
        _NARROW | {"LATENCY": 6},
        broken_designs=_FIFO_BROKEN,
    ),
    Proof(
        "fifo, real",
        _FIFO,
        "pixel_fifo",
        "prove",
        1,
        "real latency and slots",
        _NARROW,
        fast=False,
    ),
    Proof(
        "ready",
        "span_ready does not depend on span_valid",
        "phong_pipeline",
        "structure",
        size="the whole pipeline",
        script=_no_path("s_axis_tvalid", "s_axis_tready"),
        broken_designs=(
            BrokenDesign(
                "span_walker", _READY, f"span_ready = span_valid & {_READY[13:]}", "no_path"
            ),
        ),
    ),
    Proof(
        "stall",
        "no logic from the output's ready to the input's ready",
        "phong_pipeline",
        "structure",
        size="the whole pipeline",
        script=_no_path("m_axis_tready", "s_axis_tready"),
        broken_designs=(
            BrokenDesign(
                "phong_pipeline",
                ".credit(walker_credit),",
                ".credit(walker_credit & m_axis_tready),",
                "no_path",
            ),
        ),
    ),
    Proof(
        "wiring",
        _PIPELINE,
        "phong_pipeline",
        "bmc",
        10,
        "latency 3, 10 clocks from reset",
        latency=3,
        fast=False,
        broken_designs=_PIPELINE_BROKEN,
    ),
    Proof(
        "back to back",
        "spans of one pixel follow each other and leave with no clock between",
        "phong_pipeline",
        "cover",
        14,
        "latency 4",
        latency=4,
        broken_designs=(
            BrokenDesign(
                "span_walker",
                "busy <= span_valid | walking;",
                "busy <= span_valid & ~busy | walking;",
                "c_back_to_back",
            ),
        ),
    ),
    Proof(
        "back to back, real",
        "the same, with the real latency",
        "phong_pipeline",
        "cover",
        90,
        "real latency",
        fast=False,
    ),
    Proof(
        "constant product",
        "constant_multiplier = word times constant, signed and unsigned",
        "equal_constant_product",
        "bmc",
        5,
        "12 bits, constant 3277 (7 digits)",
        {"BITS": 12, "CONSTANT_BITS": 12, "CONSTANT": 3277},
        broken_designs=(
            BrokenDesign(
                "constant_multiplier",
                "if (MINUS[place(FIRST)] == MINUS[place(SECOND)])",
                "if (MINUS[place(FIRST)] != MINUS[place(SECOND)])",
                "a_unsigned",
                5,
            ),
        ),
    ),
    Proof(
        "pruned fifo",
        "one channel and narrow places = the full FIFO, given such pixels",
        "equal_pixel_fifo",
        "bmc",
        14,
        "latency 3, 14 clocks from reset",
        broken_designs=(
            BrokenDesign(
                "pixel_fifo", "{{IDLE_X_BITS{1'b0}},", "{{IDLE_X_BITS{1'b1}},", "a_pixel", 14
            ),
        ),
    ),
    Proof(
        "pruned registers",
        "constant registers = written ones, or a word is flagged",
        "equal_register_map",
        "prove",
        6,
        "real widths, any writes",
        broken_designs=(
            BrokenDesign("register_map", "other_z <= half != half_z;", "other_z <= 1'b0;", "a_z"),
        ),
    ),
    Proof(
        "pruned channel",
        "no specular term = a specular term of 0, a clock later",
        "equal_colour_channel",
        "bmc",
        18,
        "words of 4 to 9 bits, 18 clocks",
        broken_designs=(
            BrokenDesign(
                "colour_channel",
                "sum <= ambient_term + diffuse_term;",
                "sum <= ambient_term | diffuse_term;",
                "a_colour",
                18,
            ),
        ),
    ),
)
