// SPDX-License-Identifier: MIT
// specular_weight: W(i) of Phong 1975, eq. (3), piecewise linear in Zn = cos(i), per material.
// The intervals of Zn are equal. A table word holds one of them: {step to the right point, left
// point}.
// Latency: LATENCY cycles (PHONG_SPECULAR_WEIGHT_LATENCY in latency.vh; 6 by default).
// Throughput: one result per cycle.
// Reset: none; the table is undefined until written.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module specular_weight (
    input wire clk,

    // write port; address: {material, interval}, word: {step s1.16, left u1.16}
    input wire                                                     write_enable,  // 1: write
    input wire [`PHONG_MATERIAL_BITS+`PHONG_WEIGHT_INDEX_BITS-1:0] write_address,
    input wire [2*`PHONG_COEFFICIENT_BITS:0]                       write_word,

    // a pixel
    input  wire [`PHONG_MATERIAL_BITS-1:0] material,  // index
    input  wire [`PHONG_COSINE_BITS-1:0]   cosine,    // u0.18, Zn
    output wire [`PHONG_WEIGHT_BITS-1:0]   weight     // u1.17, W(i)
);

  localparam MATERIAL_BITS        = `PHONG_MATERIAL_BITS;
  localparam INDEX_BITS           = `PHONG_WEIGHT_INDEX_BITS;  // 2^INDEX_BITS intervals
  localparam COEFFICIENT_BITS     = `PHONG_COEFFICIENT_BITS;
  localparam COEFFICIENT_FRACTION = `PHONG_COEFFICIENT_FRACTION;
  localparam COSINE_BITS          = `PHONG_COSINE_BITS;        // all of them fraction
  localparam WEIGHT_BITS          = `PHONG_WEIGHT_BITS;
  localparam WEIGHT_FRACTION      = `PHONG_WEIGHT_FRACTION;
  localparam LATENCY              = `PHONG_SPECULAR_WEIGHT_LATENCY;

  localparam OFFSET_BITS = COSINE_BITS - INDEX_BITS;                       // place in the interval
  localparam STEP_BITS = COEFFICIENT_BITS + 1;                             // signed
  localparam LINE_BITS = STEP_BITS + OFFSET_BITS;
  localparam DROP = OFFSET_BITS + COEFFICIENT_FRACTION - WEIGHT_FRACTION;  // bits rounded off

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

  // ---- interpolate: left + step * offset ----
  wire [LINE_BITS-1:0] rise_p4;
  wire [COEFFICIENT_BITS-1:0] left_p4;
  reg [LINE_BITS-1:0] line_p5;
  reg [WEIGHT_BITS-1:0] weight_p6;

  multiplier #(
      .A_BITS  (STEP_BITS),
      .B_BITS  (OFFSET_BITS),
      .B_SIGNED(0)
  ) u_step (
      .clk(clk),
      .a(step_p2),
      .b(offset_p2),
      .product(rise_p4)
  );

  delay #(
      .BITS  (COEFFICIENT_BITS),
      .CYCLES(`PHONG_MULTIPLIER_LATENCY)
  ) u_left (
      .clk(clk),
      .in (left_p2),
      .out(left_p4)
  );

  always @(posedge clk) begin
    line_p5 <= {1'b0, left_p4, {OFFSET_BITS{1'b0}}} + rise_p4;  // 0 to 1: between two points
    weight_p6 <= line_p5[DROP+:WEIGHT_BITS] + {{WEIGHT_BITS - 1{1'b0}}, line_p5[DROP-1]};
  end

  wire unused = &{1'b0, line_p5[LINE_BITS-1:DROP+WEIGHT_BITS], line_p5[DROP-2:0]};

  assign weight = weight_p6;

endmodule

`default_nettype wire
