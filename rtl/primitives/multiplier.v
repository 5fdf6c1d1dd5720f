// SPDX-License-Identifier: MIT
// multiplier: exact product of two words that fit one 18 x 18 DSP block.
// The operand and product registers are part of the module, so that synthesis can use those of the
// DSP block.
// Latency: LATENCY cycles (PHONG_MULTIPLIER_LATENCY in latency.vh; 2 by default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "latency.vh"

module multiplier #(
    parameter A_BITS   = 18,  // at most 18 for one DSP block
    parameter B_BITS   = 18,
    parameter A_SIGNED = 1,   // 1: two's complement, 0: unsigned
    parameter B_SIGNED = 1,
    parameter LATENCY  = `PHONG_MULTIPLIER_LATENCY
) (
    input  wire                     clk,
    input  wire [A_BITS-1:0]        a,       // format as A_SIGNED says
    input  wire [B_BITS-1:0]        b,       // format as B_SIGNED says
    output reg  [A_BITS+B_BITS-1:0] product  // two's complement if `a` or `b` is
);

  reg [A_BITS-1:0] a_p1;
  reg [B_BITS-1:0] b_p1;

  wire signed [A_BITS:0] a_wide = {(A_SIGNED != 0) & a_p1[A_BITS-1], a_p1};
  wire signed [B_BITS:0] b_wide = {(B_SIGNED != 0) & b_p1[B_BITS-1], b_p1};

  // The two top bits of `full` repeat the sign, so they are dropped.
  // verilator lint_off UNUSEDSIGNAL
  wire signed [A_BITS+B_BITS+1:0] full = a_wide * b_wide;
  // verilator lint_on UNUSEDSIGNAL

  always @(posedge clk) begin
    a_p1 <= a;
    b_p1 <= b;
    product <= full[A_BITS+B_BITS-1:0];
  end

endmodule

`default_nettype wire
