// linear_interpolator: one component of the normal along a span, by forward differences -- the
// paper's linear interpolation (eq. 2); three work in parallel.
// Latency 1 from load; one value a clock. Exact: nothing is rounded.
`default_nettype none
`include "phong_config.vh"

module linear_interpolator #(
    parameter NORMAL_BITS = `PHONG_NORMAL_BITS
) (
    input  wire                   clk,
    input  wire                   advance,  // take the next value
    input  wire                   load,     // it is start, and step comes with it; else add step
    input  wire [NORMAL_BITS-1:0] start,    // s1.30, at the first pixel's centre
    input  wire [NORMAL_BITS-1:0] step,     // s1.30, from pixel to pixel
    output wire [NORMAL_BITS-1:0] value,    // s1.30, at the present pixel's centre
    output wire                   overflow  // value has left the word since load
);

  localparam SIGN = NORMAL_BITS - 1;
  localparam LOW_BITS = NORMAL_BITS / 2;
  localparam HIGH_BITS = NORMAL_BITS - LOW_BITS;

  // The low half runs one pixel ahead, so that its carry is a register when the high half adds:
  // no carry runs through more than half of the word.
  reg [NORMAL_BITS-1:0] step_held;
  reg [LOW_BITS-1:0] low;
  reg [LOW_BITS-1:0] low_next;
  reg carry_next;  // from low to low_next
  reg [HIGH_BITS-1:0] high;

  // A sum each for a load and for a step: choosing comes after the sums, since load is late.
  wire [LOW_BITS:0] low_loaded = {1'b0, start[LOW_BITS-1:0]} + {1'b0, step[LOW_BITS-1:0]};
  wire [LOW_BITS:0] low_stepped = {1'b0, low_next} + {1'b0, step_held[LOW_BITS-1:0]};
  wire [HIGH_BITS-1:0] high_sum =
      high + step_held[SIGN:LOW_BITS] + {{HIGH_BITS - 1{1'b0}}, carry_next};

  assign value = {high, low};

  always @(posedge clk) begin
    if (advance) begin
      if (load) step_held <= step;
      low <= load ? start[LOW_BITS-1:0] : low_next;
      {carry_next, low_next} <= load ? low_loaded : low_stepped;
      high <= load ? start[SIGN:LOW_BITS] : high_sum;
    end
  end

  // ---- overflow: looked for after the addition, which takes a whole clock ----
  reg stepped;  // value is a sum
  reg sign_before;  // of what step was added to
  reg overflow_held;  // overflow before that
  wire wrapped = stepped & (sign_before == step_held[SIGN]) & (value[SIGN] != sign_before);

  assign overflow = overflow_held | wrapped;

  always @(posedge clk) begin
    if (advance) begin
      stepped <= ~load;
      sign_before <= value[SIGN];
      overflow_held <= ~load & overflow;
    end
  end

endmodule

`default_nettype wire
