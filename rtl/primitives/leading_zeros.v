// leading_zeros: number of zeros above the highest one; BITS if there is none.
// Latency below (position within groups of four; first group that is not zero), one result a clock.
`default_nettype none
`include "latency.vh"

module leading_zeros #(
    parameter BITS       = 31,
    parameter COUNT_BITS = 5,   // enough for BITS itself
    parameter LATENCY    = `PHONG_LEADING_ZEROS_LATENCY
) (
    input  wire                  clk,
    input  wire [      BITS-1:0] word,
    output reg  [COUNT_BITS-1:0] count
);

  localparam GROUPS = BITS / 4 + 1;  // one bit more at least: the one that ends an empty word

  wire [4*GROUPS-1:0] padded = {word, 1'b1, {4 * GROUPS - BITS - 1{1'b0}}};

  reg [GROUPS-1:0] any_p1;
  reg [1:0] place_p1[0:GROUPS-1];
  reg [COUNT_BITS-1:0] count_next;

  integer g;
  always @(posedge clk) begin
    for (g = 0; g < GROUPS; g = g + 1) begin
      any_p1[g] <= |padded[4*g+:4];
      place_p1[g] <= padded[4*g+3] ? 2'd0 : padded[4*g+2] ? 2'd1 : padded[4*g+1] ? 2'd2 : 2'd3;
    end
  end

  // The highest group that is not zero is the last to speak; h groups are above it.
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
