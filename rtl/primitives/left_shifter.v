// left_shifter: word << count, zeros shifted in.
// Latency below (multiples of four; the remainder), one result a clock.
`default_nettype none
`include "latency.vh"

module left_shifter #(
    parameter BITS       = 32,
    parameter COUNT_BITS = 5,   // 3 or more
    parameter LATENCY    = `PHONG_LEFT_SHIFTER_LATENCY
) (
    input  wire                  clk,
    input  wire [      BITS-1:0] word,
    input  wire [COUNT_BITS-1:0] count,
    output reg  [      BITS-1:0] shifted
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
