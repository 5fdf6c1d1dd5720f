// SPDX-License-Identifier: MIT
// quadratic_unit: Phong shading with squares of the normal interpolated in place of its x and y
// components (after Duff 1979).
// Quadratic along a span are |N|^2 and C = (hz y)^2 + (hz x - hx z)^2, the squared length of the x
// and y components of the cross product N x h; Zn is linear.
// The module holds the wiring, in data order.
// Latency: PHONG_PIXEL_LATENCY cycles from a pixel of span_walker to its colour (see latency.vh; 60
// in the configuration quadratic_spans_18).
// Throughput: one pixel per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module quadratic_unit (
    input wire clk,

    // write port of registers and material table; write between frames only
    input wire                                                   write_enable,   // 1: write
    input wire [`PHONG_MATERIAL_BITS+`PHONG_WEIGHT_INDEX_BITS:0] write_address,  // see register_map
    input wire [2*`PHONG_COEFFICIENT_BITS:0]                     write_word,     // see register_map

    // offered span: {second, first difference and value of C, the same of |N|^2 (s2.42 each),
    // step of Zn, start of Zn (s1.30 each)}
    input wire [(2*`PHONG_NORMAL_BITS+6*`PHONG_SQUARED_BITS)-1:0] values,

    // control from span_walker; `load` acts only together with `advance`
    input wire load,     // 1: the current pixel ends its span; the next one starts from `values`
    input wire advance,  // 1: move to the next pixel

    // current pixel
    input wire                            pixel_valid,     // the pixel leaves the interpolators
    input wire [`PHONG_MATERIAL_BITS-1:0] pixel_material,  // index

    // colour of a pixel
    output wire [`PHONG_COLOUR_BITS-1:0] red,    // code, 0 to 255
    output wire [`PHONG_COLOUR_BITS-1:0] green,  // code, 0 to 255
    output wire [`PHONG_COLOUR_BITS-1:0] blue,   // code, 0 to 255

    // flags
    output wire overflow,     // Zn has left its word since the span's first pixel
    output reg  zero_normal,  // one-cycle pulse: |N|^2 of a pixel is 0
    output wire unsupported   // one-cycle pulse: a write needs what this build leaves out
);

  localparam NORMAL_BITS      = `PHONG_NORMAL_BITS;
  localparam SQUARED_BITS     = `PHONG_SQUARED_BITS;
  localparam MATERIAL_BITS    = `PHONG_MATERIAL_BITS;
  localparam SEGMENT_BITS     = `PHONG_SEGMENT_BITS;
  localparam COEFFICIENT_BITS = `PHONG_COEFFICIENT_BITS;
  localparam INDEX_BITS       = `PHONG_WEIGHT_INDEX_BITS;
  localparam HALF_BITS        = `PHONG_HALF_VECTOR_BITS;
  localparam UNIT_BITS        = `PHONG_UNIT_BITS;
  localparam COSINE_BITS      = `PHONG_COSINE_BITS;
  localparam VERSINE_BITS     = `PHONG_VERSINE_BITS;

  // ---- registers: half_x and half_z are written but not used, for C contains h ----
  wire [HALF_BITS-1:0] half_x, half_z;
  wire two_sided;
  wire write_weight, write_exponent;
  wire [2:0] write_ambient, write_diffuse;
  wire [MATERIAL_BITS+INDEX_BITS-1:0] table_address;
  wire [2*COEFFICIENT_BITS:0] table_word;

  register_map u_register_map (
      .clk(clk),
      .write_enable(write_enable),
      .write_address(write_address),
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
      .unsupported(unsupported)
  );

  // ---- three interpolators in parallel ----
  wire [NORMAL_BITS-1:0] start_z, step_z, z;

  // Of |N|^2 and of C: start, first and second difference, value at the current pixel.
  wire [SQUARED_BITS-1:0] square_0, square_1, square_2, square;
  wire [SQUARED_BITS-1:0] cross_0, cross_1, cross_2, cross_square;

  assign {cross_2, cross_1, cross_0, square_2, square_1, square_0, step_z, start_z} = values;

  linear_interpolator u_interpolator_z (
      .clk(clk),
      .load(load),
      .advance(advance),
      .start(start_z),
      .step(step_z),
      .value(z),
      .overflow(overflow)
  );

  quadratic_interpolator u_interpolator_square (
      .clk(clk),
      .load(load),
      .advance(advance),
      .start(square_0),
      .first(square_1),
      .second(square_2),
      .value(square)
  );

  quadratic_interpolator u_interpolator_cross (
      .clk(clk),
      .load(load),
      .advance(advance),
      .start(cross_0),
      .first(cross_1),
      .second(cross_2),
      .value(cross_square)
  );

  always @(posedge clk) zero_normal <= pixel_valid & (square == 0);

  // ---- cosines ----
  wire [VERSINE_BITS-1:0] versine;
  wire [COSINE_BITS-1:0] cosine;
  wire lit;
  wire [MATERIAL_BITS-1:0] shaded_material;

  quadratic_normalizer u_normalizer (
      .clk(clk),
      .two_sided(two_sided),
      .z(z),
      .square(square),
      .cross_square(cross_square),
      .versine(versine),
      .cosine(cosine),
      .lit(lit)
  );

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
      .write_curve(1'b0),
      .write_line({MATERIAL_BITS + SEGMENT_BITS{1'b0}}),
      .write_curve_jumps({2 * `PHONG_MAX_JUMPS{1'b0}}),
      .write_weight_jumps({2 * `PHONG_MAX_JUMPS{1'b0}}),
      .write_address(table_address),
      .write_word(table_word),
      .unit_x({UNIT_BITS{1'b0}}),
      .unit_y({UNIT_BITS{1'b0}}),
      .unit_z({UNIT_BITS{1'b0}}),
      .given_versine(versine),
      .cosine(cosine),
      .lit(lit),
      .material(shaded_material),
      .red(red),
      .green(green),
      .blue(blue)
  );

endmodule

`default_nettype wire
