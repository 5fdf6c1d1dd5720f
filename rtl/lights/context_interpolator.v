// SPDX-License-Identifier: MIT
// context_interpolator: one component of the normal along a span, for several lights in turns: a
// linear_interpolator with a context for each turn.
// A turn that leaves writes its successor, one step further, to its context. The next turn of the
// same number reads it there, or, if there is one turn only, takes it directly. A build that never
// has more than one turn has a linear_interpolator without contexts.
// The values are exact: nothing is rounded.
// Latency: 1 cycle from `load` to the first value of the span.
// Throughput: one value per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"

module context_interpolator #(
    parameter NORMAL_BITS = `PHONG_NORMAL_BITS,
    parameter TURN_BITS   = `PHONG_TURN_BITS,
    parameter TURNS       = `PHONG_TURNS  // contexts
) (
    input wire clk,

    // control; `load` acts only together with `advance`
    input wire                 single,     // held for a frame; 1: there is one turn
    input wire                 advance,    // 1: move to the next turn
    input wire                 load,       // 1: the next turn starts from `start`
    input wire                 valid,      // 1: the current turn leaves
    input wire [TURN_BITS-1:0] turn,       // number of the current turn
    input wire [TURN_BITS-1:0] next_turn,

    // offered record
    input wire [NORMAL_BITS-1:0] start,  // s1.30, at the centre of the first pixel
    input wire [NORMAL_BITS-1:0] step,   // s1.30, from pixel to pixel

    // current turn
    output wire [NORMAL_BITS-1:0] value,    // s1.30, at the centre of the pixel
    output wire                   overflow  // the value has left the word since the first pixel
);

  generate
    if (TURNS > 1) begin : gen_contexts
      localparam SIGN = NORMAL_BITS - 1;
      localparam LOW_BITS = NORMAL_BITS / 2;
      localparam HIGH_BITS = NORMAL_BITS - LOW_BITS;
      // {overflow and sign of the value before, step, high, carry, low half one pixel ahead, low}
      localparam CONTEXT_BITS = 2 + 2 * NORMAL_BITS + 1 + LOW_BITS;

      // As in linear_interpolator the low half is computed one pixel ahead, so that no carry chain is
      // longer than half the word.
      reg [NORMAL_BITS-1:0] step_held;
      reg [LOW_BITS-1:0] low;       // of the current pixel
      reg [LOW_BITS-1:0] low_next;  // of the next pixel
      reg carry_next;               // carry of the addition that gave low_next
      reg [HIGH_BITS-1:0] high;     // of the current pixel
      reg stepped;                  // the value is a sum, not a start
      reg sign_before;              // sign of the value before the addition
      reg overflow_held;            // overflow of an earlier addition in the same span

      wire wrapped = stepped & (sign_before == step_held[SIGN]) & (value[SIGN] != sign_before);

      assign value = {high, low};
      assign overflow = overflow_held | wrapped;

      // ---- successor of the current turn ----
      wire [LOW_BITS:0] low_stepped = {1'b0, low_next} + {1'b0, step_held[LOW_BITS-1:0]};
      wire [HIGH_BITS-1:0] high_sum =
          high + step_held[SIGN:LOW_BITS] + {{HIGH_BITS - 1{1'b0}}, carry_next};
      wire [CONTEXT_BITS-1:0] successor =
          {overflow, value[SIGN], step_held, high_sum, low_stepped, low_next};
      wire [CONTEXT_BITS-1:0] kept;

      lut_ram #(
          .ADDRESS_BITS(TURN_BITS),
          .WORD_BITS(CONTEXT_BITS)
      ) u_contexts (
          .clk(clk),
          .write_enable(valid),
          .write_address(turn),
          .write_word(successor),
          .address(next_turn),
          .word(kept)
      );

      // ---- next turn ----
      wire [LOW_BITS:0] low_loaded = {1'b0, start[LOW_BITS-1:0]} + {1'b0, step[LOW_BITS-1:0]};
      wire [CONTEXT_BITS-1:0] loaded =
          {1'b0, start[SIGN], step, start[SIGN:LOW_BITS], low_loaded, start[LOW_BITS-1:0]};

      always @(posedge clk) begin
        if (advance) begin
          {overflow_held, sign_before, step_held, high, carry_next, low_next, low} <=
              load ? loaded : single ? successor : kept;
          stepped <= ~load;
        end
      end
    end else begin : gen_one_context
      linear_interpolator #(
          .NORMAL_BITS(NORMAL_BITS)
      ) u_interpolator (
          .clk(clk),
          .advance(advance),
          .load(load),
          .start(start),
          .step(step),
          .value(value),
          .overflow(overflow)
      );

      wire unused = &{1'b0, single, valid, turn, next_turn};
    end
  endgenerate

endmodule

`default_nettype wire
