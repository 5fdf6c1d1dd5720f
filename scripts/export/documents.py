# SPDX-License-Identifier: MIT
"""What an export says of itself: ports.md, from the configuration, and README.md."""

from __future__ import annotations

from dataclasses import dataclass

from phong75.model.config import MAX_EXPONENT, Config
from phong75.model.registers import FIELDS, address_bits, word_bits
from phong75.model.spans import SpanField, span_fields
from phong75.model.twin.core.register_map import vanishing_exponent
from phong75.scripts.export.stimulus import Stimulus, first_pixel_latency, pixel_bits, span_bits

_COLOURS = ("red", "green", "blue")


@dataclass(frozen=True)
class Port:
    """A port of the top level; `format` says what its word holds, in Q-formats where there is
    one."""

    name: str
    direction: str
    bits: int
    format: str
    meaning: str


def ports(config: Config) -> list[Port]:
    """The ports of phong_pipeline, in the order of its declaration."""
    spans, pixels = f"see [spans](#{_SPANS})", f"see [pixels](#{_PIXELS})"
    port_map = f"see [write port](#{_WRITE_PORT})"
    address = "{light, kind, material, index}" if config.light_bits else "{kind, material, index}"
    return [
        Port("clk", "input", 1, "", "clock; every register is set at its rising edge"),
        Port("reset", "input", 1, "",
             "synchronous; one cycle drops every span and pixel in flight and keeps registers, "
             "material table and lookup tables"),
        Port("write_enable", "input", 1, "", "1: `write_word` goes to `write_address`"),
        Port("write_address", "input", address_bits(config), address, port_map),
        Port("write_word", "input", word_bits(config), "depends on the address", port_map),
        Port("s_axis_tvalid", "input", 1, "", "a span is offered"),
        Port("s_axis_tready", "output", 1, "", "the span is taken if `s_axis_tvalid` is 1, too"),
        Port("s_axis_tdata", "input", span_bits(config), spans, "the span"),
        Port("s_axis_tlast", "input", 1, "", "it is the last span of the frame"),
        Port("m_axis_tvalid", "output", 1, "", "a pixel is offered; it stays until it is taken"),
        Port("m_axis_tready", "input", 1, "", "the pixel is taken if `m_axis_tvalid` is 1, too"),
        Port("m_axis_tdata", "output", pixel_bits(config), pixels, "the pixel"),
        Port("m_axis_tlast", "output", 1, "", "it is the last pixel of the frame"),
        Port("illegal_span", "output", 1, "",
             "1 for one cycle: a span is empty, leaves the picture's largest width, or one of its "
             "values leaves its format"),
        Port("zero_normal", "output", 1, "",
             "1 for one cycle: the normal of a pixel is the zero vector"),
        Port("unsupported", "output", 1, "",
             "1 for one cycle: a register write or a span needs what this configuration leaves "
             "out"),
    ]  # fmt: skip


_SPANS, _PIXELS, _WRITE_PORT = "spans", "pixels", "write-port"


