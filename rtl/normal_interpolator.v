// normal_interpolator: one component of the normal along a span, by forward differences -- the
// paper's linear interpolation (eq. 2); three work in parallel.
// Latency 1 from load; one value a clock. Exact: nothing is rounded.
`default_nettype none
`include "phong_config.vh"

module normal_interpolator #(
    parameter NORMAL_BITS = `PHONG_NORMAL_BITS
) (
    input  wire                   clk,
    input  wire                   advance,  // take the next value
    input  wire                   load,     // it is start, and step comes with it; else add step
    input  wire [NORMAL_BITS-1:0] start,    // s1.30, at the first pixel's centre
    input  wire [NORMAL_BITS-1:0] step,     // s1.30, from pixel to pixel
    output reg  [NORMAL_BITS-1:0] value,    // s1.30, at the present pixel's centre
    output wire                   overflow  // value has left the word since load
);

  localparam SIGN = NORMAL_BITS - 1;

  reg  [NORMAL_BITS-1:0] step_held;

  wire [NORMAL_BITS-1:0] sum = value + step_held;

  // Looked for after the addition, in what is left of it, since the addition takes a whole clock.
  reg  stepped;  // value is a sum
  reg  sign_before;  // of what step was added to
  reg  left;  // overflow before that
  wire wrapped = stepped & (sign_before == step_held[SIGN]) & (value[SIGN] != sign_before);

  assign overflow = left | wrapped;

  always @(posedge clk) begin
    if (advance) begin
      if (load) step_held <= step;
      value <= load ? start : sum;
      stepped <= ~load;
      sign_before <= value[SIGN];
      left <= ~load & overflow;
    end
  end

endmodule

`default_nettype wire
