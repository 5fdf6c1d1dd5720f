// SPDX-License-Identifier: MIT
// turn_hold: the word of a pixel's first turn, for all turns of the pixel.
// Latency: 1 cycle.
// Throughput: one word per cycle.
// Reset: none.
`default_nettype none

module turn_hold #(
    parameter BITS = 1  // width of the word
) (
    input  wire            clk,
    input  wire            first,  // 1: the turn is the first of its pixel
    input  wire [BITS-1:0] in,     // word of any format
    output reg  [BITS-1:0] out     // the word of the first turn
);

  always @(posedge clk) if (first) out <= in;

endmodule

`default_nettype wire
