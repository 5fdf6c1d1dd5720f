// SPDX-License-Identifier: MIT
// slope_multiplier: exact product of two unsigned words: in logic (narrow_multiplier) if `b` has at
// most 8 bits, else in a DSP block, delayed to the same latency.
// Latency: LATENCY cycles (PHONG_NARROW_MULTIPLIER_LATENCY in latency.vh; 4 by default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "latency.vh"

module slope_multiplier #(
    parameter A_BITS  = 11,
    parameter B_BITS  = 7,
    parameter LATENCY = `PHONG_NARROW_MULTIPLIER_LATENCY
) (
    input  wire                     clk,
    input  wire [A_BITS-1:0]        a,       // unsigned
    input  wire [B_BITS-1:0]        b,       // unsigned
    output wire [A_BITS+B_BITS-1:0] product  // unsigned
);

  generate
    if (B_BITS <= 8) begin : gen_narrow
      narrow_multiplier #(
          .A_BITS(A_BITS),
          .B_BITS(B_BITS)
      ) u_multiplier (
          .clk(clk),
          .a(a),
          .b(b),
          .product(product)
      );
    end else begin : gen_wide
      wire [A_BITS+B_BITS-1:0] product_p2;

      multiplier #(
          .A_BITS  (A_BITS),
          .B_BITS  (B_BITS),
          .A_SIGNED(0),
          .B_SIGNED(0)
      ) u_multiplier (
          .clk(clk),
          .a(a),
          .b(b),
          .product(product_p2)
      );

      delay #(
          .BITS  (A_BITS + B_BITS),
          .CYCLES(LATENCY - `PHONG_MULTIPLIER_LATENCY)
      ) u_wait (
          .clk(clk),
          .in (product_p2),
          .out(product)
      );
    end
  endgenerate

endmodule

`default_nettype wire
