// SPDX-License-Identifier: MIT
// span_word: a word that a span brings for each turn and that holds for all its pixels, beside the
// interpolators: the half vector of a light at a place.
// Latency: 1 cycle from `load` to the first pixel of the span.
// Throughput: one word per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"

module span_word #(
    parameter BITS      = 2 * `PHONG_HALF_VECTOR_BITS,  // width of the word
    parameter TURNS     = `PHONG_TURNS,                 // of the lights of a pixel
    parameter TURN_BITS = `PHONG_TURN_BITS
) (
    input wire clk,

    // control; `load` acts only together with `advance`
    input wire                 single,     // held for a frame; 1: there is one turn
    input wire                 advance,    // 1: move to the next turn
    input wire                 load,       // 1: the next turn starts with `offered`
    input wire                 valid,      // 1: the current turn leaves
    input wire [TURN_BITS-1:0] turn,       // number of the current turn
    input wire [TURN_BITS-1:0] next_turn,

    input  wire [BITS-1:0] offered,  // of the offered record, any format
    output wire [BITS-1:0] word      // of the current turn
);

  reg [BITS-1:0] held;

  assign word = held;

  generate
    if (TURNS > 1) begin : gen_contexts
      wire [BITS-1:0] kept;

      lut_ram #(
          .ADDRESS_BITS(TURN_BITS),
          .WORD_BITS(BITS)
      ) u_words (
          .clk(clk),
          .write_enable(valid),
          .write_address(turn),
          .write_word(held),
          .address(next_turn),
          .word(kept)
      );

      always @(posedge clk) begin
        if (advance) held <= load ? offered : single ? held : kept;
      end
    end else begin : gen_one_context
      always @(posedge clk) if (advance & load) held <= offered;

      wire unused = &{1'b0, single, valid, turn, next_turn};
    end
  endgenerate

endmodule

`default_nettype wire
