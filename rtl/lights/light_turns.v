// SPDX-License-Identifier: MIT
// light_turns: gives each pixel of span_walker its turns, one for each record of its span, and loads
// the records while the first pixel of the span takes its turns.
// A span comes in as many records as a pixel takes turns. A record holds the values of the lights of
// one turn. Place, length and material are read from the first record of a span, the mark of the
// frame's last span from the last one.
// The walker has credit in the last turn of a pixel only, so that it moves once per pixel. A turn
// whose record has not come yet waits; it holds nothing up before it.
// Latency: 1 cycle from an accepted record to its turn.
// Throughput: one turn per cycle while there is credit; no gap between pixels or spans.
// Reset: synchronous; drops the active span.
`default_nettype none
`include "phong_config.vh"

module light_turns #(
    parameter TURN_BITS = `PHONG_TURN_BITS
) (
    input wire clk,
    input wire reset,  // synchronous

    input wire [TURN_BITS-1:0] last_turn,  // register, held for a frame: turns of a pixel minus 1

    // offered record; accepted in a cycle in which record_valid and record_ready are 1
    input  wire record_valid,
    output wire record_ready,  // does not depend on record_valid
    input  wire record_last,   // the record is the last of the frame

    // span_walker, to which the record goes as a span
    output wire walker_credit,    // 1: the pixel may leave
    input  wire walker_ready,     // 1: the first record of a span is accepted
    input  wire walker_load,      // 1: the pixel ends its span, or no span is active
    output wire walker_overflow,  // a component has left its word, in this turn or one before

    // interpolators; `load` acts only together with `advance`
    input  wire                 credit,    // 1: a turn may leave
    output wire                 advance,   // 1: move to the next turn; 0: hold the current one
    output wire                 load,      // 1: the next turn starts from the offered record
    input  wire                 overflow,  // a component of the current turn has left its word
    output reg  [TURN_BITS-1:0] turn,      // number of the current turn
    output wire [TURN_BITS-1:0] next_turn,

    // current turn
    output wire turn_valid,  // the turn leaves; with the last turn of a pixel the pixel leaves
    output wire pixel_last   // its pixel is the last of the frame
);

  reg at_last;          // the current turn is the last of its pixel, or no span is active
  reg first_pixel;      // the pixel is the first of its span, whose other turns load
  reg waits;            // the record of the next turn has not come: the current turn has left
  reg last;             // the latest record was marked as the last of the frame
  reg overflow_before;  // a component has left its word in an earlier turn of this pixel

  assign advance = credit;
  assign load = at_last ? walker_load : first_pixel;
  assign next_turn = at_last ? {TURN_BITS{1'b0}} : turn + 1'b1;
  assign turn_valid = credit & ~waits;
  assign walker_credit = credit & at_last;
  assign record_ready = at_last ? walker_ready : first_pixel & credit;
  assign walker_overflow = overflow | overflow_before;
  assign pixel_last = last & walker_load;

  always @(posedge clk) begin
    if (record_valid & record_ready) last <= record_last;

    if (reset) begin
      at_last <= 1'b1;
      waits <= 1'b1;
      overflow_before <= 1'b0;
    end else if (credit) begin
      waits <= load & ~record_valid;
      if (~load | record_valid) begin
        turn <= next_turn;
        at_last <= next_turn == last_turn;
        if (at_last) first_pixel <= walker_load;
      end
      if (~waits) overflow_before <= ~at_last & walker_overflow;
    end
  end

endmodule

`default_nettype wire
