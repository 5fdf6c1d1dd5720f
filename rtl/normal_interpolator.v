// normal_interpolator: one component of the normal along a span, by forward differences -- the
// paper's linear interpolation (eq. 2); three work in parallel.
// Latency 1 from load; one value a clock. Exact: nothing is rounded.
`default_nettype none
`include "phong_config.vh"

module normal_interpolator #(
    parameter NORMAL_BITS = `PHONG_NORMAL_BITS
) (
    input  wire                   clk,
    input  wire                   load,     // take start and step
    input  wire                   advance,  // add step
    input  wire [NORMAL_BITS-1:0] start,    // s1.30, at the first pixel's centre
    input  wire [NORMAL_BITS-1:0] step,     // s1.30, from pixel to pixel
    output reg  [NORMAL_BITS-1:0] value,    // s1.30, at the present pixel's centre
    output reg                    overflow  // value has left the word since load
);

  localparam SIGN = NORMAL_BITS - 1;

  reg  [NORMAL_BITS-1:0] step_held;

  wire [NORMAL_BITS-1:0] sum = value + step_held;
  wire wraps = (value[SIGN] == step_held[SIGN]) & (sum[SIGN] != value[SIGN]);

  always @(posedge clk) begin
    if (load) begin
      value <= start;
      step_held <= step;
      overflow <= 1'b0;
    end else if (advance) begin
      value <= sum;
      overflow <= overflow | wraps;
    end
  end

endmodule

`default_nettype wire