def _table(head: tuple[str, ...], rows: list[tuple]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def _bits(lsb: int, bits: int) -> str:
    return f"[{lsb + bits - 1}:{lsb}]" if bits > 1 else f"[{lsb}]"


def _span_meaning(field: SpanField, config: Config) -> tuple[str, str, str]:
    """(name, format, meaning) of a field of a span."""
    whole = {
        "x": "column of the first pixel, 0 at the left",
        "y": "row, 0 at the top",
        "length": "pixels, 1 or more",
        "material": "index into the material table" if config.technique == "phong"
        else "not used by this technique",
    }  # fmt: skip
    if field.name in whole:
        return field.name, f"u{field.bits}.0", whole[field.name]
    name, of_light = field.name, ""
    if config.sums_lights:
        unit = 0
        if name[-1].isdigit():
            name, _, number = name.rpartition("_")
            unit = int(number)
        of_light = " of the light" if config.lights == 1 else f" of light {unit}"
        if config.turns > 1:
            of_light = f"{of_light} of the turn" if config.units > 1 else " of the turn's light"
    what, _, axis = name.partition("_")
    if axis == "depth":
        meaning = {
            "start": f"distance{of_light} at the centre of the first pixel",
            "step": f"change of the distance{of_light} from one pixel to the next",
        }[what]
        return field.name, str(config.depth), f"{meaning}; its table of factors spans 0 to 1"
    if what == "half":
        return field.name, str(config.half_vector), f"half vector{of_light}, {axis}"
    if config.technique != "phong":
        colour = _COLOURS["xyz".index(axis)] if config.channels == 3 else "grey"
        where = (
            "of the whole span" if config.technique == "flat"
            else "at the centre of the first pixel" if what == "start"
            else "from one pixel to the next"
        )  # fmt: skip
        kind = "change of the intensity" if what == "step" else "intensity, 0 to 1,"
        return f"{what}_{colour}", str(config.normal), f"{kind} {where}"
    if what in ("square", "cross"):
        name = "\\|N\\|²" if what == "square" else "\\|N × h\\|²"
        order = ("value", "first difference", "second difference")[int(axis)]
        return field.name, str(config.squared), f"{name} over the pixels of the span: {order}"
    in_frame = of_light and f" in the frame{of_light}"
    if what == "bend":
        return field.name, str(config.bend), f"change of step_{axis} from one pixel to the next"
    meaning = {
        "start": f"normal's {axis} at the centre of the first pixel{in_frame}",
        "step": f"change of the normal's {axis}{in_frame} from "
        + (
            "one pixel to the next" if config.normal_order == 1 else "the first pixel to the second"
        ),
    }
    return field.name, str(config.normal), meaning[what]


def _span_rows(config: Config) -> list[tuple]:
    return [
        (f"`{name}`", _bits(field.lsb, field.bits), form, meaning)
        for field in span_fields(config)[:-1]
        for name, form, meaning in [_span_meaning(field, config)]
    ]


def _pixel_rows(config: Config) -> list[tuple]:
    colour, place = config.colour_bits, config.coordinate_bits
    top = (1 << colour) - 1
    rows = [
        (f"`{name}`", _bits(k * colour, colour), f"u{colour}.0", f"0 to {top}")
        for k, name in enumerate(reversed(_COLOURS))
    ]
    rows += [
        (f"`{axis}`", _bits(3 * colour + k * place, place), f"u{place}.0", meaning)
        for k, (axis, meaning) in enumerate((("x", "column"), ("y", "row")))
    ]
    return rows


def _write_rows(config: Config) -> list[tuple]:
    """(address, word, meaning, in this configuration) of every kind of write."""
    code, fraction = config.coefficient, config.coefficient.fraction
    step = f"s1.{fraction}"
    half, n = config.half_vector, config.exponent
    left_out = "left out: only 0 is accepted"

    def fixed(codes) -> str:
        return "fixed: only the code " + ", ".join(map(str, codes)) + " is accepted"

    weight = "every interval"
    if not config.specular:
        weight = left_out
    elif config.constant_weight:
        weight = fixed(config.constant_weight)
    elif not config.weight_function:
        weight = "one weight per material: write interval 0 only, with a step of 0"
    light = "light, " if config.light_bits else ""
    any_light = "any, " if light else ""
    rows = [
        (f"{{{any_light}0, material, k}}", f"{{step {step}, left {code}}}",
         f"interval k of {config.weight_points - 1} of W(i), equally spaced in cos(i): W at its "
         "left end, and the change to its right end", weight),
    ]  # fmt: skip
    terms = ("Cp d", "Cp (1 - d)")
    if config.sums_lights:
        terms = ("e + ka Ia and ka La of all lights", "kd Ld of the light")
    for name, term, there, constant in (
        ("ambient", terms[0], config.ambient, config.constant_ambient),
        ("diffuse", terms[1], config.diffuse, config.constant_diffuse),
    ):
        for c, colour in enumerate(_COLOURS):
            state = "writable"
            if c and config.channels == 1:
                state = "left out: the material's red serves for all"
            elif not there:
                state = left_out
            elif constant:
                state = fixed([constant[c]])
            place = light if name == "diffuse" else any_light
            address = f"{{{place}1, material, {FIELDS[name] + c}}}"
            rows.append((address, str(code), f"{term}, {colour}", state))
    power = "writable"
    if not config.specular:
        power = "left out: no effect"
    elif config.constant_exponent:
        power = fixed(config.constant_exponent)
    elif not config.power_function:
        power = fixed([n.one])
    else:
        least = n.real(vanishing_exponent(config))
        limits = ([] if config.power_bypass else ["n = 1 is not accepted"]) + (
            [] if config.log_octaves else [f"other n from {least:g} on"]
        )
        power = "; ".join([power, *limits])
    if config.has_curves:
        power = "not used: lines of the curve take its place"
    place = f"{{{any_light}1, material, {FIELDS['exponent']}}}"
    rows.append((place, str(n), f"n, 1 to {MAX_EXPONENT}", power))
    for k, axis in enumerate("xz"):
        state = "writable" if config.specular else "left out: no effect"
        if config.constant_half_vector:
            state = fixed([config.constant_half_vector[k]])
        if config.span_half_vector:
            state = "left out: spans bring their half vectors"
        rows.append((f"{{{light}1, any, {FIELDS[f'half_{axis}']}}}", str(half),
                     f"half vector h between light and eye, {axis}", state))  # fmt: skip
    state = "writable" if config.two_sided else left_out
    rows.append((f"{{{any_light}1, any, {FIELDS['control']}}}", "bit 0",
                 "1: two-sided, shade with \\|Zn\\|", state))  # fmt: skip
    if config.light_bits:
        rows.append((f"{{any, 1, any, {FIELDS['control']}}}", "bits 3 to 1",
                     "lights of the frame minus 1", "writable"))  # fmt: skip
    if config.highlight_colour:
        rows += [
            (f"{{{light}1, material, {FIELDS['highlight'] + c}}}", str(code),
             f"ks Ls of the light, {colour}",
             "left out: the material's red serves for all" if c and config.channels == 1
             else "writable" if config.specular else "left out: no effect")
            for c, colour in enumerate(_COLOURS)
        ]  # fmt: skip
    if config.attenuation:
        rows.append((f"{{{light}1, k div 16, {FIELDS['attenuation']} + k mod 16}}",
                     f"{{step {step}, left {code}}}",
                     f"interval k of {config.weight_points - 1} of the light's factor, equally "
                     "spaced in the distance from 0 to 1", "every interval"))  # fmt: skip
    return [(f"`{address}`", *rest) for address, *rest in rows]


def ports_page(config: Config, top: str) -> str:
    """The text of ports.md for the top level `top`. Raises BuildError."""
    port_rows = [(f"`{p.name}`", p.direction, p.bits, p.format, p.meaning) for p in ports(config)]
    out = [
        f"# Ports of `{top}`, configuration `{config.name}`",
        "A format `s1.30` is two's complement with 1 integer bit and 30 fraction bits, the sign "
        "bit extra; `u` is unsigned. The value of a word is code / 2^fraction.",
        _table(("port", "direction", "bits", "format", "meaning"), port_rows),
        "Both streams follow the AXI4-Stream handshake: a word moves at a rising edge of `clk` at "
        "which `tvalid` and `tready` are 1. Once offered, a word must stay until it moves.",
        *_pace(config),
        f"## Spans\n\n`s_axis_tdata`, {span_bits(config)} bits:",
        _table(("field", "bits", "format", "meaning"), _span_rows(config)),
    ]
    if config.sums_lights:
        out.append(
            "Each light has a frame of its own: z points to the light, and the eye lies in the "
            "plane of x and z. A span brings one and the same normal in the frame of every light; "
            "it need not have length 1. x, y, length and material are read from the first record "
            "of a span, `s_axis_tlast` from the last one. Where the last record has a place for a "
            "light that the frame does not have, start and step are 0 there. A span is legal if "
            f"its length is 1 or more, x + length is at most {config.max_size}, and its values "
            "stay in their format from its first pixel to its last."
        )
    elif config.technique == "phong":
        out.append(
            "Normals are in the light frame: z points to the light, and the eye lies in the plane "
            "of x and z. They need not have length 1. A span is legal if its length is 1 or more, "
            f"x + length is at most {config.max_size}, and its values stay in their format from "
            "its first pixel to its last."
        )
    out += [
        f"## Pixels\n\n`m_axis_tdata`, {pixel_bits(config)} bits:",
        _table(("field", "bits", "format", "meaning"), _pixel_rows(config)),
        "## Write port",
    ]
    if config.technique == "phong":
        material, index = config.material_bits, config.weight_index_bits
        number = f"light ({config.light_bits} bits), " if config.light_bits else ""
        out += [
            f"`write_address` is {{{number}kind (1 bit), material ({material} bits), index "
            f"({index} bits)}}. Write only while no pixel is in flight: a write changes the "
            "pixels that are. The last write must be 4 cycles old when the first span of the "
            "frame is taken.",
            *_reflectance_writes(config),
            _table(("address", "word", "meaning", "in this configuration"), _write_rows(config)),
            _rule(config),
            "h = (sin(a/2), 0, cos(a/2)) for an eye at the angle a from the light.",
        ]
    else:
        out.append(
            "Not used: intensities come with the spans. Hold `write_enable` at 0; a write is "
            "answered with `unsupported`."
        )
    return "\n\n".join(out) + "\n"


def _pace(config: Config) -> list[str]:
    """Latency and rate. Raises BuildError."""
    first = first_pixel_latency(config)
    if config.sums_lights and config.lights > 1:
        units = f"{config.units} at a time" if config.units > 1 else "one at a time"
        return [
            f"This build has up to {config.lights} lights, {units}. A frame of L lights takes "
            f"T = ceil(L / {config.units}) turns: a span is offered as T records, one word of "
            "`s_axis_tdata` for each turn.",
            f"Latency: {first} + T - 1 cycles from the edge that takes the first record of a span "
            "to the first edge at which its first pixel is offered. Rate: one pixel in T cycles "
            "for as long as records are offered and pixels are taken, also if every span is one "
            "pixel long. Back-pressure loses nothing.",
        ]
    return [
        f"Latency: {first} cycles from the edge that takes a span to the first edge at which its "
        "first pixel is offered. Rate: one pixel per cycle for as long as spans are offered and "
        "pixels are taken, also if every span is one pixel long. Back-pressure loses nothing.",
    ]


def _rule(config: Config) -> str:
    """What a pixel's intensity is, and the words of its terms."""
    power = "F(cos(s))" if config.has_curves else "cos(s)^n"
    curve = ", F the material's curve" if config.has_curves else ""
    if not config.sums_lights:
        exponent = "" if config.has_curves else ", n the exponent of the highlight"
        return (
            "W(i) is the weight of the highlight, Cp the colour of the surface, d its ambient "
            f"share{exponent}{curve}, all of eq. (3) of Phong 1975: "
            f"S = Cp [cos(i) (1 - d) + d] + W(i) {power}."
        )
    highlight = "ks Ls W(i)" if config.highlight_colour else "W(i)"
    factor = "f(r) " if config.attenuation else ""
    fall = ", f(r) its factor at the distance r" if config.attenuation else ""
    return (
        f"A channel is e + ka Ia + ka La of all lights, plus {factor}[kd Ld cos(i) + {highlight} "
        f"{power}] of each light that the surface faces. kd and ks are the material's diffuse and "
        f"specular coefficients, Ld and Ls the light's colours{fall}{curve}. Products of a light "
        "and a material are written as one word."
    )


def _reflectance_writes(config: Config) -> list[str]:
    """What the write port holds for curves of cos(s), and for jumps."""
    out = []
    if config.has_curves:
        out.append(
            "The address has one bit more at its top. If it is 1, the address is {1, zeros, "
            f"material ({config.material_bits} bits), line ({config.segment_bits} bits)}} and the "
            "word {step (s1.16), left (u1.16)}: a line of the material's curve of 1 - cos(s). A "
            "line's number is {1 - cos(s) >= 1/2, octave, place in the octave}. n is not written."
        )
    for name, what, operand, count in (
        ("weight_jump", "W(i)", f"cos(i) ({config.cosine})", config.weight_jumps),
        ("curve_jump", "the curve", f"1 - cos(s) ({config.versine})", config.curve_jumps),
    ):
        if count:
            first = FIELDS[name]
            out.append(
                f"Jump k of {what}, k from 0 to {count - 1}: `{{1, material, {first} + 2k}}` is "
                f"{{above, threshold of {operand}}}, `{{1, material, {first + 1} + 2k}}` the "
                "amount (u1.16), which is subtracted at and above the threshold if `above` is 1, "
                "else below it."
            )
    return out


def _instance(config: Config, top: str) -> str:
    """A template of an instance of `top`."""
    lines = []
    for port in ports(config):
        width = f"[{port.bits - 1}:0] " if port.bits > 1 else ""
        lines.append((f"    .{port.name}({port.name})", f"{port.direction} {width}".rstrip()))
    wide = max(len(text) for text, _ in lines) + 1
    body = [
        f"{text + ('' if k == len(lines) - 1 else ','):<{wide}}  // {note}"
        for k, (text, note) in enumerate(lines)
    ]
    return "\n".join([f"{top} u_phong_pipeline (", *body, ");"])


def readme(
    config: Config, prefix: str, version: str, stimulus: Stimulus, scene: str, pruned: bool,
    ecp5: bool,
) -> str:  # fmt: skip
    """The text of README.md. Raises BuildError."""
    top, bench = f"{prefix}phong_pipeline", f"{prefix}testbench"
    numbers = stimulus.numbers
    what = {
        "phong": "Phong shading: a normal is interpolated along each span, normalized at each "
        "pixel and shaded",
        "gouraud": "Gouraud shading: an intensity is interpolated along each span",
        "flat": "flat shading: one intensity for each span",
    }[config.technique]
    rate = "one pixel per cycle"
    if config.turns > 1:
        rate = f"one pixel in {config.turns} cycles with {config.lights} lights"
    out = [
        f"# {top}",
        f"Synthesizable Verilog-2005, exported from Phong75 {version}, configuration "
        f"`{config.name}`. {what}. Spans go in, pixels come out, {rate}.",
    ]
    if pruned:
        out.append(
            f"This configuration is pruned to {scene}: what that picture does not need is left "
            "out, and some of its values are constants of the hardware. Another picture may need "
            "more; the output `unsupported` says so. ports.md lists what is left out."
        )
    ecp5_row = [
        ("`rtl_ecp5.f`", "the same for a Lattice ECP5: multipliers and memories of `rtl/ecp5/` "
         "use the chip's own blocks with their registers"),
    ] if ecp5 else []  # fmt: skip
    out += [
        _table(
            ("file", "contents"),
            [
                ("`rtl.f`", f"file list of the design; the top level is `{top}`"),
                *ecp5_row,
                (
                    "`rtl/`",
                    "the design: one module a file, no macro, no include, no parameter to "
                    "set; tables are inside",
                ),
                ("`ports.md`", "ports, formats, handshake, latency, write port"),
                ("`testbench.f`", f"file list of the design and its testbench `{bench}`"),
                (
                    "`sim/`",
                    f"testbench, and its stimulus from {scene}: {numbers['WRITES']} register "
                    f"writes, {numbers['RECORDS']} words of spans, {numbers['PIXELS']} expected "
                    "pixels",
                ),
                ("`export.json`", "version, configuration and files of this export"),
            ],
        ),
        "## Simulate\n\nIn this folder, with Icarus Verilog 11 or later:",
        f"```sh\niverilog -g2005 -s {bench} -o testbench.vvp -c testbench.f\n"
        "vvp -N testbench.vvp\n```",
        "or with Verilator 5 (GCC needs the option `-fcoroutines`; releases before 5.040 may need "
        "`-Wno-fatal`, too):",
        f"```sh\nverilator --binary -CFLAGS -fcoroutines --top-module {bench} -f testbench.f\n"
        f"obj_dir/V{bench}\n```",
        f"The testbench prints `PASS {3 * numbers['PIXELS']} pixels`: the frame runs three times, "
        "first without pauses, then with random ones. Or it prints `FAIL` with the first "
        "difference, and the exit code is not 0. No pixel may differ in any bit: the expected "
        "pixels are those of Phong75's bit-accurate model.",
        "## Integrate\n\nGive your tools the files of `rtl.f` (or `rtl_ecp5.f`). All module names "
        f"begin with `{prefix}`, so exports with different prefixes stand side by side in one "
        "design. No file needs another folder in the include path."
        if prefix
        else "## Integrate\n\nGive your tools the files of `rtl.f` (or `rtl_ecp5.f`). No file "
        "needs another folder in the include path. This export has no prefix: modules are called "
        "`delay`, `rom` and the like. Export with a prefix where these names are taken.",
        f"```verilog\n{_instance(config, top)}\n```",
        "After power-up hold `reset` at 1 and `write_enable` at 0 for 8 cycles. "
        + (
            "To set up a frame, write registers and materials (ports.md), then stream its spans."
            if config.technique == "phong"
            else "Then stream spans; `write_enable` stays at 0."
        ),
        "Generate blocks of what this configuration leaves out still name modules that are not in "
        "this folder; they are not elaborated. In comments, a stage number such as `_p13` counts "
        "cycles of the default configuration, and a format with `(default)` is that of the default "
        "configuration.",
        "The licence is MIT (`LICENSE`).",
    ]
    return "\n\n".join(out) + "\n"
