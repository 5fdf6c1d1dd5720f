// SPDX-License-Identifier: MIT
// left_shifter: word << count; zeros are shifted in.
// Two steps: by a multiple of four, then by the remainder.
// Latency: LATENCY cycles (PHONG_LEFT_SHIFTER_LATENCY in latency.vh; 2 by default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "latency.vh"

module left_shifter #(
    parameter BITS       = 32,  // width of the word
    parameter COUNT_BITS = 5,   // 3 or more
    parameter LATENCY    = `PHONG_LEFT_SHIFTER_LATENCY
) (
    input  wire                  clk,
    input  wire [BITS-1:0]       word,    // any format
    input  wire [COUNT_BITS-1:0] count,   // bits to shift by, unsigned
    output reg  [BITS-1:0]       shifted  // what leaves the word at the top is lost
);

  reg [BITS-1:0] coarse_p1;
  reg [1:0] fine_p1;

  always @(posedge clk) begin
    coarse_p1 <= word << {count[COUNT_BITS-1:2], 2'b00};
    fine_p1 <= count[1:0];
    shifted <= coarse_p1 << fine_p1;
  end

endmodule

`default_nettype wire
