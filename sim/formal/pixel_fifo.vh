// SPDX-License-Identifier: MIT
// Properties of pixel_fifo, inserted before its `endmodule`.
// Any one pixel may be followed, so what holds for the followed pixel holds for all: exactly the
// pixels that entered before it leave before it, and its colour is the one that was at the inputs
// LATENCY cycles after it entered. The datapath is no part of this.
// Signals of the module in use: in_flight, place_slot, colour_slot, read_slot, credits, filled, and
// the two memories.

  localparam F_BITS = COUNT_BITS + 1;
  localparam F_AGE_BITS = $clog2(LATENCY + 2);
  localparam [F_BITS-1:0] F_SLOTS = SLOTS;
  localparam [F_AGE_BITS-1:0] F_SHOWN = LATENCY + 1;  // least age at the output
  localparam F_PLACE_BITS = 2 * COORDINATE_BITS + 1;

  // ---- assumed: reset comes first, and pixels only with credit (a_credit of span_walker) ----
  reg f_past = 1'b0;
  always @(posedge clk) f_past <= 1'b1;
  always @(*) begin
    if (!f_past) assume (reset);
    assume (!pixel_valid || credit);
  end

  // ---- counts at the ports; how many pixels entered before the one at each pipeline stage ----
  reg [F_BITS-1:0] f_inside;          // pixels in the module
  reg [F_BITS-1:0] f_entered;         // pixels that have entered, modulo 2^F_BITS
  reg [F_BITS*LATENCY-1:0] f_before;  // f_entered of the last LATENCY cycles
  wire f_leaves = out_valid & out_ready;
  wire [F_BITS-1:0] f_completed = f_before[F_BITS*(LATENCY-1)+:F_BITS];
  wire [F_BITS-1:0] f_filled = filled;
  wire [F_BITS-1:0] f_used = F_SLOTS - credits;
  wire [F_BITS-1:0] f_popped = f_entered - f_used;

  always @(posedge clk) begin
    if (reset) begin
      f_inside <= 0;
      f_entered <= 0;
      f_before <= 0;
    end else begin
      f_inside <= f_inside + pixel_valid - f_leaves;
      f_entered <= f_entered + pixel_valid;
      f_before <= {f_before[F_BITS*(LATENCY-1)-1:0], f_entered};
    end
  end

  // ---- the followed pixel: any one, once ----
  (* anyseq *) wire f_pick;
  reg f_followed = 1'b0;
  reg [F_BITS-1:0] f_ahead;        // pixels that leave before it
  reg [F_AGE_BITS-1:0] f_age;      // cycles since it entered, saturated at F_SHOWN
  reg [F_BITS-1:0] f_number;       // f_entered when it entered
  reg [SLOT_BITS-1:0] f_slot;
  reg [F_PLACE_BITS-1:0] f_place;  // {last, y, x}
  reg [3*COLOUR_BITS-1:0] f_colour;

  always @(posedge clk) begin
    if (f_followed) begin
      f_ahead <= f_ahead - f_leaves;
      if (f_age != F_SHOWN) f_age <= f_age + 1'b1;
      if (f_age == LATENCY - 1) f_colour <= {red, green, blue};
      if (reset || (f_leaves && f_ahead == 0)) f_followed <= 1'b0;
    end else if (f_pick && pixel_valid && !reset) begin
      f_followed <= 1'b1;
      f_ahead <= f_inside - f_leaves;
      f_age <= 0;
      f_number <= f_entered;
      f_slot <= place_slot;
      f_place <= {pixel_last, pixel_y, pixel_x};
    end
  end

  // ---- the previous cycle ----
  reg f_stalled, f_was_ready;
  reg [F_PLACE_BITS+3*COLOUR_BITS-1:0] f_out;
  always @(posedge clk) begin
    f_stalled <= out_valid & ~out_ready & ~reset;
    f_was_ready <= out_ready & ~reset;
    f_out <= {out_last, out_data};
  end

  // ---- the properties ----
  wire f_here = f_followed && f_ahead == 0;
  always @(*) begin
    if (f_past) begin
      a_no_overflow : assert (f_inside <= F_SLOTS + 1'b1);
      a_nothing_from_nowhere : assert (!out_valid || f_inside != 0);
      a_stable_valid : assert (!f_stalled || out_valid);
      a_stable_data : assert (!f_stalled || {out_last, out_data} == f_out);
      a_order_and_place : assert (!(f_here && out_valid) ||
          {out_last, out_data[F_PLACE_BITS+3*COLOUR_BITS-2:3*COLOUR_BITS]} == f_place);
      a_colour : assert (!(f_here && out_valid) || out_data[3*COLOUR_BITS-1:0] == f_colour);
      a_not_early : assert (!(f_here && out_valid) || f_age == F_SHOWN);
      a_not_late : assert (!(f_here && f_age == F_SHOWN) || out_valid);
      a_full_rate : assert (!f_was_ready || credit);
      c_stall : cover (f_stalled && f_here && credits == 0);
    end
  end

`ifndef F_BROKEN
  // ---- invariants that make the properties inductive ----
  function [SLOT_BITS:0] f_distance(input [SLOT_BITS-1:0] from, input [SLOT_BITS-1:0] to);
    f_distance = to >= from ? to - from : to + SLOTS - from;
  endfunction

  wire [F_BITS-1:0] f_position = f_number - f_popped;  // in the queue of slots; -1: at the output
  wire f_at_output = &f_position;
  wire f_has_colour = f_age >= LATENCY;

  always @(*) begin
    if (f_past) begin
      i_credits : assert (credits <= SLOTS && (!credit || credits != 0));
      i_sum : assert (f_entered - f_completed + f_filled == f_used && f_filled <= f_used);
      i_inside : assert (f_inside == f_used + out_valid);
      i_slots : assert (place_slot < SLOTS && colour_slot < SLOTS && read_slot < SLOTS);
      i_place : assert (f_distance(colour_slot, place_slot) == f_used - f_filled);
      i_colour : assert (f_distance(read_slot, colour_slot) == (filled == SLOTS ? 0 : filled));
      if (f_followed) begin
        i_age : assert (f_age <= F_SHOWN);
        if (f_at_output) begin
          i_output : assert (out_valid && f_ahead == 0 && f_age == F_SHOWN);
        end else begin
          i_position : assert (f_position < f_used && f_ahead == f_position + out_valid);
          i_coloured : assert (f_has_colour == (f_position < f_filled));
          i_slot : assert (f_slot < SLOTS && f_distance(read_slot, f_slot) == f_position);
          i_ready : assert (f_age != F_SHOWN || f_ahead != 0);
        end
      end
    end
  end

  // One bit per pipeline stage, since the label of an assertion must be unique.
  wire [LATENCY-1:0] f_link, f_younger, f_older, f_stage;
  genvar f_i;
  generate
    for (f_i = 0; f_i < LATENCY; f_i = f_i + 1) begin : gen_f_stage
      localparam [F_BITS-1:0] F_YOUNGER = f_i + 1;
      localparam [F_BITS-1:0] F_OLDER = LATENCY - 1 - f_i;
      wire [F_BITS-1:0] f_mine = f_before[F_BITS*f_i+:F_BITS];
      wire [F_BITS-1:0] f_next;  // of the pixel behind the one in this stage
      if (f_i == 0) assign f_next = f_entered;
      else assign f_next = f_before[F_BITS*(f_i-1)+:F_BITS];
      assign f_link[f_i] = f_mine + in_flight[f_i] == f_next;
      assign f_younger[f_i] = f_entered - f_mine <= F_YOUNGER;
      assign f_older[f_i] = f_mine - f_completed <= F_OLDER;
      assign f_stage[f_i] = !(f_followed && f_age == f_i) ||
          (in_flight[f_i] && f_mine == f_number);
    end
  endgenerate
  always @(*) begin
    if (f_past) begin
      i_link : assert (&f_link);
      i_younger : assert (&f_younger);
      i_older : assert (&f_older);
      i_stage : assert (&f_stage);
    end
  end

  // ---- what the memories hold ----
  wire [BANKS-1:0] f_place_kept, f_colour_kept;
  genvar f_b;
  generate
    for (f_b = 0; f_b < BANKS; f_b = f_b + 1) begin : gen_f_bank
      wire f_other = f_slot[SLOT_BITS-1:4] != f_b;
      assign f_place_kept[f_b] = f_other || gen_bank[f_b].places[f_slot[3:0]] == f_place;
      assign f_colour_kept[f_b] = f_other || gen_bank[f_b].colours[f_slot[3:0]] == f_colour;
    end
  endgenerate
  always @(*) if (f_past) i_some : assert (some == (filled != 0));
  always @(*) begin
    if (f_past && f_followed && !f_at_output) begin
      i_place_kept : assert (&f_place_kept);
      i_colour_kept : assert (!f_has_colour || &f_colour_kept);
    end
  end
`endif
