// SPDX-License-Identifier: MIT
// light_attenuation: N.L and W(i) cos(s)^n of a light that falls with the distance: both times the
// factor of the interpolated distance, which a table of each light holds.
// The factor is Warnock's "decreasing intensity of the reflected light from the object with the
// distance between the light source and the object" (Phong 1975). It scales both terms of the
// light's sum.
// Latency: LATENCY cycles from `cosine` and `highlight` (PHONG_LIGHT_ATTENUATION_LATENCY in
// latency.vh; 4 by default).
// Throughput: one result per cycle.
// Reset: none; the table is undefined until written.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module light_attenuation #(
    parameter DEPTH_BITS       = `PHONG_DEPTH_BITS,
    parameter TURN_BITS        = `PHONG_TURN_BITS,
    parameter MATERIAL_BITS    = `PHONG_MATERIAL_BITS,
    parameter INDEX_BITS       = `PHONG_WEIGHT_INDEX_BITS,
    parameter COEFFICIENT_BITS = `PHONG_COEFFICIENT_BITS,
    parameter COSINE_BITS      = `PHONG_COSINE_BITS,
    parameter HIGHLIGHT_BITS   = `PHONG_HIGHLIGHT_BITS,
    parameter FACTOR_BITS      = `PHONG_WEIGHT_BITS,
    parameter FACTOR_FRACTION  = `PHONG_WEIGHT_FRACTION,
    parameter SPECULAR         = `PHONG_SPECULAR,  // 0: no highlight
    parameter LATENCY          = `PHONG_LIGHT_ATTENUATION_LATENCY
) (
    input wire clk,

    // write port of the table
    input wire                            write_enable,
    input wire [TURN_BITS+INDEX_BITS-1:0] write_address,  // {turn, interval}
    input wire [2*COEFFICIENT_BITS:0]     write_word,     // {step s1.16, left u1.16}

    // a turn, as it leaves the interpolators
    input wire [DEPTH_BITS-1:0] depth,  // s1.29, distance from the light; 0 to 1: the table's range
    input wire [TURN_BITS-1:0]  turn,

    // the same turn, PHONG_LIGHT_NORMAL_LATENCY + PHONG_LIGHT_COLOUR_LATENCY - LATENCY cycles later
    input wire [COSINE_BITS-1:0]    cosine,     // u0.18, N.L
    input wire [HIGHLIGHT_BITS-1:0] highlight,  // u0.18, W(i) cos(s)^n

    // both times the factor
    output wire [COSINE_BITS-1:0]    scaled_cosine,    // u0.18
    output wire [HIGHLIGHT_BITS-1:0] scaled_highlight  // u0.18
);

  localparam SIGN = DEPTH_BITS - 1;
  localparam PLACE_AT = `PHONG_LIGHT_NORMAL_LATENCY + `PHONG_LIGHT_COLOUR_LATENCY - LATENCY
                      - `PHONG_SPECULAR_WEIGHT_LATENCY;

  // ---- place: the depth, cut, and clamped to the table ----
  wire [COSINE_BITS-1:0] place =
      (depth[SIGN-2-:COSINE_BITS] | {COSINE_BITS{depth[SIGN-1]}}) & {COSINE_BITS{~depth[SIGN]}};
  wire [COSINE_BITS-1:0] place_late;
  wire [TURN_BITS-1:0] turn_late;

  delay #(
      .BITS  (COSINE_BITS + TURN_BITS),
      .CYCLES(PLACE_AT)
  ) u_place (
      .clk(clk),
      .in ({place, turn}),
      .out({place_late, turn_late})
  );

  // ---- factor: a table as that of W(i), with turns in place of materials ----
  wire [FACTOR_BITS-1:0] factor;  // u1.17, 0 to 1

  specular_weight u_factor (
      .clk(clk),
      .write_enable(write_enable),
      .write_address({{MATERIAL_BITS - TURN_BITS{1'b0}}, write_address}),
      .write_word(write_word),
      .material({{MATERIAL_BITS - TURN_BITS{1'b0}}, turn_late}),
      .cosine(place_late),
      .weight(factor)
  );

  // ---- scale ----
  wire [FACTOR_BITS+COSINE_BITS-1:0] cosine_product;

  multiplier #(
      .A_BITS  (FACTOR_BITS),
      .B_BITS  (COSINE_BITS),
      .A_SIGNED(0),
      .B_SIGNED(0)
  ) u_cosine (
      .clk(clk),
      .a(factor),
      .b(cosine),
      .product(cosine_product)
  );

  round_saturate #(
      .IN_BITS  (FACTOR_BITS + COSINE_BITS),
      .DROP     (FACTOR_FRACTION),
      .OUT_BITS (COSINE_BITS),
      .IS_SIGNED(0)
  ) u_scaled_cosine (
      .clk(clk),
      .in (cosine_product),
      .out(scaled_cosine)
  );

  generate
    if (SPECULAR) begin : gen_highlight
      wire [FACTOR_BITS+HIGHLIGHT_BITS-1:0] highlight_product;

      multiplier #(
          .A_BITS  (FACTOR_BITS),
          .B_BITS  (HIGHLIGHT_BITS),
          .A_SIGNED(0),
          .B_SIGNED(0)
      ) u_highlight (
          .clk(clk),
          .a(factor),
          .b(highlight),
          .product(highlight_product)
      );

      round_saturate #(
          .IN_BITS  (FACTOR_BITS + HIGHLIGHT_BITS),
          .DROP     (FACTOR_FRACTION),
          .OUT_BITS (HIGHLIGHT_BITS),
          .IS_SIGNED(0)
      ) u_scaled_highlight (
          .clk(clk),
          .in (highlight_product),
          .out(scaled_highlight)
      );
    end else begin : gen_no_highlight
      assign scaled_highlight = highlight;
    end
  endgenerate

  wire unused = &{1'b0, depth[SIGN-2-COSINE_BITS:0]};

endmodule

`default_nettype wire
