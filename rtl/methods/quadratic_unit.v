// quadratic_unit: Phong's shading with the squares of the normal interpolated in place of its x
// and y (after Duff 1979): |N|^2 and its part across h are quadratic along a span, Zn is linear.
// One pixel a clock; PHONG_PIXEL_LATENCY clocks from a pixel of the walker to its colour.
// Wiring in data order.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module quadratic_unit (
    input wire clk,

    // write port for registers and material table (see register_map); hold during a frame
    input wire                                                   write_enable,
    input wire [`PHONG_MATERIAL_BITS+`PHONG_WEIGHT_INDEX_BITS:0] write_address,
    input wire [2*`PHONG_COEFFICIENT_BITS:0]                     write_word,

    // a span, and its pixels
    // {across 2, 1, 0, square 2, 1, 0 (s2.42: second, first
    input wire [(2*`PHONG_NORMAL_BITS+6*`PHONG_SQUARED_BITS)-1:0] values,
                                          // difference, value), step z, start z (s1.30)}
    // this pixel is the first of the span with `values`
    input wire                            load,
    input wire                            advance,         // to the next one
    input wire                            pixel_valid,
    input wire [`PHONG_MATERIAL_BITS-1:0] pixel_material,

    output wire [`PHONG_COLOUR_BITS-1:0] red,          // codes
    output wire [`PHONG_COLOUR_BITS-1:0] green,
    output wire [`PHONG_COLOUR_BITS-1:0] blue,
    output wire                          overflow,     // Zn has left its word since load
    output reg                           zero_normal,  // for one clock: a pixel's |N|^2 is 0
    // for one clock: this build leaves something out
    output wire                          unsupported
);

  localparam NORMAL_BITS      = `PHONG_NORMAL_BITS;
  localparam SQUARED_BITS     = `PHONG_SQUARED_BITS;
  localparam MATERIAL_BITS    = `PHONG_MATERIAL_BITS;
  localparam COEFFICIENT_BITS = `PHONG_COEFFICIENT_BITS;
  localparam INDEX_BITS       = `PHONG_WEIGHT_INDEX_BITS;
  localparam HALF_BITS        = `PHONG_HALF_VECTOR_BITS;
  localparam UNIT_BITS        = `PHONG_UNIT_BITS;
  localparam COSINE_BITS      = `PHONG_COSINE_BITS;
  localparam VERSINE_BITS     = `PHONG_VERSINE_BITS;

  // ---- registers: h is in the squares already ----
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
