// quadratic_interpolator: a quadratic along a span by forward differences (after Duff 1979): two
// additions a pixel.
// Latency 1 from load; one value a clock. What leaves the word wraps.
`default_nettype none
`include "phong_config.vh"

module quadratic_interpolator (
    input  wire                           clk,
    input  wire                           advance,  // take the next value
    input  wire                           load,     // it is start, and the differences come with it
    input  wire [`PHONG_SQUARED_BITS-1:0] start,    // s2.42, at the first pixel's centre
    input  wire [`PHONG_SQUARED_BITS-1:0] first,    // s2.42, from the first pixel to the second
    // s2.42, how much that grows from pixel to pixel
    input  wire [`PHONG_SQUARED_BITS-1:0] second,
    output reg  [`PHONG_SQUARED_BITS-1:0] value     // s2.42, at the present pixel's centre
);

  localparam BITS = `PHONG_SQUARED_BITS;

  reg [BITS-1:0] growth;
  reg [BITS-1:0] second_held;

  always @(posedge clk) begin
    if (advance) begin
      if (load) second_held <= second;
      value <= load ? start : value + growth;
      growth <= load ? first : growth + second_held;
    end
  end

endmodule

`default_nettype wire
