// SPDX-License-Identifier: MIT
// specular_power: cos(s)^n by the method that the configuration names.
// `exponent` comes PHONG_EXPONENT_LATENCY cycles after its `versine`.
// Latency: LATENCY cycles from `versine` (PHONG_SPECULAR_POWER_LATENCY in latency.vh; 30 by
// default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module specular_power (
    input  wire                            clk,
    input  wire [`PHONG_VERSINE_BITS-1:0]  versine,   // u0.22, 1 - cos(s)
    input  wire [`PHONG_EXPONENT_BITS-1:0] exponent,  // u8.9, n, later than `versine`
    output wire [`PHONG_POWER_BITS-1:0]    power,     // u0.18, cos(s)^n

    // curves only: write port, see reflectance_table; the pixel's material, which comes
    // PHONG_SMALL_RAM_LATENCY cycles before `exponent` would
    input wire                                                write_curve,
    input wire [`PHONG_MATERIAL_BITS+`PHONG_SEGMENT_BITS-1:0] write_line,
    input wire [2*`PHONG_MAX_JUMPS-1:0]                       write_jumps,
    input wire [`PHONG_MATERIAL_BITS-1:0]                     write_material,
    input wire [2*`PHONG_COEFFICIENT_BITS:0]                  write_word,
    input wire [`PHONG_MATERIAL_BITS-1:0]                     material  // index
);

  localparam METHOD  = `PHONG_POWER_METHOD;
  localparam LATENCY = `PHONG_SPECULAR_POWER_LATENCY;

  generate
    if (METHOD == `PHONG_POWER_METHOD_TABLES) begin : gen_tables
      specular_power_tables u_method (
          .clk(clk),
          .versine(versine),
          .exponent(exponent),
          .power(power)
      );
    end else if (METHOD == `PHONG_POWER_METHOD_SQUARING) begin : gen_squaring
      specular_power_squaring u_method (
          .clk(clk),
          .versine(versine),
          .exponent(exponent),
          .power(power)
      );
    end else if (METHOD == `PHONG_POWER_METHOD_CURVE) begin : gen_curve
      reflectance_table u_method (
          .clk(clk),
          .write_curve(write_curve),
          .write_line(write_line),
          .write_jumps(write_jumps),
          .write_material(write_material),
          .write_word(write_word),
          .versine(versine),
          .material(material),
          .power(power)
      );
    end else begin : gen_schlick
      specular_power_schlick u_method (
          .clk(clk),
          .versine(versine),
          .exponent(exponent),
          .power(power)
      );
    end
  endgenerate

  wire unused = &{1'b0, exponent, write_curve, write_line, write_jumps, write_material, write_word,
                  material};

endmodule

`default_nettype wire
