// SPDX-License-Identifier: MIT
// Properties of phong_pipeline, inserted before its `endmodule`. The datapath is cut away: any
// colour may come out of it.
// Spans at one port are pixels at the other, in order; the first pixel comes after a constant time.
// That the modules do their part is proven of each without a bound; these properties are about the
// wiring.

  localparam F_PIXEL_BITS = 2 * COORDINATE_BITS + 3 * COLOUR_BITS;
  localparam F_FIRST = `PHONG_PIXEL_LATENCY + 3;  // cycles from a span to its first pixel
  localparam F_WORD = `PHONG_NORMAL_BITS;         // of a component in span_values
  localparam F_BITS = COORDINATE_BITS + 4;
  localparam F_PLACE_BITS = 2 * COORDINATE_BITS + 1;
  localparam F_WIDE = F_WORD + COORDINATE_BITS + 2;
  localparam signed [F_WIDE-1:0] F_MAX = (1 << (F_WORD - 1)) - 1;
  localparam signed [F_WIDE-1:0] F_MIN = -(1 << (F_WORD - 1));

  reg f_past = 1'b0;
  always @(posedge clk) f_past <= 1'b1;
  always @(*) if (!f_past) assume (reset);

  wire f_takes = s_axis_tvalid & s_axis_tready;
  wire f_leaves = m_axis_tvalid & m_axis_tready;
  wire [COORDINATE_BITS:0] f_pixels = span_length == 0 ? 1 : span_length;

  // ---- pixels owed: accepted with a span, not yet at the output; any one of them is followed ----
  // Assumed: no span comes that would let the count f_owed overflow.
  reg [F_BITS-1:0] f_owed;
  always @(*) if (f_past) assume (!f_takes || !f_owed[F_BITS-1]);
  (* anyconst *) wire [COORDINATE_BITS:0] f_k;  // number of the followed pixel in its span
  (* anyseq *) wire f_pick;
  reg f_followed = 1'b0;
  reg [F_BITS-1:0] f_ahead;        // pixels that leave before the followed one
  reg [F_PLACE_BITS-1:0] f_place;  // {last, y, x} of the followed one

  always @(posedge clk) begin
    f_owed <= f_owed + (f_takes ? f_pixels : 0) - f_leaves;
    if (f_followed) begin
      f_ahead <= f_ahead - f_leaves;
      if (f_leaves && f_ahead == 0) f_followed <= 1'b0;
    end else if (f_takes && f_pick && f_k < f_pixels) begin
      f_followed <= 1'b1;
      f_ahead <= f_owed - f_leaves + f_k;
      f_place[F_PLACE_BITS-1] <= s_axis_tlast && f_k == f_pixels - 1'b1;
      f_place[2*COORDINATE_BITS-1:COORDINATE_BITS] <= span_y;
      f_place[COORDINATE_BITS-1:0] <= span_x + f_k;
    end
    if (reset) begin
      f_owed <= 0;
      f_followed <= 1'b0;
    end
  end

  // ---- exact components ----
  reg f_active;
  reg [COORDINATE_BITS:0] f_left;  // pixels of the span that have not left the walker
  reg f_bad, f_flag;               // the span is illegal by its x or length; illegal_span is due
  reg signed [F_WIDE-1:0] f_x, f_y, f_z;
  reg signed [F_WORD-1:0] f_step_x, f_step_y, f_step_z;
  // The normal at the interpolators is zero. Its flag is due PHONG_ZERO_NORMAL_LATENCY cycles
  // later.
  wire f_zero = pixel_valid && f_x[F_WORD-1:0] == 0 && f_y[F_WORD-1:0] == 0 &&
      f_z[F_WORD-1:0] == 0;
  reg [`PHONG_ZERO_NORMAL_LATENCY-1:0] f_zeros;
  always @(posedge clk) f_zeros <= reset ? 0 : {f_zeros, f_zero};
  wire f_outside = f_x > F_MAX || f_x < F_MIN || f_y > F_MAX || f_y < F_MIN ||
      f_z > F_MAX || f_z < F_MIN;

  always @(posedge clk) begin
    f_flag <= !reset && pixel_valid && f_left == 1 && (f_bad || f_outside);
    if (f_takes) begin
      f_left <= f_pixels;
      f_bad <= span_length == 0 || {2'b00, span_x} + span_length > 1 << COORDINATE_BITS;
      f_x <= $signed(span_values[0*F_WORD+:F_WORD]);
      f_y <= $signed(span_values[1*F_WORD+:F_WORD]);
      f_z <= $signed(span_values[2*F_WORD+:F_WORD]);
      f_step_x <= span_values[3*F_WORD+:F_WORD];
      f_step_y <= span_values[4*F_WORD+:F_WORD];
      f_step_z <= span_values[5*F_WORD+:F_WORD];
    end else if (pixel_valid) begin
      f_left <= f_left - 1'b1;
      f_x <= f_x + f_step_x;
      f_y <= f_y + f_step_y;
      f_z <= f_z + f_step_z;
    end
  end

  // ---- time ----
  reg f_timed = 1'b0;  // f_time cycles ago a span was accepted while no pixel was owed
  reg [7:0] f_time;
  reg [7:0] f_flow;    // cycles in a row with a span offered and the output ready
  reg f_single;        // since reset all spans had one pixel and the output was ready
  reg [2:0] f_run;     // pixels that left in successive cycles
  reg f_stalled;
  reg [F_PIXEL_BITS:0] f_out;

  always @(posedge clk) begin
    if (reset || (f_timed && f_time == F_FIRST)) f_timed <= 1'b0;
    else if (f_takes && f_owed == 0) f_timed <= 1'b1;
    f_time <= f_timed ? f_time + 1'b1 : 1;
    if (reset || !s_axis_tvalid || !m_axis_tready) f_flow <= 0;
    else if (f_flow != F_FIRST + 1) f_flow <= f_flow + 1'b1;
    f_single <= reset || (f_single && m_axis_tready && (!f_takes || span_length == 1));
    f_run <= !reset && f_leaves ? f_run + (f_run != 7) : 0;
    f_stalled <= m_axis_tvalid & ~m_axis_tready & ~reset;
    f_out <= {m_axis_tlast, m_axis_tdata};
  end

`ifdef F_COVER
  // A cover statement needs one example; these assumptions give it, and shorten the search.
  always @(*) if (f_past) assume (!reset && f_single && s_axis_tvalid && m_axis_tready);
`endif

  // ---- the properties ----
  always @(*) begin
    if (f_past) begin
      a_order_and_place : assert (!(f_followed && f_ahead == 0 && m_axis_tvalid) ||
          {m_axis_tlast, m_axis_tdata[F_PIXEL_BITS-1:3*COLOUR_BITS]} == f_place);
      a_nothing_from_nowhere : assert (!m_axis_tvalid || f_owed != 0);
      a_stable : assert (!f_stalled || (m_axis_tvalid && {m_axis_tlast, m_axis_tdata} == f_out));
      a_latency : assert (!f_timed || m_axis_tvalid == (f_time == F_FIRST));
      a_full_rate : assert (f_flow != F_FIRST + 1 || m_axis_tvalid);
      a_zero : assert (zero_normal == f_zeros[`PHONG_ZERO_NORMAL_LATENCY-1]);
      a_illegal : assert (illegal_span == f_flag);
      c_back_to_back : cover (f_single && f_run == 3);
    end
  end
