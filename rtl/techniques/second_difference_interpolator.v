// SPDX-License-Identifier: MIT
// second_difference_interpolator: one component of a quadratic normal along a span by forward
// differences of second order (van Overveld and Wyvill 1997, Vlachos et al. 2001: the normal is
// quadratic over a triangle, and so a parabola along a span). Three in parallel interpolate a normal.
// At a load the value is `start`; `step` and `bend` are latched. At any other advance the held step
// is added to the value, and the bend to the step. The sums have the fraction bits of the bend and
// are exact. `value` is the sum cut to the fraction bits of `start`; its last bit is also 1 if a bit
// that is cut off is 1, so that `value` is zero or negative exactly if the sum is.
// Latency: 1 cycle from `load` to the first value of the span.
// Throughput: one value per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"

module second_difference_interpolator #(
    parameter NORMAL_BITS = `PHONG_NORMAL_BITS,
    parameter EXTRA_BITS  = `PHONG_BEND_FRACTION_BITS  // of `bend` beyond `start`; at least 4 less
) (
    input wire clk,

    // control; `load` acts only together with `advance`
    input wire advance,  // 1: move to the next pixel
    input wire load,     // 1: the current pixel ends its span; the next one starts from `start`

    // offered span
    input wire [           NORMAL_BITS-1:0] start,  // s1.30, at the centre of the first pixel
    input wire [           NORMAL_BITS-1:0] step,   // s1.30, second pixel minus first pixel
    input wire [NORMAL_BITS+EXTRA_BITS-1:0] bend,   // s1.42, growth of that difference per pixel

    // current pixel
    output wire [NORMAL_BITS-1:0] value,    // s1.30, at the centre of the pixel
    output wire                   overflow  // value or step has left its word since the first pixel
);

  localparam BITS = NORMAL_BITS + EXTRA_BITS;
  localparam SIGN = BITS - 1;
  localparam LOW_BITS = BITS / 2;
  localparam HIGH_BITS = BITS - LOW_BITS;
  localparam KEPT_BITS = LOW_BITS - EXTRA_BITS;  // of the low half, in `value`

  wire [BITS-1:0] start_wide = {start, {EXTRA_BITS{1'b0}}};
  wire [BITS-1:0] step_wide = {step, {EXTRA_BITS{1'b0}}};

  // As in linear_interpolator, low halves are computed ahead of high halves: no carry chain is longer
  // than half the word. The low half of a sum is one pixel ahead of its high half, and that of the
  // step one more, because the sum needs it.
  reg [BITS-1:0] bend_held;
  reg [KEPT_BITS-1:0] low;         // of the value, for the current pixel, without what is cut off
  reg [LOW_BITS-1:0] low_next;     // of the value, for the next pixel
  reg carry_next;                  // carry of the addition that gave low_next
  reg [HIGH_BITS-1:0] high;        // of the value, for the current pixel
  reg [LOW_BITS-1:0] step_low;     // of the step from the next pixel to the one after it
  reg step_carry;                  // carry of the addition that gave step_low
  reg [HIGH_BITS-1:0] step_high;   // of the step from the current pixel to the next

  // All sums are formed, for a load and for a step; `load` arrives late and selects.
  wire [LOW_BITS:0] low_loaded = {1'b0, start_wide[LOW_BITS-1:0]} + {1'b0, step_wide[LOW_BITS-1:0]};
  wire [LOW_BITS:0] low_stepped = {1'b0, low_next} + {1'b0, step_low};
  wire [HIGH_BITS-1:0] high_sum = high + step_high + {{HIGH_BITS - 1{1'b0}}, carry_next};
  wire [LOW_BITS:0] bent_loaded = {1'b0, step_wide[LOW_BITS-1:0]} + {1'b0, bend[LOW_BITS-1:0]};
  wire [LOW_BITS:0] bent_stepped = {1'b0, step_low} + {1'b0, bend_held[LOW_BITS-1:0]};
  wire [HIGH_BITS-1:0] step_sum =
      step_high + bend_held[SIGN:LOW_BITS] + {{HIGH_BITS - 1{1'b0}}, step_carry};

  wire [KEPT_BITS-1:0] low_cut = low_next[LOW_BITS-1:EXTRA_BITS];
  wire jam = |low_next[EXTRA_BITS-1:0];  // a bit that is cut off is 1

  assign value = {high, low};

  always @(posedge clk) begin
    if (advance) begin
      if (load) bend_held <= bend;
      low <= load ? start[KEPT_BITS-1:0] : low_cut | {{KEPT_BITS - 1{1'b0}}, jam};
      {carry_next, low_next} <= load ? low_loaded : low_stepped;
      high <= load ? start_wide[SIGN:LOW_BITS] : high_sum;
      {step_carry, step_low} <= load ? bent_loaded : bent_stepped;
      step_high <= load ? step_wide[SIGN:LOW_BITS] : step_sum;
    end
  end

  // ---- overflow: detected one cycle after the addition, which takes a whole cycle ----
  // A step counts only if it leads to a pixel of the span, which is one pixel later.
  reg stepped;           // value and step are sums, not those of the load
  reg sign_before;       // sign of the value before the addition
  reg step_sign_before;  // sign of the step before the addition
  reg steep_before;      // the step that led to the value had left its word
  reg overflow_held;     // overflow of an earlier addition in the same span
  wire step_sign = step_high[HIGH_BITS-1];
  wire sign = value[NORMAL_BITS-1];
  wire wrapped = stepped & (sign_before == step_sign_before) & (sign != sign_before);
  wire steep = stepped & (step_sign_before == bend_held[SIGN]) & (step_sign != step_sign_before);

  assign overflow = overflow_held | wrapped | steep_before;

  always @(posedge clk) begin
    if (advance) begin
      stepped <= ~load;
      sign_before <= sign;
      step_sign_before <= step_sign;
      steep_before <= ~load & steep;
      overflow_held <= ~load & overflow;
    end
  end

endmodule

`default_nettype wire
