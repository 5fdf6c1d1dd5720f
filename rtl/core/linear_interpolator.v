// SPDX-License-Identifier: MIT
// linear_interpolator: one component along a span by forward differences: the linear interpolation
// of Phong 1975, eq. (2). Three in parallel interpolate a normal; in Gouraud shading each colour
// channel has one.
// At a load the value is `start`, and `step` is latched. At any other advance the held step is
// added. The values are exact: nothing is rounded.
// Latency: 1 cycle from `load` to the first value of the span.
// Throughput: one value per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"

module linear_interpolator #(
    parameter NORMAL_BITS = `PHONG_NORMAL_BITS
) (
    input wire clk,

    // control; `load` acts only together with `advance`
    input wire advance,  // 1: move to the next pixel
    input wire load,     // 1: the current pixel ends its span; the next one starts from `start`

    // offered span
    input wire [NORMAL_BITS-1:0] start,  // s1.30, at the centre of the first pixel
    input wire [NORMAL_BITS-1:0] step,   // s1.30, from pixel to pixel

    // current pixel
    output wire [NORMAL_BITS-1:0] value,    // s1.30, at the centre of the pixel
    output wire                   overflow  // the value has left the word since the first pixel
);

  localparam SIGN = NORMAL_BITS - 1;
  localparam LOW_BITS = NORMAL_BITS / 2;
  localparam HIGH_BITS = NORMAL_BITS - LOW_BITS;

  // The low half is computed one pixel ahead, so that its carry is in a register when the high half
  // is added: no carry chain is longer than half the word.
  reg [NORMAL_BITS-1:0] step_held;
  reg [LOW_BITS-1:0] low;       // of the current pixel
  reg [LOW_BITS-1:0] low_next;  // of the next pixel
  reg carry_next;               // carry of the addition that gave low_next
  reg [HIGH_BITS-1:0] high;     // of the current pixel

  // Both sums are formed, for a load and for a step; `load` arrives late and selects one of them.
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

  // ---- overflow: detected one cycle after the addition, which takes a whole cycle ----
  reg stepped;        // the value is a sum, not a start
  reg sign_before;    // sign of the value before the addition
  reg overflow_held;  // overflow of an earlier addition in the same span
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
