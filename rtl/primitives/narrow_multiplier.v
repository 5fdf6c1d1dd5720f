// SPDX-License-Identifier: MIT
// narrow_multiplier: exact product of an unsigned word and an unsigned word of at most 8 bits, in
// logic, because so few bits would waste a DSP block.
// Eight gated rows are added by a tree of three levels.
// Latency: LATENCY cycles (PHONG_NARROW_MULTIPLIER_LATENCY in latency.vh; 4 by default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "latency.vh"

module narrow_multiplier #(
    parameter A_BITS  = 11,
    parameter B_BITS  = 7,  // at most 8
    parameter LATENCY = `PHONG_NARROW_MULTIPLIER_LATENCY
) (
    input  wire                     clk,
    input  wire [A_BITS-1:0]        a,       // unsigned
    input  wire [B_BITS-1:0]        b,       // unsigned
    output wire [A_BITS+B_BITS-1:0] product  // unsigned
);

  localparam ROWS = 8;  // one per bit of b, zero-extended

  wire [ROWS-1:0] rows = {{ROWS - B_BITS{1'b0}}, b};

  reg [A_BITS-1:0] row_p1[0:7];   // a, or 0 where the bit of b is 0
  reg [A_BITS+1:0] pair_p2[0:3];  // sums of 2 rows
  reg [A_BITS+3:0] quad_p3[0:1];  // sums of 4 rows
  reg [A_BITS+7:0] all_p4;        // sum of 8 rows

  integer i;
  always @(posedge clk) begin
    for (i = 0; i < 8; i = i + 1) row_p1[i] <= a & {A_BITS{rows[i]}};
    for (i = 0; i < 4; i = i + 1) begin
      pair_p2[i] <= {2'b0, row_p1[2*i]} + {1'b0, row_p1[2*i+1], 1'b0};
    end
    for (i = 0; i < 2; i = i + 1) begin
      quad_p3[i] <= {2'b0, pair_p2[2*i]} + {pair_p2[2*i+1], 2'b0};
    end
    all_p4 <= {4'b0, quad_p3[0]} + {quad_p3[1], 4'b0};
  end

  assign product = all_p4[A_BITS+B_BITS-1:0];

  generate
    if (B_BITS < ROWS) begin : gen_unused
      wire unused = &{1'b0, all_p4[A_BITS+ROWS-1:A_BITS+B_BITS]};
    end
  endgenerate

endmodule

`default_nettype wire
