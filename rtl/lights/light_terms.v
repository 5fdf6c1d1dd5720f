// SPDX-License-Identifier: MIT
// light_terms: what one light adds to the colours of a pixel,
//   kd Ld (N.L) + ks Ls W(i) cos(s)^n; nothing where the light does not reach.
// The tables hold the products kd Ld and ks Ls for each turn and material.
// Latency: LATENCY cycles from `cosine` and `lit` (PHONG_LIGHT_TERMS_LATENCY in latency.vh; 3 by
// default).
// Throughput: one result per cycle.
// Reset: none; the tables are undefined until written.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module light_terms #(
    parameter CHANNELS         = `PHONG_CHANNELS,          // 3: red, green, blue; 1: grey
    parameter DIFFUSE          = `PHONG_DIFFUSE,           // 0: the term is left out
    parameter SPECULAR         = `PHONG_SPECULAR,          // 0: the term is left out
    parameter HIGHLIGHT_COLOUR = `PHONG_HIGHLIGHT_COLOUR,  // 0: ks Ls is 1
    parameter TURNS            = `PHONG_TURNS,
    parameter PLACE_BITS       = `PHONG_TURN_BITS + `PHONG_MATERIAL_BITS,
    parameter COEFFICIENT_BITS = `PHONG_COEFFICIENT_BITS,
    parameter COSINE_BITS      = `PHONG_COSINE_BITS,
    parameter PRODUCT_BITS     = `PHONG_WEIGHT_BITS + `PHONG_POWER_BITS,
    parameter HIGHLIGHT_BITS   = HIGHLIGHT_COLOUR ? `PHONG_HIGHLIGHT_BITS : PRODUCT_BITS,
    parameter FRACTION         = `PHONG_WEIGHT_FRACTION + `PHONG_POWER_FRACTION,
    parameter LATENCY          = `PHONG_LIGHT_TERMS_LATENCY
) (
    input wire clk,

    // write port of the tables
    input wire [2:0]                  write_diffuse,    // kd Ld of {blue, green, red}
    input wire [2:0]                  write_highlight,  // ks Ls of {blue, green, red}
    input wire [PLACE_BITS-1:0]       write_address,    // {turn, material}
    input wire [COEFFICIENT_BITS-1:0] write_word,       // u1.16

    // a turn: its place in the tables comes PHONG_LIGHT_TABLE_LATENCY cycles before `cosine`, `lit`
    // and a coloured highlight; a white highlight comes PHONG_MULTIPLIER_LATENCY cycles after them
    input  wire [PLACE_BITS-1:0]          place_early,  // {turn, material}
    input  wire [COSINE_BITS-1:0]         cosine,       // u0.18, N.L = cos(i)
    input  wire                           lit,          // 0: the light does not reach the pixel
    input  wire [HIGHLIGHT_BITS-1:0]      highlight,    // W(i) cos(s)^n, u0.18; white: u1.35
    output wire [CHANNELS*(FRACTION+2)-1:0] terms       // u2.35 each, red in the lowest bits
);

  localparam TERM_BITS = FRACTION + 2;  // two products below 2
  localparam DIFFUSE_BITS = COEFFICIENT_BITS + COSINE_BITS;
  localparam DIFFUSE_SHIFT = FRACTION - `PHONG_COEFFICIENT_FRACTION - `PHONG_COSINE_FRACTION;
  localparam COLOURED_BITS = COEFFICIENT_BITS + `PHONG_HIGHLIGHT_BITS;
  localparam COLOURED_SHIFT = FRACTION - `PHONG_COEFFICIENT_FRACTION - `PHONG_HIGHLIGHT_FRACTION;

  wire lit_p2;

  delay #(
      .BITS  (1),
      .CYCLES(`PHONG_MULTIPLIER_LATENCY)
  ) u_lit (
      .clk(clk),
      .in (lit),
      .out(lit_p2)
  );

  genvar c;
  generate
    for (c = 0; c < CHANNELS; c = c + 1) begin : gen_channel
      wire [TERM_BITS-1:0] diffuse_term, specular_term;
      reg [TERM_BITS-1:0] sum;

      if (DIFFUSE) begin : gen_diffuse
        wire [COEFFICIENT_BITS-1:0] diffuse;
        wire [DIFFUSE_BITS-1:0] product;

        if (TURNS > 1) begin : gen_block
          ram #(
              .ADDRESS_BITS(PLACE_BITS),
              .WORD_BITS(COEFFICIENT_BITS)
          ) u_table (
              .clk(clk),
              .write_enable(write_diffuse[c]),
              .write_address(write_address),
              .write_word(write_word),
              .address(place_early),
              .word(diffuse)
          );
        end else begin : gen_small
          small_ram #(
              .ADDRESS_BITS(PLACE_BITS),
              .WORD_BITS(COEFFICIENT_BITS)
          ) u_table (
              .clk(clk),
              .write_enable(write_diffuse[c]),
              .write_address(write_address),
              .write_word(write_word),
              .address(place_early),
              .word(diffuse)
          );
        end

        multiplier #(
            .A_BITS  (COEFFICIENT_BITS),
            .B_BITS  (COSINE_BITS),
            .A_SIGNED(0),
            .B_SIGNED(0)
        ) u_diffuse (
            .clk(clk),
            .a(diffuse),
            .b(cosine & {COSINE_BITS{lit}}),
            .product(product)
        );

        assign diffuse_term =
            {{TERM_BITS - DIFFUSE_BITS - DIFFUSE_SHIFT{1'b0}}, product, {DIFFUSE_SHIFT{1'b0}}};
      end else begin : gen_no_diffuse
        assign diffuse_term = {TERM_BITS{1'b0}};
      end

      if (SPECULAR && HIGHLIGHT_COLOUR) begin : gen_coloured
        wire [COEFFICIENT_BITS-1:0] colour;
        wire [COLOURED_BITS-1:0] product;

        if (TURNS > 1) begin : gen_block
          ram #(
              .ADDRESS_BITS(PLACE_BITS),
              .WORD_BITS(COEFFICIENT_BITS)
          ) u_table (
              .clk(clk),
              .write_enable(write_highlight[c]),
              .write_address(write_address),
              .write_word(write_word),
              .address(place_early),
              .word(colour)
          );
        end else begin : gen_small
          small_ram #(
              .ADDRESS_BITS(PLACE_BITS),
              .WORD_BITS(COEFFICIENT_BITS)
          ) u_table (
              .clk(clk),
              .write_enable(write_highlight[c]),
              .write_address(write_address),
              .write_word(write_word),
              .address(place_early),
              .word(colour)
          );
        end

        multiplier #(
            .A_BITS  (COEFFICIENT_BITS),
            .B_BITS  (HIGHLIGHT_BITS),
            .A_SIGNED(0),
            .B_SIGNED(0)
        ) u_coloured (
            .clk(clk),
            .a(colour),
            .b(highlight & {HIGHLIGHT_BITS{lit}}),
            .product(product)
        );

        assign specular_term =
            {{TERM_BITS - COLOURED_BITS - COLOURED_SHIFT{1'b0}}, product, {COLOURED_SHIFT{1'b0}}};
      end else if (SPECULAR) begin : gen_white
        assign specular_term =
            {{TERM_BITS - HIGHLIGHT_BITS{1'b0}}, highlight & {HIGHLIGHT_BITS{lit_p2}}};
      end else begin : gen_no_specular
        assign specular_term = {TERM_BITS{1'b0}};
      end

      always @(posedge clk) sum <= diffuse_term + specular_term;

      assign terms[c*TERM_BITS+:TERM_BITS] = sum;
    end
  endgenerate

  wire unused = &{1'b0, write_diffuse, write_highlight, write_address, write_word, place_early,
                  cosine, highlight, lit_p2};

endmodule

`default_nettype wire
