// SPDX-License-Identifier: MIT
// held_root: 1/|N0| of the first light's normal, for all turns of a pixel.
// Latency: LATENCY cycles (PHONG_HELD_ROOT_LATENCY in latency.vh; 14 by default).
// Throughput: one result per cycle; that of a pixel's first turn stays for its other turns.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module held_root (
    input wire clk,

    input wire                               first,      // 1: the first turn of a pixel
    input wire [3*`PHONG_MANTISSA_BITS-1:0]  mantissas,  // s0.17 each, {z, y, x}

    // LATENCY cycles after the first turn
    output wire [`PHONG_ROOT_BITS-1:0] root,      // u0.18, 1/sqrt of the operand
    output wire                        below_one  // 1: the operand is 4 |m|^2, not |m|^2
);

  localparam MANTISSA_BITS     = `PHONG_MANTISSA_BITS;
  localparam MANTISSA_FRACTION = `PHONG_MANTISSA_FRACTION;
  localparam OPERAND_BITS      = `PHONG_ROOT_OPERAND_BITS;
  localparam OPERAND_FRACTION  = `PHONG_ROOT_OPERAND_FRACTION;
  localparam ROOT_BITS         = `PHONG_ROOT_BITS;
  localparam LATENCY           = `PHONG_HELD_ROOT_LATENCY;

  localparam SQUARE_BITS  = 2 * MANTISSA_BITS;
  localparam ONE          = 2 * MANTISSA_FRACTION;   // bit of weight 1 in a square
  localparam OPERAND_DROP = ONE - OPERAND_FRACTION;  // low bits of |m|^2 cut off

  // ---- sum_of_squares ----
  wire [SQUARE_BITS-1:0] square_p2[0:2];
  reg [SQUARE_BITS-1:0] sum_xy_p3;
  reg [SQUARE_BITS-1:0] square_z_p3;
  reg [SQUARE_BITS-1:0] sum_p4;

  genvar c;
  generate
    for (c = 0; c < 3; c = c + 1) begin : gen_square
      multiplier #(
          .A_BITS(MANTISSA_BITS),
          .B_BITS(MANTISSA_BITS)
      ) u_square (
          .clk(clk),
          .a(mantissas[c*MANTISSA_BITS+:MANTISSA_BITS]),
          .b(mantissas[c*MANTISSA_BITS+:MANTISSA_BITS]),
          .product(square_p2[c])
      );
    end
  endgenerate

  always @(posedge clk) begin
    sum_xy_p3 <= square_p2[0] + square_p2[1];
    square_z_p3 <= square_p2[2];
    sum_p4 <= sum_xy_p3 + square_z_p3;
  end

  // ---- root_operand: |m|^2, or 4 |m|^2 if |m|^2 < 1, in [1, 4) ----
  wire below_one_p4 = ~|sum_p4[SQUARE_BITS-1:ONE];

  reg [OPERAND_BITS-1:0] operand_p5;
  reg below_one_p5;

  always @(posedge clk) begin
    operand_p5 <= below_one_p4 ? sum_p4[OPERAND_DROP-2+:OPERAND_BITS]
                               : sum_p4[OPERAND_DROP+:OPERAND_BITS];
    below_one_p5 <= below_one_p4;
  end

  wire unused = &{1'b0, sum_p4[OPERAND_DROP-3:0]};

  wire [ROOT_BITS-1:0] root_p13;
  wire below_one_p13, first_p13;

  inverse_sqrt u_inverse_sqrt (
      .clk(clk),
      .operand(operand_p5),
      .root(root_p13)
  );

  delay #(
      .BITS  (1),
      .CYCLES(`PHONG_INVERSE_SQRT_LATENCY)
  ) u_below_one (
      .clk(clk),
      .in (below_one_p5),
      .out(below_one_p13)
  );

  // ---- hold ----
  delay #(
      .BITS  (1),
      .CYCLES(LATENCY - 1)
  ) u_first (
      .clk(clk),
      .in (first),
      .out(first_p13)
  );

  turn_hold #(
      .BITS(ROOT_BITS + 1)
  ) u_hold (
      .clk(clk),
      .first(first_p13),
      .in({below_one_p13, root_p13}),
      .out({below_one, root})
  );

endmodule

`default_nettype wire
