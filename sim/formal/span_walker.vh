// SPDX-License-Identifier: MIT
// Properties of span_walker, inserted before its `endmodule`.
// A span becomes exactly its pixels, one in every cycle with credit, and the next span starts
// without a gap.
// Signals of the module in use: busy, at_end, walking, next_ends, remaining, last, beyond.

  localparam F_BITS = COORDINATE_BITS + 2;
  localparam [F_BITS-1:0] F_WIDTH = 1 << COORDINATE_BITS;

  reg f_past = 1'b0;
  always @(posedge clk) f_past <= 1'b1;
  always @(*) if (!f_past) assume (reset);

  // ---- the specification ----
  reg f_active;  // a span is active
  // Its pixels that have not left. An empty span has one, and is flagged.
  reg [F_BITS-1:0] f_left;
  reg [COORDINATE_BITS-1:0] f_x, f_y;
  reg [MATERIAL_BITS-1:0] f_material;
  reg f_last;
  reg f_bad;   // the span is empty, or its x leaves the coordinates
  reg f_flag;  // the last pixel of an illegal span left one cycle ago
  wire f_final = f_active & credit & (f_left == 1);
  wire f_free = !f_active | (f_left == 1);  // a span is accepted with the next credit
  wire f_takes = span_valid & span_ready;

  always @(posedge clk) begin
    f_flag <= !reset && f_final && (f_bad || overflow);
    if (reset) f_active <= 1'b0;
    else if (f_takes) f_active <= 1'b1;
    else if (f_final) f_active <= 1'b0;

    if (f_takes) begin
      f_left <= span_length == 0 ? 1 : span_length;
      f_x <= span_x;
      f_y <= span_y;
      f_material <= span_material;
      f_last <= span_last;
      f_bad <= span_length == 0 || span_x + span_length > F_WIDTH;
    end else if (pixel_valid) begin
      f_left <= f_left - 1'b1;
      f_x <= f_x + 1'b1;
    end
  end

  // ---- the properties ----
  always @(*) begin
    if (f_past) begin
      a_credit : assert (!pixel_valid || credit);
      a_no_bubble : assert (pixel_valid == (f_active & credit));
      a_ready : assert (span_ready == (credit & f_free));
      a_place : assert (!f_active || (pixel_x == f_x && pixel_y == f_y));
      a_material : assert (!f_active || pixel_material == f_material);
      a_last : assert (!f_active || pixel_last == (f_last && f_left == 1));
      a_load : assert (load == f_free);
      a_advance : assert (advance == credit);
      a_illegal : assert (illegal_span == f_flag);
      c_illegal : cover (illegal_span);
    end
  end

  // Three spans of one pixel accepted in successive cycles, and a pixel in the next one.
  reg [2:0] f_taken = 3'b000;
  always @(posedge clk) f_taken <= {f_taken[1:0], f_takes & (span_length == 1)};
  always @(*) c_back_to_back : cover (f_past && &f_taken && pixel_valid && !reset);

`ifndef F_BROKEN
  // ---- invariants that make the properties inductive ----
  always @(*) begin
    if (f_past) begin
      i_busy : assert (busy == f_active && at_end == f_free && walking == !at_end);
      if (f_active) begin
        i_left : assert (f_left != 0 && next_ends == (f_left == 2));
        i_remaining : assert (f_left == 1 || remaining == f_left - 1'b1);
        i_last : assert (last == f_last);
        // The wraps of the counter so far, and those to come.
        i_bad : assert (f_bad == (beyond != 0 || pixel_x + f_left > F_WIDTH));
        i_length : assert (f_left < 2 * F_WIDTH && (beyond == 0 || f_bad));
        i_beyond : assert (&beyond ? f_left == 1 : {1'b0, beyond, pixel_x} + f_left < 3 * F_WIDTH);
      end
    end
  end
`endif
