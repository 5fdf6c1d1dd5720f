// SPDX-License-Identifier: MIT
// inverse_sqrt_linear: 1/sqrt(x), x in [1, 4), by a piecewise linear table, value - slope * offset:
// the "very fast mechanism for obtaining square roots" of Phong 1975.
// The leading bit is implied: an operand in [0, 1) stands for 1 + x, so 0 gives the largest root.
// Latency: LATENCY cycles (PHONG_INVERSE_SQRT_LINEAR_LATENCY in latency.vh; 8 by default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module inverse_sqrt_linear (
    input  wire                                clk,
    input  wire [`PHONG_ROOT_OPERAND_BITS-1:0] operand,  // u2.20, x
    output wire [`PHONG_ROOT_BITS-1:0]         root      // u0.18, 1/sqrt(x), in (1/2, 1]
);

  localparam OPERAND_BITS = `PHONG_ROOT_OPERAND_BITS;
  localparam INDEX_BITS   = `PHONG_ROOT_INDEX_BITS;  // 2^INDEX_BITS segments per octave
  localparam VALUE_BITS   = `PHONG_ROOT_VALUE_BITS;  // all of them fraction
  localparam SLOPE_BITS   = `PHONG_ROOT_SLOPE_BITS;  // in units of 2^-(VALUE_BITS + 3)
  localparam ROOT_BITS    = `PHONG_ROOT_BITS;
  localparam LATENCY      = `PHONG_INVERSE_SQRT_LINEAR_LATENCY;

  localparam OFFSET_BITS = OPERAND_BITS - 1 - INDEX_BITS;  // place in the segment
  localparam LINE_BITS   = VALUE_BITS + 3;                 // three bits finer than values

  // ---- lookup: segment and offset below the leading one ----
  wire high = operand[OPERAND_BITS-1];  // x >= 2

  reg [INDEX_BITS:0] address_p1;  // {octave, segment}
  reg [OFFSET_BITS-1:0] offset_p1;

  always @(posedge clk) begin
    address_p1 <= {high, high ? operand[OPERAND_BITS-2-:INDEX_BITS]
                              : operand[OPERAND_BITS-3-:INDEX_BITS]};
    offset_p1 <= high ? operand[OFFSET_BITS-1:0] : {operand[OFFSET_BITS-2:0], 1'b0};
  end

  wire [VALUE_BITS-1:0] value_p3;
  wire [SLOPE_BITS-1:0] slope_p3;
  wire [OFFSET_BITS-1:0] offset_p3;

  rom #(
      .ADDRESS_BITS(INDEX_BITS + 1),
      .WORD_BITS(VALUE_BITS + SLOPE_BITS),
      .CONTENTS(`PHONG_INVERSE_SQRT_LINEAR_TABLE)
  ) u_table (
      .clk(clk),
      .address(address_p1),
      .word({value_p3, slope_p3})
  );

  delay #(
      .BITS  (OFFSET_BITS),
      .CYCLES(`PHONG_ROM_LATENCY)
  ) u_offset (
      .clk(clk),
      .in (offset_p1),
      .out(offset_p3)
  );

  // ---- refine: value - slope * offset ----
  wire [SLOPE_BITS+OFFSET_BITS-1:0] drop_p5;
  wire [VALUE_BITS-1:0] value_p5;

  multiplier #(
      .A_BITS  (SLOPE_BITS),
      .B_BITS  (OFFSET_BITS),
      .A_SIGNED(0),
      .B_SIGNED(0)
  ) u_slope (
      .clk(clk),
      .a(slope_p3),
      .b(offset_p3),
      .product(drop_p5)
  );

  delay #(
      .BITS  (VALUE_BITS),
      .CYCLES(`PHONG_MULTIPLIER_LATENCY)
  ) u_value (
      .clk(clk),
      .in (value_p3),
      .out(value_p5)
  );

  reg [LINE_BITS-1:0] line_p6;

  always @(posedge clk) begin
    line_p6 <= {value_p5, 3'b000}
        - {{LINE_BITS - SLOPE_BITS{1'b0}}, drop_p5[SLOPE_BITS+OFFSET_BITS-1:OFFSET_BITS]};
  end

  wire unused = &{1'b0, drop_p5[OFFSET_BITS-1:0]};

  // ---- round ----
  round_saturate #(
      .IN_BITS  (LINE_BITS),
      .DROP     (LINE_BITS - ROOT_BITS),
      .OUT_BITS (ROOT_BITS),
      .IS_SIGNED(0)
  ) u_round (
      .clk(clk),
      .in (line_p6),
      .out(root)
  );

endmodule

`default_nettype wire
