// SPDX-License-Identifier: MIT
// light_highlight: W(i) cos(s)^n of one light; rounded to a word if it is to be multiplied by a
// colour or by the factor of the distance.
// Latency: LATENCY cycles (PHONG_LIGHT_HIGHLIGHT_LATENCY in latency.vh; 44 by default).
// Throughput: one result per cycle.
// Reset: none; the table is undefined until written.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module light_highlight (
    input wire clk,

    // write port of W(i), from register_map
    input wire                                                     write_weight,
    // and of curves and jumps, from reflectance_map
    input wire                                                     write_curve,
    input wire [`PHONG_MATERIAL_BITS+`PHONG_SEGMENT_BITS-1:0]      write_line,
    input wire [2*`PHONG_MAX_JUMPS-1:0]                            write_curve_jumps,
    input wire [2*`PHONG_MAX_JUMPS-1:0]                            write_weight_jumps,
    input wire [`PHONG_MATERIAL_BITS+`PHONG_WEIGHT_INDEX_BITS-1:0] write_address,
    input wire [2*`PHONG_COEFFICIENT_BITS:0]                       write_word,

    // unit normal and half vector, in the frame of the light
    input wire [`PHONG_HALF_VECTOR_BITS-1:0] half_x,  // s0.17, half vector, x
    input wire [`PHONG_HALF_VECTOR_BITS-1:0] half_z,  // s0.17, z
    input wire [`PHONG_UNIT_BITS-1:0]        unit_x,  // s0.17, unit normal, x
    input wire [`PHONG_UNIT_BITS-1:0]        unit_y,  // s0.17, y
    input wire [`PHONG_UNIT_BITS-1:0]        unit_z,  // s0.17, z
    input wire [`PHONG_COSINE_BITS-1:0]      cosine,  // u0.18, cos(i)

    input wire [`PHONG_MATERIAL_BITS-1:0] material,  // index

    // PHONG_HIGHLIGHT_LATENCY + PHONG_EXPONENT_LATENCY cycles later
    input wire [`PHONG_EXPONENT_BITS-1:0] exponent,  // u8.9, n

    // LATENCY cycles later: u0.18 if ROUNDS, else the whole product, u1.35
    output wire [(`PHONG_ROUNDS_HIGHLIGHT ? `PHONG_HIGHLIGHT_BITS
                  : `PHONG_WEIGHT_BITS + `PHONG_POWER_BITS)-1:0] highlight
);

  localparam COSINE_BITS          = `PHONG_COSINE_BITS;
  localparam MATERIAL_BITS        = `PHONG_MATERIAL_BITS;
  localparam VERSINE_BITS         = `PHONG_VERSINE_BITS;
  localparam POWER_BITS           = `PHONG_POWER_BITS;
  localparam POWER_FRACTION       = `PHONG_POWER_FRACTION;
  localparam WEIGHT_BITS          = `PHONG_WEIGHT_BITS;
  localparam WEIGHT_FRACTION      = `PHONG_WEIGHT_FRACTION;
  localparam HIGHLIGHT_BITS       = `PHONG_HIGHLIGHT_BITS;
  localparam HIGHLIGHT_FRACTION   = `PHONG_HIGHLIGHT_FRACTION;
  localparam ROUNDS               = `PHONG_ROUNDS_HIGHLIGHT;
  localparam HAS_CURVES           = `PHONG_HAS_CURVES;       // 1: any curve in place of cos(s)^n
  localparam LATENCY              = `PHONG_LIGHT_HIGHLIGHT_LATENCY;

  // Cycles from the input to the use of W(i) and cos(s)^n.
  localparam POWER_AT = `PHONG_HIGHLIGHT_LATENCY + `PHONG_POWER_LATENCY;
  localparam PRODUCT_BITS = WEIGHT_BITS + POWER_BITS;

  // ---- 1 - cos(s) ----
  wire [VERSINE_BITS-1:0] versine;  // u0.22

  reflection u_reflection (
      .clk(clk),
      .half_x(half_x),
      .half_z(half_z),
      .unit_x(unit_x),
      .unit_y(unit_y),
      .unit_z(unit_z),
      .versine(versine)
  );

  // ---- cos(s)^n, W(i) ----
  wire [POWER_BITS-1:0] power;    // u0.18
  wire [WEIGHT_BITS-1:0] weight;  // u1.17
  wire [MATERIAL_BITS-1:0] material_curve;
  wire [MATERIAL_BITS-1:0] material_weight;
  wire [COSINE_BITS-1:0] cosine_weight;

  generate
    if (HAS_CURVES) begin : gen_curve
      delay #(
          .BITS  (MATERIAL_BITS),
          .CYCLES(`PHONG_HIGHLIGHT_LATENCY + `PHONG_CURVE_OCTAVE_LATENCY)
      ) u_material (
          .clk(clk),
          .in (material),
          .out(material_curve)
      );
    end else begin : gen_no_curve
      assign material_curve = {MATERIAL_BITS{1'b0}};
    end
  endgenerate

  delay #(
      .BITS  (MATERIAL_BITS + COSINE_BITS),
      .CYCLES(POWER_AT - `PHONG_WEIGHT_LATENCY)
  ) u_weight_at (
      .clk(clk),
      .in ({material, cosine}),
      .out({material_weight, cosine_weight})
  );

  specular_factors u_specular_factors (
      .clk(clk),
      .write_weight(write_weight),
      .write_curve(write_curve),
      .write_line(write_line),
      .write_curve_jumps(write_curve_jumps),
      .write_weight_jumps(write_weight_jumps),
      .write_address(write_address),
      .write_word(write_word),
      .versine(versine),
      .material_curve(material_curve),
      .exponent(exponent),
      .cosine(cosine_weight),
      .material_weight(material_weight),
      .power(power),
      .weight(weight)
  );

  wire [PRODUCT_BITS-1:0] product;  // u1.35

  multiplier #(
      .A_BITS  (WEIGHT_BITS),
      .B_BITS  (POWER_BITS),
      .A_SIGNED(0),
      .B_SIGNED(0)
  ) u_product (
      .clk(clk),
      .a(weight),
      .b(power),
      .product(product)
  );

  // ---- round_highlight ----
  generate
    if (ROUNDS) begin : gen_round
      round_saturate #(
          .IN_BITS  (PRODUCT_BITS),
          .DROP     (WEIGHT_FRACTION + POWER_FRACTION - HIGHLIGHT_FRACTION),
          .OUT_BITS (HIGHLIGHT_BITS),
          .IS_SIGNED(0)
      ) u_highlight (
          .clk(clk),
          .in (product),
          .out(highlight)
      );
    end else begin : gen_whole
      assign highlight = product;
    end
  endgenerate

endmodule

`default_nettype wire
