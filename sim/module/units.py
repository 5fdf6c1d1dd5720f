# SPDX-License-Identifier: MIT
"""Generated benches of single datapath modules: vectors from a file, signals of every stage to one.

A `Module` describes the bench of one module. Input words and observed signals ("lanes") have 64
bits in the files whatever their width in the design, so that no width is written here. Every signal
of every stage is recorded in every cycle. The RTL states the latency of each signal, in cycles. So
a mismatch names the first stage that differs, and a wrong latency is a mismatch.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from phong75.model.config import DEFAULT
from phong75.sim.module.vector_bench import bench_text, known, write

#: Cycles that a bench runs after the last vector: more than the latency of any module.
TAIL = 256


@dataclass(frozen=True)
class Stage:
    """The observed signals of one stage of the twin.

    name: of the stage. signals: paths below the module; a leading "+" marks two's complement.
    latency: cycles from the module's input to the signals, a Verilog expression.
    """

    name: str
    signals: tuple[str, ...]
    latency: str


@dataclass(frozen=True)
class Child:
    """An instance inside a module whose stages are observed as well.

    instance: path below the module. module: key of MODULES. latency: cycles from the module's input
    to the instance's input, a Verilog expression.
    """

    instance: str
    module: str
    latency: str


@dataclass(frozen=True)
class Module:
    """Description of the bench of one module.

    inputs: input ports that the vectors drive, in this order.
    stages: observed stages, in data order.
    held: (port, width) of input ports that cocotb holds; width is a number or Verilog expression.
    children: instances whose stages are observed before those of the module.
    late: {input port: Verilog expression}: cycles by which the port's data must arrive later.
    """

    inputs: tuple[str, ...]
    stages: tuple[Stage, ...]
    held: tuple[tuple[str, int | str], ...] = ()
    children: tuple[Child, ...] = ()
    late: dict[str, str] = field(default_factory=dict)


L = "`PHONG_{}_LATENCY"
MUL, ROM, ZEROS, SHIFT, ROUND = (
    L.format(n)
    for n in ("MULTIPLIER", "ROM", "LEADING_ZEROS", "LEFT_SHIFTER", "ROUND_SATURATE")
)  # fmt: skip


def _sum(*terms) -> str:
    return " + ".join(str(t) for t in terms)


def _components(signal: str) -> tuple[str, ...]:
    return tuple(f"+gen_component[{c}].{signal}" for c in range(3))


_TABLE_PORTS = (
    ("write_address", "`PHONG_MATERIAL_BITS + `PHONG_WEIGHT_INDEX_BITS"),
    ("write_word", "2 * `PHONG_COEFFICIENT_BITS + 1"),
)
#: x, y, z of a word {z, y, x} of mantissas.
_MANTISSAS = tuple(
    f"+mantissas[{c} * `PHONG_MANTISSA_BITS +: `PHONG_MANTISSA_BITS]" for c in range(3)
)
#: Where the factors of the highlight are computed.
_POWER_TABLES = "u_specular_factors.gen_power.u_specular_power.gen_tables.u_method"
_WEIGHT_TABLE = "u_specular_factors.gen_weight.u_specular_weight"
_LOG_VALUE = _sum(ZEROS, SHIFT, ROM)
_LOG = L.format("LOG")
_X = _sum(_LOG, MUL, 3)
_OCTAVE = L.format("CURVE_OCTAVE")
_FALL = "`PHONG_STEPPED_FALL_LATENCY"
_LINE = _sum(_X, ROM, L.format("NARROW_MULTIPLIER"), 1)

_SCALE_AT = _sum(
    L.format("LIGHT_NORMAL"), L.format("LIGHT_COLOUR"), "-" + L.format("LIGHT_ATTENUATION")
)

MODULES = {
    "context_interpolator": Module(
        ("single", "advance", "load", "valid", "turn", "next_turn", "start", "step"),
        (Stage("context_interpolator", ("+value", "overflow"), "1"),),
    ),
    "light_align": Module(
        ("x", "y", "z", "first_shift", "first_zero"),
        (
            Stage("light_align.leading_zeros", ("own_shift", "zero"), _sum(1, ZEROS)),
            Stage("light_align.shift", ("shift_p5", "less_p5"), _sum(1, ZEROS, 2)),
            Stage("light_align.align", _MANTISSAS, L.format("LIGHT_ALIGN")),
            Stage("light_align.lit", ("lit",), L.format("LIGHT_ALIGN")),
        ),
        held=(("two_sided", 1), ("valid", 1)),
        late={"first_shift": _sum(1, ZEROS, 1), "first_zero": _sum(1, ZEROS, 1)},
    ),
    "held_root": Module(
        ("first", "mantissas"),
        (
            Stage("held_root.sum_of_squares", ("sum_p4",), _sum(MUL, 2)),
            Stage("held_root.root_operand", ("operand_p5", "below_one_p5"), _sum(MUL, 3)),
            Stage("held_root.hold", ("root", "below_one"), L.format("HELD_ROOT")),
        ),
    ),
    "light_scale": Module(
        ("mantissas", "less", "root", "below_one"),
        (
            Stage(
                "light_scale.scale", _components("gen_scale.shifted"),
                _sum(L.format("HELD_ROOT"), MUL, 1),
            ),
            Stage(
                "light_scale.round", ("+unit_x", "+unit_y", "+unit_z", "cosine"),
                _sum(L.format("HELD_ROOT"), L.format("LIGHT_SCALE")),
            ),
        ),
        late={"root": L.format("HELD_ROOT"), "below_one": L.format("HELD_ROOT")},
    ),
    "light_highlight": Module(
        ("unit_x", "unit_y", "unit_z", "cosine", "material", "exponent"),
        (Stage("light_highlight.round", ("highlight",), L.format("LIGHT_HIGHLIGHT")),),
        held=(
            ("half_x", "`PHONG_HALF_VECTOR_BITS"), ("half_z", "`PHONG_HALF_VECTOR_BITS"),
            ("write_weight", 1), ("write_curve", 1),
            ("write_line", "`PHONG_MATERIAL_BITS + `PHONG_SEGMENT_BITS"),
            ("write_curve_jumps", "2 * `PHONG_MAX_JUMPS"),
            ("write_weight_jumps", "2 * `PHONG_MAX_JUMPS"), *_TABLE_PORTS,
        ),
        children=(
            Child("u_reflection", "reflection", "0"),
            Child(
                _POWER_TABLES, "specular_power_tables",
                L.format("REFLECTION"),
            ),
            Child(
                _WEIGHT_TABLE, "specular_weight",
                _sum(L.format("REFLECTION"), L.format("POWER"),
                     "-" + L.format("SPECULAR_WEIGHT")),
            ),
        ),
        late={"exponent": _sum(L.format("HIGHLIGHT"), L.format("EXPONENT"))},
    ),
    "light_attenuation": Module(
        ("depth", "turn", "cosine", "highlight"),
        (
            Stage("light_attenuation.factor", ("factor",), _SCALE_AT),
            Stage(
                "light_attenuation.scale", ("scaled_cosine", "scaled_highlight"),
                _sum(_SCALE_AT, L.format("LIGHT_ATTENUATION")),
            ),
        ),
        held=(
            ("write_enable", 1),
            ("write_address", "`PHONG_TURN_BITS + `PHONG_WEIGHT_INDEX_BITS"),
            ("write_word", "2 * `PHONG_COEFFICIENT_BITS + 1"),
        ),
        late={"cosine": _SCALE_AT, "highlight": _SCALE_AT},
    ),
    "span_word": Module(
        ("single", "advance", "load", "valid", "turn", "next_turn", "offered"),
        (Stage("span_word", ("word",), "1"),),
    ),
    "light_terms": Module(
        ("place_early", "cosine", "lit", "highlight"),
        (
            Stage(
                "light_terms.sum", tuple(f"gen_channel[{c}].sum" for c in range(3)),
                _sum(L.format("LIGHT_TABLE"), L.format("LIGHT_TERMS")),
            ),
        ),
        held=(
            ("write_diffuse", 3), ("write_highlight", 3),
            ("write_address", "`PHONG_TURN_BITS + `PHONG_MATERIAL_BITS"),
            ("write_word", "`PHONG_COEFFICIENT_BITS"),
        ),
        late={
            "cosine": L.format("LIGHT_TABLE"), "lit": L.format("LIGHT_TABLE"),
            "highlight": _sum(
                L.format("LIGHT_TABLE"),
                "(`PHONG_HIGHLIGHT_COLOUR ? 0 : `PHONG_MULTIPLIER_LATENCY)",
            ),
        },
    ),
    "light_sum": Module(
        ("terms", "first", "material"),
        (
            Stage("light_sum.clamp", ("intensity",), _sum(L.format("LIGHT_SUM"), -2)),
            Stage("light_sum.code", ("colour",), L.format("LIGHT_SUM")),
        ),
        held=(
            ("write_ambient", 1), ("write_address", "`PHONG_MATERIAL_BITS"),
            ("write_word", "`PHONG_COEFFICIENT_BITS"),
        ),
    ),
    "intensity_code": Module(
        ("value",),
        (
            Stage("intensity_code.clamp", ("intensity_p1",), "1"),
            Stage("intensity_code.code", ("colour",), L.format("INTENSITY_CODE")),
        ),
    ),
    "inverse_sqrt_linear": Module(
        ("operand",),
        (
            Stage(
                "inverse_sqrt_linear.lookup", ("value_p3", "slope_p3", "offset_p3"), _sum(1, ROM)
            ),
            Stage("inverse_sqrt_linear.refine", ("line_p6",), _sum(1, ROM, MUL, 1)),
            Stage("inverse_sqrt_linear.round", ("root",), L.format("INVERSE_SQRT_LINEAR")),
        ),
    ),
    "inverse_sqrt_quadratic": Module(
        ("operand",),
        (
            Stage(
                "inverse_sqrt_quadratic.lookup", ("value_p3", "slope_p3", "curve_p3", "offset_p3"),
                _sum(1, ROM),
            ),
            Stage("inverse_sqrt_quadratic.bend", ("slope_p6",), _sum(1, ROM, MUL, 1)),
            Stage("inverse_sqrt_quadratic.refine", ("line_p9",), _sum(1, ROM, MUL, 1, MUL, 1)),
            Stage("inverse_sqrt_quadratic.round", ("root",), L.format("INVERSE_SQRT_QUADRATIC")),
        ),
    ),
    "newton_step": Module(
        ("x", "y"),
        (
            Stage("newton_step.square", ("square_p4",), _sum(MUL, ROUND)),
            Stage("newton_step.error", ("+error_p7",), _sum(MUL, ROUND, MUL, 1)),
            Stage("newton_step.better", ("better",), L.format("NEWTON_STEP")),
        ),
    ),
    "inverse_sqrt_iterated": Module(
        ("operand",),
        (
            Stage("inverse_sqrt_iterated.start", ("start_p3",), L.format("INVERSE_SQRT_START")),
            Stage(
                "inverse_sqrt_iterated.steps", ("root",), L.format("INVERSE_SQRT_ITERATED")
            ),
        ),
    ),
    "unnormalized": Module(
        ("x", "y", "z"),
        (
            Stage(
                "unnormalized.round", ("+unit_x", "+unit_y", "+unit_z", "cosine"),
                L.format("UNNORMALIZED"),
            ),
            Stage("unnormalized.lit", ("lit",), L.format("UNNORMALIZED")),
        ),
        held=(("two_sided", 1),),
    ),
    "normalizer": Module(
        ("x", "y", "z"),
        (
            Stage("normalizer.leading_zeros", ("shift_p3",), _sum(1, ZEROS)),
            Stage("normalizer.align", _components("mantissa_p7"), L.format("ALIGN")),
            Stage("normalizer.sum_of_squares", ("sum_p11",), _sum(L.format("ALIGN"), MUL, 2)),
            Stage(
                "normalizer.root_operand", ("operand_p12", "below_one_p12"),
                _sum(L.format("ALIGN"), MUL, 3),
            ),
            Stage(
                "normalizer.scale", _components("gen_scale.doubled"),
                _sum(L.format("ALIGN"), MUL, 3, L.format("INVERSE_SQRT_LINEAR"), MUL, 1),
            ),
            Stage(
                "normalizer.round", ("+unit_x", "+unit_y", "+unit_z", "cosine"),
                L.format("NORMALIZER"),
            ),
            Stage("normalizer.lit", ("lit",), L.format("NORMALIZER")),
            Stage("normalizer.zero", ("zero_normal",), L.format("ZERO_NORMAL")),
        ),
        held=(("reset", 1), ("two_sided", 1), ("valid", 1)),
        children=(
            Child(
                "u_inverse_sqrt.gen_lines.u_method", "inverse_sqrt_linear",
                _sum(L.format("ALIGN"), MUL, 3),
            ),
        ),
    ),
    "reflection": Module(
        ("unit_x", "unit_y", "unit_z"),
        (
            Stage(
                "reflection.half_vector_cross", ("+cross_xz_p6", "+cross_y_p6"),
                _sum(MUL, 2, ROUND),
            ),
            Stage("reflection.versine", ("versine",), L.format("REFLECTION")),
        ),
        held=(("half_x", "`PHONG_HALF_VECTOR_BITS"), ("half_z", "`PHONG_HALF_VECTOR_BITS")),
    ),
    "specular_power_tables": Module(
        ("versine", "exponent"),
        (
            Stage("specular_power_tables.leading_ones", ("t_p4",), _sum(ZEROS, SHIFT)),
            Stage(
                "specular_power_tables.log_lookup",
                ("log_value_p6", "log_slope_p6", "log_offset_p6"),
                _LOG_VALUE,
            ),
            Stage("specular_power_tables.log_refine", ("g_p9",), _sum(_LOG_VALUE, MUL, 1)),
            Stage("specular_power_tables.log_normalize", ("mantissa_p13 >> dut.MOST",), _LOG),
            Stage("specular_power_tables.times_exponent", ("x_p18",), _X),
            Stage(
                "specular_power_tables.exp_lookup",
                ("exp_value_p20", "exp_slope_p20", "exp_offset_p20"), _sum(_X, ROM),
            ),
            Stage("specular_power_tables.exp_refine", ("line_p25",), _LINE),
            Stage("specular_power_tables.exp_shift", ("power_p29",), _sum(_LINE, 2, ROUND)),
            Stage("specular_power_tables.bypass", ("power",), L.format("SPECULAR_POWER_TABLES")),
        ),
        late={"exponent": _LOG},
    ),
    "specular_cosine": Module(
        ("versine",), (Stage("specular_cosine", ("cosine",), L.format("SPECULAR_COSINE")),)
    ),
    "specular_power_squaring": Module(
        ("versine", "exponent"),
        (
            *(
                Stage(
                    f"specular_power_squaring.stage_{j}",
                    (f"gen_stage[{j}].base_p5", f"gen_stage[{j}].result_p5"),
                    _sum(L.format("SPECULAR_COSINE"), *[L.format("SQUARING_STAGE")] * (j + 1)),
                )
                for j in range(DEFAULT.exponent.integer - 1)
            ),
            Stage("specular_power_squaring.last", ("power",), L.format("SPECULAR_POWER_SQUARING")),
        ),
        late={"exponent": _sum(L.format("SPECULAR_COSINE"), -1)},
    ),
    "specular_power_schlick": Module(
        ("versine", "exponent"),
        (
            Stage("specular_power_schlick.denominator", ("denominator_p5",), _sum(ROUND, MUL, 1)),
            Stage("specular_power_schlick.normalize", ("m_p9",), _sum(ROUND, MUL, 1, ZEROS, SHIFT)),
            Stage(
                "specular_power_schlick.reciprocal", ("reciprocal_p16",),
                _sum(ROUND, MUL, 1, ZEROS, SHIFT, ROM, MUL, 1, ROUND),
            ),
            Stage(
                "specular_power_schlick.quotient", ("power",), L.format("SPECULAR_POWER_SCHLICK")
            ),
        ),
    ),
    "quadratic_interpolator": Module(
        ("advance", "load", "start", "first", "second"),
        (Stage("quadratic_interpolator", ("+value",), "1"),),
    ),
    "quadratic_normalizer": Module(
        ("z", "square", "cross_square"),
        (
            Stage("quadratic_normalizer.operand", ("operand",), _sum(1, ZEROS, SHIFT)),
            Stage(
                "quadratic_normalizer.part", ("cross_p7 >> dut.PART_DROP",),
                _sum(1, ZEROS, SHIFT, 2),
            ),
            Stage("quadratic_normalizer.mantissa", ("z_p7",), _sum(1, ZEROS, SHIFT, ROUND)),
            Stage(
                "quadratic_normalizer.root", ("root",),
                _sum(1, ZEROS, SHIFT, L.format("INVERSE_SQRT")),
            ),
            Stage(
                "quadratic_normalizer.out", ("versine", "cosine", "lit"),
                L.format("QUADRATIC_NORMALIZER"),
            ),
        ),
        held=(("two_sided", 1),),
    ),
    "specular_weight": Module(
        ("cosine", "material"),
        (
            Stage(
                "specular_weight.lookup", ("left_p2", "+step_p2", "offset_p2"), L.format("RAM")
            ),
            Stage("specular_weight.interpolate", ("weight",), L.format("SPECULAR_WEIGHT")),
        ),
        held=(("write_enable", 1), *_TABLE_PORTS),
    ),
    "reflectance_map": Module(
        ("write_enable", "write_address"),
        (
            Stage("reflectance_map.plain", ("plain_enable",), "0"),
            Stage(
                "reflectance_map.strobes",
                ("write_curve", "write_line", "write_curve_jumps", "write_weight_jumps"), "1",
            ),
        ),
    ),
    "reflectance_table": Module(
        ("versine", "material", "write_curve", "write_line", "write_jumps", "write_material",
         "write_word"),
        (
            Stage("reflectance_table.octave", ("place_p4",), _OCTAVE),
            Stage(
                "reflectance_table.lookup",
                ("word_p7[0+:`PHONG_COEFFICIENT_BITS]",
                 "+word_p7[`PHONG_COEFFICIENT_BITS+:`PHONG_COEFFICIENT_BITS+1]", "offset_p7"),
                _sum(_OCTAVE, L.format("RAM"), 1),
            ),
            Stage(
                "reflectance_table.level", ("+u_line.level_p4",),
                _sum(_OCTAVE, L.format("RAM"), 1, _FALL, 1),
            ),
            Stage("reflectance_table.result", ("power",), L.format("REFLECTANCE_TABLE")),
        ),
        late={"material": _OCTAVE},
    ),
    "stepped_weight": Module(
        ("cosine", "material", "write_enable", "write_jumps", "write_address", "write_word"),
        (
            Stage("stepped_weight.lookup", ("left_p2", "+step_p2", "offset_p2"), L.format("RAM")),
            Stage(
                "stepped_weight.level", ("+u_line.level_p4",), _sum(L.format("RAM"), _FALL, 1)
            ),
            Stage("stepped_weight.result", ("weight",), L.format("STEPPED_WEIGHT")),
        ),
    ),
    "shading_unit": Module(
        ("unit_x", "unit_y", "unit_z", "cosine", "lit", "material"),
        (
            Stage(
                "colour_channel.intensity",
                tuple(f"gen_channel[{c}].u_channel.intensity_p5" for c in range(3)),
                _sum(L.format("SHADING_UNIT"), -2),
            ),
            Stage("colour_channel.code", ("red", "green", "blue"), L.format("SHADING_UNIT")),
        ),
        held=(
            ("half_x", "`PHONG_HALF_VECTOR_BITS"), ("half_z", "`PHONG_HALF_VECTOR_BITS"),
            ("write_weight", 1), ("write_exponent", 1), ("write_ambient", 3),
            ("write_diffuse", 3), ("write_curve", 1),
            ("write_line", "`PHONG_MATERIAL_BITS + `PHONG_SEGMENT_BITS"),
            ("write_curve_jumps", "2 * `PHONG_MAX_JUMPS"),
            ("write_weight_jumps", "2 * `PHONG_MAX_JUMPS"), *_TABLE_PORTS,
        ),
        children=(
            Child("gen_specular.gen_reflection.u_reflection", "reflection", "0"),
            Child(
                f"gen_specular.{_POWER_TABLES}",
                "specular_power_tables", L.format("REFLECTION"),
            ),
            Child(
                f"gen_specular.{_WEIGHT_TABLE}", "specular_weight",
                _sum(L.format("REFLECTION"), L.format("POWER"),
                     "-" + L.format("SPECULAR_WEIGHT")),
            ),
        ),
    ),
}  # fmt: skip


@dataclass(frozen=True)
class Lane:
    """One observed signal: its stage, its Verilog expression and its latency (an expression)."""

    stage: str
    signal: str
    latency: str


def lanes(module: str, path: str = "dut.", latency: str = "0") -> list[Lane]:
    """All observed signals of `module` and of its children, in data order.

    path: of the module in the bench. latency: cycles from the bench's input to the module's.
    """
    result = []
    for child in MODULES[module].children:
        result += lanes(child.module, f"{path}{child.instance}.", _sum(latency, child.latency))
    for stage in MODULES[module].stages:
        for signal in stage.signals:
            signed = signal.startswith("+")
            name = path + signal.removeprefix("+")
            result.append(
                Lane(
                    stage.name,
                    f"$signed({name})" if signed else name.replace("dut.MOST", path + "MOST"),
                    _sum(latency, stage.latency),
                )
            )
    return result


def bench_source(module: str) -> tuple[str, str]:
    """(name, Verilog text) of the bench of `module`, a key of MODULES."""
    spec = MODULES[module]
    observed = lanes(module)
    count = len(spec.inputs)
    lines = [f"  wire [64*{len(observed)}-1:0] signals, latencies;"]
    connections = [".clk(clk)"]
    for k, port in enumerate(spec.inputs):
        word = f"vector[{64 * (count - 1 - k)}+:64]"
        lines.append(f"  wire [63:0] in_{port};")
        if port in spec.late:
            lines.append(
                f"  delay #(.BITS(64), .CYCLES({spec.late[port]})) u_late_{port}"
                f" (.clk(clk), .in({word}), .out(in_{port}));"
            )
        else:
            lines.append(f"  assign in_{port} = {word};")
        connections.append(f".{port}(in_{port})")
    connections += [f".{port}({port})" for port, _ in spec.held]
    lines.append(f"  {module} dut (")
    lines.append("      " + ",\n      ".join(connections) + "\n  );")
    for k, lane in enumerate(observed):
        lines.append(f"  wire signed [63:0] lane_{k} = {lane.signal};")
        lines.append(f"  assign signals[{64 * k}+:64] = {known(f'lane_{k}')};")
        lines.append(f"  assign latencies[{64 * k}+:64] = {lane.latency};")
    top = f"{module}_bench"
    text = bench_text(
        top, "sim/module/units.py", count, "\n".join(lines),
        at_start="      " + write("latencies"), per_clock="      " + write("signals"), tail=TAIL,
        ports="".join(f"    input wire [({bits})-1:0] {port},\n" for port, bits in spec.held),
    )  # fmt: skip
    return top, text
