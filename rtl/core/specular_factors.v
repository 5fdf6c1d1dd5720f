// SPDX-License-Identifier: MIT
// specular_factors: the two factors of the highlight, cos(s)^n and W(i), each by the method that
// the configuration names.
// The inputs come at different times, so that both factors leave in the same cycle. From `versine`
// it is PHONG_POWER_LATENCY cycles, from `cosine` and `material_weight` PHONG_WEIGHT_LATENCY;
// `exponent` comes PHONG_EXPONENT_LATENCY cycles after `versine`, and `material_curve`
// PHONG_SMALL_RAM_LATENCY cycles before `exponent`.
// Latency: LATENCY cycles from `versine` (PHONG_POWER_LATENCY in latency.vh; 30 by default).
// Throughput: one pixel per cycle.
// Reset: none; the tables are undefined until written.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module specular_factors (
    input wire clk,

    // write port of W(i), from register_map
    input wire                                                     write_weight,
    // and of curves and jumps, from reflectance_map
    input wire                                                     write_curve,
    input wire [`PHONG_MATERIAL_BITS+`PHONG_SEGMENT_BITS-1:0]      write_line,
    input wire [2*`PHONG_MAX_JUMPS-1:0]                            write_curve_jumps,
    input wire [2*`PHONG_MAX_JUMPS-1:0]                            write_weight_jumps,
    // address: {material, interval or field}
    input wire [`PHONG_MATERIAL_BITS+`PHONG_WEIGHT_INDEX_BITS-1:0] write_address,
    input wire [2*`PHONG_COEFFICIENT_BITS:0]                       write_word,

    // a pixel
    input wire [`PHONG_VERSINE_BITS-1:0]  versine,          // u0.22, 1 - cos(s)
    input wire [`PHONG_MATERIAL_BITS-1:0] material_curve,   // index
    input wire [`PHONG_EXPONENT_BITS-1:0] exponent,         // u8.9, n
    input wire [`PHONG_COSINE_BITS-1:0]   cosine,           // u0.18, cos(i)
    input wire [`PHONG_MATERIAL_BITS-1:0] material_weight,  // index

    output wire [`PHONG_POWER_BITS-1:0]  power,  // u0.18, cos(s)^n
    output wire [`PHONG_WEIGHT_BITS-1:0] weight  // u1.17, W(i)
);

  localparam MATERIAL_BITS        = `PHONG_MATERIAL_BITS;
  localparam INDEX_BITS           = `PHONG_WEIGHT_INDEX_BITS;
  localparam COEFFICIENT_BITS     = `PHONG_COEFFICIENT_BITS;
  localparam COEFFICIENT_FRACTION = `PHONG_COEFFICIENT_FRACTION;
  localparam WEIGHT_BITS          = `PHONG_WEIGHT_BITS;
  localparam WEIGHT_FRACTION      = `PHONG_WEIGHT_FRACTION;
  localparam POWER_FUNCTION       = `PHONG_POWER_FUNCTION;   // 0: n is always 1
  localparam WEIGHT_FUNCTION      = `PHONG_WEIGHT_FUNCTION;  // 0: W does not depend on i
  localparam WEIGHT_JUMPS         = `PHONG_WEIGHT_JUMPS;     // 0: W is continuous
  localparam CONSTANT_WEIGHT      = `PHONG_CONSTANT_WEIGHT;  // 1: W is a constant of the build
  localparam LATENCY              = `PHONG_POWER_LATENCY;

  wire [MATERIAL_BITS-1:0] write_material = write_address[INDEX_BITS+:MATERIAL_BITS];

  // ---- cos(s)^n ----
  generate
    if (POWER_FUNCTION) begin : gen_power
      specular_power u_specular_power (
          .clk(clk),
          .versine(versine),
          .exponent(exponent),
          .power(power),
          .write_curve(write_curve),
          .write_line(write_line),
          .write_jumps(write_curve_jumps),
          .write_material(write_material),
          .write_word(write_word),
          .material(material_curve)
      );
    end else begin : gen_cosine
      specular_cosine u_specular_cosine (
          .clk(clk),
          .versine(versine),
          .cosine(power)
      );
    end
  endgenerate

  // ---- W(i) ----
  generate
    if (WEIGHT_FUNCTION && WEIGHT_JUMPS > 0) begin : gen_stepped_weight
      stepped_weight u_stepped_weight (
          .clk(clk),
          .write_enable(write_weight),
          .write_jumps(write_weight_jumps),
          .write_address(write_address),
          .write_word(write_word),
          .material(material_weight),
          .cosine(cosine),
          .weight(weight)
      );
    end else if (WEIGHT_FUNCTION) begin : gen_weight
      specular_weight u_specular_weight (
          .clk(clk),
          .write_enable(write_weight),
          .write_address(write_address),
          .write_word(write_word),
          .material(material_weight),
          .cosine(cosine),
          .weight(weight)
      );
    end else if (CONSTANT_WEIGHT) begin : gen_constant_weight  // a constant of the product
      assign weight = {WEIGHT_BITS{1'b0}};
    end else begin : gen_material_weight  // the left point of interval 0
      wire [COEFFICIENT_BITS-1:0] left;

      small_ram #(
          .ADDRESS_BITS(MATERIAL_BITS),
          .WORD_BITS(COEFFICIENT_BITS)
      ) u_weight_table (
          .clk(clk),
          .write_enable(write_weight),
          .write_address(write_material),
          .write_word(write_word[COEFFICIENT_BITS-1:0]),
          .address(material_weight),
          .word(left)
      );

      assign weight = {left, {WEIGHT_FRACTION - COEFFICIENT_FRACTION{1'b0}}};
    end
  endgenerate

  wire unused = &{1'b0, write_weight, write_curve, write_line, write_curve_jumps,
                  write_weight_jumps, write_address, write_word, material_curve, exponent, cosine,
                  material_weight};

endmodule

`default_nettype wire
