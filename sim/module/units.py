"""Benches of single datapath modules, generated: vectors in from a file, every stage out to a file.

A `Unit` says what a bench holds. Its input words and its observed signals ("lanes") are 64 bits
wide in the files whatever their width in the design, so no width is written here. Every signal of
every stage is recorded each clock together with its latency in clocks as the RTL states it, so
that a mismatch names the first stage that differs and a wrong latency is a mismatch.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from phong75.model.config import DEFAULT


@dataclass(frozen=True)
class Stage:
    """Observed signals of a stage of the twin: `signals` valid `latency` clocks after the input.

    A signal is a path below the module; "+" in front of it marks two's complement.
    """

    name: str
    signals: tuple[str, ...]
    latency: str


@dataclass(frozen=True)
class Child:
    """A module inside a module whose stages are observed too."""

    instance: str
    module: str
    latency: str


@dataclass(frozen=True)
class Module:
    """Input ports that vectors drive (in this order), ports held by cocotb, stages, children."""

    inputs: tuple[str, ...]
    stages: tuple[Stage, ...]
    held: tuple[tuple[str, int | str], ...] = ()
    children: tuple[Child, ...] = ()
    late: dict[str, str] = field(default_factory=dict)  # inputs wanted some clocks later


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
_LOG_VALUE = _sum(ZEROS, SHIFT, ROM)
_LOG = L.format("LOG")
_X = _sum(_LOG, MUL, 3)
_LINE = _sum(_X, ROM, L.format("NARROW_MULTIPLIER"), 1)

MODULES = {
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
            ("write_diffuse", 3), *_TABLE_PORTS,
        ),
        children=(
            Child("gen_specular.gen_reflection.u_reflection", "reflection", "0"),
            Child(
                "gen_specular.gen_power.u_specular_power.gen_tables.u_method",
                "specular_power_tables", L.format("REFLECTION"),
            ),
            Child(
                "gen_specular.gen_weight.u_specular_weight", "specular_weight",
                _sum(L.format("REFLECTION"), L.format("POWER"),
                     "-" + L.format("SPECULAR_WEIGHT")),
            ),
        ),
    ),
}  # fmt: skip


@dataclass(frozen=True)
class Lane:
    """One observed signal: the stage it belongs to, its expression, its latency."""

    stage: str
    signal: str
    latency: str


def lanes(module: str, path: str = "dut.", latency: str = "0") -> list[Lane]:
    """All observed signals of `module` and its children, in the order of the data."""
    out = []
    for child in MODULES[module].children:
        out += lanes(child.module, f"{path}{child.instance}.", _sum(latency, child.latency))
    for stage in MODULES[module].stages:
        for signal in stage.signals:
            signed = signal.startswith("+")
            name = path + signal.removeprefix("+")
            out.append(
                Lane(
                    stage.name,
                    f"$signed({name})" if signed else name.replace("dut.MOST", path + "MOST"),
                    _sum(latency, stage.latency),
                )
            )
    return out


_BENCH = """\
// {top}: generated by sim/units.py
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module {top} (
    input wire clk,
{held_ports}
    input wire        start,
    input wire [31:0] job,      // vectors of <job>.in, signals to <job>.out
    input wire [31:0] vectors,
    output reg        running
);

  localparam INPUTS = {inputs};
  localparam LANES = {lane_count};

  reg [64*INPUTS-1:0] record, vector;
  wire [64*LANES-1:0] signals, latencies;

{wires}
  {module}{parameters} dut (
      .clk(clk){connections}
  );

{assigns}
  reg [255:0] name;
  reg [31:0] clocks;
  integer in_file, out_file, got;
  initial begin
    running = 0;
  end

  always @(posedge clk) begin
    if (!running & start) begin
      $sformat(name, "%0d.in", job);
      in_file = $fopen(name, "rb");
      $sformat(name, "%0d.out", job);
      out_file = $fopen(name, "wb");
      $fwrite(out_file, "%u", latencies);
      clocks <= 0;
      running <= 1;
    end else if (running) begin
      clocks <= clocks + 1;
      if (clocks < vectors) begin
        got = $fread(record, in_file);
        vector <= record;
      end
      $fwrite(out_file, "%u", signals);
      if (clocks == vectors + {tail}) begin
        running <= 0;
        $fclose(in_file);
        $fclose(out_file);
      end
    end
  end
endmodule
"""


def bench_source(module: str, parameters: dict[str, int] | None = None) -> tuple[str, str]:
    """(name, Verilog text) of the bench of `module` with `parameters` set."""
    about = MODULES[module]
    observed = lanes(module)
    wires, connections = [], []
    count = len(about.inputs)
    for k, port in enumerate(about.inputs):
        now = f"vector[{64 * (count - 1 - k)}+:64]"
        wires.append(f"  wire [63:0] in_{port};")
        if port in about.late:
            wires.append(
                f"  delay #(.BITS(64), .CYCLES({about.late[port]})) u_late_{port}"
                f" (.clk(clk), .in({now}), .out(in_{port}));"
            )
        else:
            wires.append(f"  assign in_{port} = {now};")
        connections.append(f",\n      .{port}(in_{port})")
    connections += [f",\n      .{port}({port})" for port, _ in about.held]
    assigns = []
    for k, lane in enumerate(observed):
        assigns.append(f"  wire signed [63:0] lane_{k} = {lane.signal};")
        # An unknown, which a file cannot hold, becomes a value that no signal has.
        known = f"^lane_{k} === 1'bx ? {{1'b1, 63'b0}} : lane_{k}"
        assigns.append(f"  assign signals[{64 * k}+:64] = {known};")
        assigns.append(f"  assign latencies[{64 * k}+:64] = {lane.latency};")
    set_parameters = ", ".join(f".{n}({v})" for n, v in (parameters or {}).items())
    top = f"{module}_bench"
    text = _BENCH.format(
        top=top, module=module, inputs=count, lane_count=len(observed), tail=256,
        parameters=f" #({set_parameters})" if set_parameters else "",
        held_ports="".join(f"    input wire [({bits})-1:0] {port},\n" for port, bits in about.held),
        wires="\n".join(wires) + "\n", connections="".join(connections),
        assigns="\n".join(assigns) + "\n",
    )  # fmt: skip
    return top, text
