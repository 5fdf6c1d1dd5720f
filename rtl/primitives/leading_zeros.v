// SPDX-License-Identifier: MIT
// leading_zeros: counts the zeros above the highest 1 of a word.
// Two steps: the highest 1 within each group of four bits, then the highest group with a 1.
// Latency: LATENCY cycles (PHONG_LEADING_ZEROS_LATENCY in latency.vh; 2 by default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "latency.vh"

module leading_zeros #(
    parameter BITS       = 31,  // width of the word
    parameter COUNT_BITS = 5,   // enough for BITS itself
    parameter LATENCY    = `PHONG_LEADING_ZEROS_LATENCY
) (
    input  wire                  clk,
    input  wire [BITS-1:0]       word,  // unsigned
    output reg  [COUNT_BITS-1:0] count  // zeros above the highest 1; BITS if `word` is 0
);

  localparam GROUPS = BITS / 4 + 1;  // at least BITS + 1 bits: a 1 below the word ends the count

  wire [4*GROUPS-1:0] padded = {word, 1'b1, {4 * GROUPS - BITS - 1{1'b0}}};

  reg [GROUPS-1:0] any_p1;         // the group has a 1
  reg [1:0] place_p1[0:GROUPS-1];  // zeros above the highest 1 of the group
  reg [COUNT_BITS-1:0] count_next;

  integer g;
  always @(posedge clk) begin
    for (g = 0; g < GROUPS; g = g + 1) begin
      any_p1[g] <= |padded[4*g+:4];
      place_p1[g] <= padded[4*g+3] ? 2'd0 : padded[4*g+2] ? 2'd1 : padded[4*g+1] ? 2'd2 : 2'd3;
    end
  end

  // The loop ends with the highest group, so the highest group with a 1 decides the count.
  // h groups are above the group GROUPS-1-h.
  integer h;
  always @* begin
    count_next = {COUNT_BITS{1'b0}};
    for (h = GROUPS - 1; h >= 0; h = h - 1) begin
      if (any_p1[GROUPS-1-h]) count_next = {h[COUNT_BITS-3:0], place_p1[GROUPS-1-h]};
    end
  end

  always @(posedge clk) count <= count_next;

endmodule

`default_nettype wire
