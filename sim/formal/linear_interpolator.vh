// SPDX-License-Identifier: MIT
// Properties of linear_interpolator, inserted before its `endmodule`.
// f_exact is start + k * step in a word that no span can leave; k is the number of steps since the
// load. f_exact moves in one direction only, so it is in the format at all pixels of a span if and
// only if it is at the first and at the last: such a span is legal.
// Signals of the module in use: step_held, low, low_next, carry_next, stepped, sign_before,
// overflow_held.

  localparam F_STEP_BITS = `PHONG_COORDINATE_BITS + 1;  // of k, which is below 2^13
  localparam F_BITS = NORMAL_BITS + F_STEP_BITS + 1;
  localparam signed [F_BITS-1:0] F_MAX = (1 << (NORMAL_BITS - 1)) - 1;
  localparam signed [F_BITS-1:0] F_MIN = -(1 << (NORMAL_BITS - 1));

  reg f_loaded = 1'b0;  // a span has been loaded
  reg signed [F_BITS-1:0] f_exact;
  reg signed [NORMAL_BITS-1:0] f_step;
  reg [F_STEP_BITS-1:0] f_k;

  always @(posedge clk) begin
    if (advance && load) begin
      f_loaded <= 1'b1;
      f_exact <= $signed(start);
      f_step <= step;
      f_k <= 0;
    end else if (advance) begin
      f_exact <= f_exact + f_step;
      f_k <= f_k + 1'b1;
    end
  end

  // Assumed: a span has one step less than pixels, and its length has F_STEP_BITS bits. span_walker
  // guarantees this (its properties a_advance and a_load).
  always @(*) assume (!(f_loaded && advance && !load) || f_k < (1 << F_STEP_BITS) - 2);

  // The exact value one step ago.
  wire signed [F_BITS-1:0] f_before = stepped ? f_exact - f_step : 0;
  wire f_before_in_format = f_before >= F_MIN && f_before <= F_MAX;
  wire f_in_format = f_exact >= F_MIN && f_exact <= F_MAX;
  always @(*) begin
    if (f_loaded) begin
      a_no_wrap : assert (overflow || $signed(value) == f_exact);
      a_flagged : assert (overflow == !f_in_format);
      c_flagged : cover (overflow && f_k == 3);
      c_limit : cover (f_exact == F_MAX && f_k == 3);
    end
  end

`ifndef F_BROKEN
  // ---- invariants that make the properties inductive ----
  wire signed [F_BITS-1:0] f_bound = $signed({1'b0, f_k} + 1'b1) <<< (NORMAL_BITS - 1);
  always @(*) begin
    if (f_loaded) begin
      i_step : assert (f_step == step_held);
      i_value : assert (value == f_exact[NORMAL_BITS-1:0]);
      i_low : assert ({carry_next, low_next} == {1'b0, low} + {1'b0, step_held[LOW_BITS-1:0]});
      i_overflow_held : assert (!overflow_held || (stepped && !f_in_format));
      i_before : assert (!stepped || sign_before == f_before[NORMAL_BITS-1]);
      i_stepped : assert (stepped == (f_k != 0) && overflow_held == !f_before_in_format);
      i_one_way : assert (f_in_format || (f_exact > F_MAX ? f_step > 0 : f_step < 0));
      i_bound : assert (f_exact >= -f_bound && f_exact <= f_bound);
    end
  end
`endif
