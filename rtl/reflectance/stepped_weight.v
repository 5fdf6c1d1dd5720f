// SPDX-License-Identifier: MIT
// stepped_weight: W(i) as specular_weight gives it, with up to JUMPS jumps per material, which can be
// at any Zn = cos(i).
// Latency: LATENCY cycles (PHONG_STEPPED_WEIGHT_LATENCY in latency.vh; 8 by default).
// Throughput: one result per cycle.
// Reset: none; the tables are undefined until written.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module stepped_weight (
    input wire clk,

    // write port; address: {material, interval}, word: {step s1.16, left u1.16}; jumps at the
    // material, see `jumps`
    input wire                                                     write_enable,  // 1: write
    input wire [2*`PHONG_MAX_JUMPS-1:0]                            write_jumps,
    input wire [`PHONG_MATERIAL_BITS+`PHONG_WEIGHT_INDEX_BITS-1:0] write_address,
    input wire [2*`PHONG_COEFFICIENT_BITS:0]                       write_word,

    // a pixel
    input  wire [`PHONG_MATERIAL_BITS-1:0] material,  // index
    input  wire [`PHONG_COSINE_BITS-1:0]   cosine,    // u0.18, Zn
    output wire [`PHONG_WEIGHT_BITS-1:0]   weight     // u1.17, W(i)
);

  localparam MATERIAL_BITS    = `PHONG_MATERIAL_BITS;
  localparam INDEX_BITS       = `PHONG_WEIGHT_INDEX_BITS;  // 2^INDEX_BITS intervals
  localparam COEFFICIENT_BITS = `PHONG_COEFFICIENT_BITS;
  localparam COSINE_BITS      = `PHONG_COSINE_BITS;        // all of them fraction
  localparam JUMPS            = `PHONG_WEIGHT_JUMPS > 0 ? `PHONG_WEIGHT_JUMPS : 1;
  localparam LATENCY          = `PHONG_STEPPED_WEIGHT_LATENCY;

  localparam OFFSET_BITS = COSINE_BITS - INDEX_BITS;  // place in the interval
  localparam STEP_BITS = COEFFICIENT_BITS + 1;        // signed

  // ---- lookup ----
  wire [STEP_BITS-1:0] step_p2;
  wire [COEFFICIENT_BITS-1:0] left_p2;
  wire [OFFSET_BITS-1:0] offset_p2;

  ram #(
      .ADDRESS_BITS(MATERIAL_BITS + INDEX_BITS),
      .WORD_BITS(STEP_BITS + COEFFICIENT_BITS)
  ) u_table (
      .clk(clk),
      .write_enable(write_enable),
      .write_address(write_address),
      .write_word(write_word),
      .address({material, cosine[COSINE_BITS-1-:INDEX_BITS]}),
      .word({step_p2, left_p2})
  );

  delay #(
      .BITS  (OFFSET_BITS),
      .CYCLES(`PHONG_RAM_LATENCY)
  ) u_offset (
      .clk(clk),
      .in (cosine[OFFSET_BITS-1:0]),
      .out(offset_p2)
  );

  // ---- jumps: they are due when the line is ----
  localparam JUMPS_AT = `PHONG_RAM_LATENCY + `PHONG_STEPPED_FALL_LATENCY - `PHONG_JUMPS_LATENCY;

  wire [MATERIAL_BITS-1:0] material_jumps;
  wire [COSINE_BITS-1:0] cosine_jumps;
  wire [COEFFICIENT_BITS+1:0] fall;

  delay #(
      .BITS  (MATERIAL_BITS),
      .CYCLES(JUMPS_AT)
  ) u_material (
      .clk(clk),
      .in (material),
      .out(material_jumps)
  );

  delay #(
      .BITS  (COSINE_BITS),
      .CYCLES(JUMPS_AT + `PHONG_SMALL_RAM_LATENCY)
  ) u_cosine (
      .clk(clk),
      .in (cosine),
      .out(cosine_jumps)
  );

  jumps #(
      .JUMPS(JUMPS),
      .OPERAND_BITS(COSINE_BITS)
  ) u_jumps (
      .clk(clk),
      .write_enable(write_jumps),
      .write_address(write_address[INDEX_BITS+:MATERIAL_BITS]),
      .write_word(write_word[COSINE_BITS:0]),
      .material(material_jumps),
      .operand(cosine_jumps),
      .sum(fall)
  );

  // ---- level, result ----
  stepped_line u_line (
      .clk(clk),
      .left(left_p2),
      .step(step_p2),
      .offset(offset_p2),
      .fall(fall),
      .value(weight)
  );

endmodule

`default_nettype wire
