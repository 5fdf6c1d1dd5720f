// SPDX-License-Identifier: MIT
// phong_unit: Phong shading, the hardware proposed in Phong 1975: three interpolators in parallel
// for the normal, a normalizer and a unit for the shading function.
// The module holds the wiring, in data order.
// Latency: PHONG_PIXEL_LATENCY cycles from a pixel of span_walker to its colour (see latency.vh; 74
// by default).
// Throughput: one pixel per cycle.
// Reset: synchronous; of the flags only.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module phong_unit (
    input wire clk,
    input wire reset,  // synchronous

    // write port of registers and material table; write between frames only
    input wire                               write_enable,   // 1: write
    input wire [`PHONG_ADDRESS_BITS-1:0]     write_address,  // see register_map, reflectance_map
    input wire [2*`PHONG_COEFFICIENT_BITS:0] write_word,     // see register_map

    // offered span
    input wire                            taken,     // the span is accepted in this cycle
    input wire [`PHONG_VALUES_BITS-1:0]   values,    // {step z, y, x, start z, y, x}, s1.30 each;
                                                     // NORMAL_ORDER 2: bend z, y, x above, s1.42
    input wire [`PHONG_COORDINATE_BITS:0] length,    // pixels
    input wire [`PHONG_MATERIAL_BITS-1:0] material,  // index

    // control from span_walker; `load` acts only together with `advance`
    input wire load,     // 1: the current pixel ends its span; the next one starts from `values`
    input wire advance,  // 1: move to the next pixel

    // current pixel
    input wire                              pixel_valid,     // the pixel leaves the interpolators
    input wire [`PHONG_COORDINATE_BITS-1:0] pixel_x,         // pixels
    input wire [`PHONG_COORDINATE_BITS-1:0] pixel_y,         // pixels
    input wire [`PHONG_MATERIAL_BITS-1:0]   pixel_material,  // index

    // colour of a pixel
    output wire [`PHONG_COLOUR_BITS-1:0] red,    // code, 0 to 255
    output wire [`PHONG_COLOUR_BITS-1:0] green,  // code, 0 to 255
    output wire [`PHONG_COLOUR_BITS-1:0] blue,   // code, 0 to 255

    // flags
    output wire overflow,     // a component has left its word since the first pixel of the span
    output wire zero_normal,  // one-cycle pulse: the normal of a pixel is the zero vector
    output wire unsupported   // one-cycle pulse: a write or a span needs what this build leaves out
);

  localparam HOLD_UNLIT       = `PHONG_HOLD_UNLIT;      // 1: unlit pixels toggle nothing
  localparam NORMAL_METHOD    = `PHONG_NORMAL_METHOD;
  localparam NORMAL_ORDER     = `PHONG_NORMAL_ORDER;    // 2: normals are quadratic along a span
  localparam NORMAL_BITS      = `PHONG_NORMAL_BITS;
  localparam BEND_BITS        = NORMAL_BITS + `PHONG_BEND_FRACTION_BITS;
  localparam MATERIAL_BITS    = `PHONG_MATERIAL_BITS;
  localparam COEFFICIENT_BITS = `PHONG_COEFFICIENT_BITS;
  localparam INDEX_BITS       = `PHONG_WEIGHT_INDEX_BITS;
  localparam HALF_BITS        = `PHONG_HALF_VECTOR_BITS;
  localparam UNIT_BITS        = `PHONG_UNIT_BITS;
  localparam COSINE_BITS      = `PHONG_COSINE_BITS;
  localparam VERSINE_BITS     = `PHONG_VERSINE_BITS;
  localparam SEGMENT_BITS     = `PHONG_SEGMENT_BITS;
  localparam INTERPOLATE_X    = `PHONG_INTERPOLATE_X;   // 0: the component is constant over a span
  localparam INTERPOLATE_Y    = `PHONG_INTERPOLATE_Y;
  localparam INTERPOLATE_Z    = `PHONG_INTERPOLATE_Z;
  localparam IDLE_STEP_BITS   = `PHONG_IDLE_STEP_BITS;  // top bits of a step that repeat its sign

  // ---- registers ----
  wire [HALF_BITS-1:0] half_x, half_z;
  wire two_sided;
  wire write_weight, write_exponent;
  wire [2:0] write_ambient, write_diffuse;
  wire [MATERIAL_BITS+INDEX_BITS-1:0] table_address;
  wire [2*COEFFICIENT_BITS:0] table_word;
  wire unsupported_write, unsupported_span;
  wire plain_enable, write_curve;
  wire [MATERIAL_BITS+SEGMENT_BITS-1:0] write_line;
  wire [2*`PHONG_MAX_JUMPS-1:0] write_curve_jumps, write_weight_jumps;

  reflectance_map u_reflectance_map (
      .clk(clk),
      .write_enable(write_enable),
      .write_address(write_address),
      .plain_enable(plain_enable),
      .write_curve(write_curve),
      .write_line(write_line),
      .write_curve_jumps(write_curve_jumps),
      .write_weight_jumps(write_weight_jumps)
  );

  register_map u_register_map (
      .clk(clk),
      .write_enable(plain_enable),
      .write_address(write_address[MATERIAL_BITS+INDEX_BITS:0]),
      .write_word(write_word),
      .half_x(half_x),
      .half_z(half_z),
      .two_sided(two_sided),
      .write_weight(write_weight),
      .write_exponent(write_exponent),
      .write_ambient(write_ambient),
      .write_diffuse(write_diffuse),
      .table_address(table_address),
      .table_word(table_word),
      .unsupported(unsupported_write)
  );

  assign unsupported = unsupported_write | unsupported_span;

  // ---- spans ----
  // In a pruned build, step components and step bits that no span uses are constant from here on.
  // span_guard flags the spans that do use them.
  wire [NORMAL_BITS-1:0] start_x, start_y, start_z;
  wire [NORMAL_BITS-1:0] step_x, step_y, step_z;
  wire [NORMAL_BITS-1:0] normal_x, normal_y, normal_z;
  wire overflow_x, overflow_y, overflow_z;

  assign {step_z, step_y, step_x, start_z, start_y, start_x} = values[6*NORMAL_BITS-1:0];
  assign overflow = overflow_x | overflow_y | overflow_z;

  wire [NORMAL_BITS-1:0] slope_x =
      INTERPOLATE_X ? $signed(step_x << IDLE_STEP_BITS) >>> IDLE_STEP_BITS : 0;
  wire [NORMAL_BITS-1:0] slope_y =
      INTERPOLATE_Y ? $signed(step_y << IDLE_STEP_BITS) >>> IDLE_STEP_BITS : 0;
  wire [NORMAL_BITS-1:0] slope_z =
      INTERPOLATE_Z ? $signed(step_z << IDLE_STEP_BITS) >>> IDLE_STEP_BITS : 0;

  wire [BEND_BITS-1:0] bend_x, bend_y, bend_z;

  generate
    if (NORMAL_ORDER == 2) begin : gen_bend
      assign {bend_z, bend_y, bend_x} = values[6*NORMAL_BITS+:3*BEND_BITS];
    end else begin : gen_no_bend
      assign {bend_z, bend_y, bend_x} = {3 * BEND_BITS{1'b0}};
    end
  endgenerate

  span_guard u_span_guard (
      .clk(clk),
      .reset(reset),
      .taken(taken),
      .step_x(step_x),
      .step_y(step_y),
      .step_z(step_z),
      .bend_x(bend_x),
      .bend_y(bend_y),
      .bend_z(bend_z),
      .length(length),
      .material(material),
      .pixel_valid(pixel_valid),
      .at_end(load),
      .pixel_x(pixel_x),
      .pixel_y(pixel_y),
      .normal_x(normal_x),
      .normal_y(normal_y),
      .normal_z(normal_z),
      .unsupported(unsupported_span)
  );

  // ---- three interpolators in parallel ----
  // Where normals are quadratic, nothing reads the linear interpolators, and synthesis leaves them
  // out. They are outside the `generate`, so that the cells of a linear build keep their names and
  // their order.
  wire [NORMAL_BITS-1:0] linear_x, linear_y, linear_z;
  wire leaves_x, leaves_y, leaves_z;  // a component has left its word

  linear_interpolator u_interpolator_x (
      .clk(clk),
      .load(load),
      .advance(advance),
      .start(start_x),
      .step(slope_x),
      .value(linear_x),
      .overflow(leaves_x)
  );

  linear_interpolator u_interpolator_y (
      .clk(clk),
      .load(load),
      .advance(advance),
      .start(start_y),
      .step(slope_y),
      .value(linear_y),
      .overflow(leaves_y)
  );

  linear_interpolator u_interpolator_z (
      .clk(clk),
      .load(load),
      .advance(advance),
      .start(start_z),
      .step(slope_z),
      .value(linear_z),
      .overflow(leaves_z)
  );

  generate
    if (NORMAL_ORDER == 2) begin : gen_quadratic
      second_difference_interpolator u_quadratic_x (
          .clk(clk),
          .load(load),
          .advance(advance),
          .start(start_x),
          .step(slope_x),
          .bend(INTERPOLATE_X ? bend_x : {BEND_BITS{1'b0}}),
          .value(normal_x),
          .overflow(overflow_x)
      );

      second_difference_interpolator u_quadratic_y (
          .clk(clk),
          .load(load),
          .advance(advance),
          .start(start_y),
          .step(slope_y),
          .bend(INTERPOLATE_Y ? bend_y : {BEND_BITS{1'b0}}),
          .value(normal_y),
          .overflow(overflow_y)
      );

      second_difference_interpolator u_quadratic_z (
          .clk(clk),
          .load(load),
          .advance(advance),
          .start(start_z),
          .step(slope_z),
          .bend(INTERPOLATE_Z ? bend_z : {BEND_BITS{1'b0}}),
          .value(normal_z),
          .overflow(overflow_z)
      );

      wire unused = &{1'b0, linear_x, linear_y, linear_z, leaves_x, leaves_y, leaves_z};
    end else begin : gen_linear
      assign {normal_x, normal_y, normal_z} = {linear_x, linear_y, linear_z};
      assign {overflow_x, overflow_y, overflow_z} = {leaves_x, leaves_y, leaves_z};
    end
  endgenerate

  // ---- unit normal ----
  wire [UNIT_BITS-1:0] unit_x, unit_y, unit_z;
  wire [COSINE_BITS-1:0] cosine;
  wire lit;
  wire [MATERIAL_BITS-1:0] shaded_material;
  wire [NORMAL_BITS-1:0] held_x, held_y, held_z;
  wire held_valid, shown, lit_normal;

  generate
    if (HOLD_UNLIT) begin : gen_hold
      wire pixel_held, shown_now;

      normal_hold u_normal_hold (
          .clk(clk),
          .two_sided(two_sided),
          .valid(pixel_valid),
          .x(normal_x),
          .y(normal_y),
          .z(normal_z),
          .held_valid(pixel_held),
          .shown(shown_now),
          .held_x(held_x),
          .held_y(held_y),
          .held_z(held_z)
      );

      assign held_valid = pixel_held & shown_now;  // a held zero normal is flagged once

      delay #(
          .BITS  (1),
          .CYCLES(`PHONG_NORMAL_LATENCY - 1)
      ) u_shown (
          .clk(clk),
          .in (shown_now),
          .out(shown)
      );
    end else begin : gen_no_hold
      assign {held_x, held_y, held_z} = {normal_x, normal_y, normal_z};
      assign held_valid = pixel_valid;
      assign shown = 1'b1;
    end

    if (NORMAL_METHOD == `PHONG_NORMAL_METHOD_NONE) begin : gen_unnormalized
      unnormalized u_unnormalized (
          .clk(clk),
          .two_sided(two_sided),
          .x(held_x),
          .y(held_y),
          .z(held_z),
          .unit_x(unit_x),
          .unit_y(unit_y),
          .unit_z(unit_z),
          .cosine(cosine),
          .lit(lit_normal)
      );

      assign zero_normal = 1'b0;  // nothing is divided by the length of the normal

      wire unused = &{1'b0, held_valid};
    end else begin : gen_normalized
      normalizer u_normalizer (
          .clk(clk),
          .reset(reset),
          .two_sided(two_sided),
          .valid(held_valid),
          .half_x(half_x),
          .half_z(half_z),
          .x(held_x),
          .y(held_y),
          .z(held_z),
          .unit_x(unit_x),
          .unit_y(unit_y),
          .unit_z(unit_z),
          .cosine(cosine),
          .lit(lit_normal),
          .zero_normal(zero_normal)
      );
    end
  endgenerate

  assign lit = lit_normal & shown;

  delay #(
      .BITS  (MATERIAL_BITS),
      .CYCLES(`PHONG_NORMAL_LATENCY)
  ) u_material (
      .clk(clk),
      .in (pixel_material),
      .out(shaded_material)
  );

  // ---- colour ----
  shading_unit u_shading_unit (
      .clk(clk),
      .half_x(half_x),
      .half_z(half_z),
      .write_weight(write_weight),
      .write_exponent(write_exponent),
      .write_ambient(write_ambient),
      .write_diffuse(write_diffuse),
      .write_curve(write_curve),
      .write_line(write_line),
      .write_curve_jumps(write_curve_jumps),
      .write_weight_jumps(write_weight_jumps),
      .write_address(table_address),
      .write_word(table_word),
      .unit_x(unit_x),
      .unit_y(unit_y),
      .unit_z(unit_z),
      .given_versine({VERSINE_BITS{1'b0}}),
      .cosine(cosine),
      .lit(lit),
      .material(shaded_material),
      .red(red),
      .green(green),
      .blue(blue)
  );

endmodule

`default_nettype wire
