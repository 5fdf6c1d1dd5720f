// SPDX-License-Identifier: MIT
// flat_unit: flat shading: one intensity for all pixels of a span, that of its face (Phong 1975,
// eq. (1) and Fig. 1). Nothing is interpolated.
// Latency: LATENCY cycles from a pixel of span_walker to its colour (PHONG_INTENSITY_CODE_LATENCY
// in latency.vh; 3 by default).
// Throughput: one pixel per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module flat_unit (
    input wire clk,

    // control from span_walker; `load` acts only together with `advance`
    input wire advance,  // 1: move to the next pixel
    input wire load,     // 1: the current pixel ends its span; the next one starts from `values`

    // offered span
    input wire [`PHONG_CHANNELS*`PHONG_NORMAL_BITS-1:0] values,  // {blue, green, red}, s1.30 each

    // colour of a pixel
    output wire [`PHONG_COLOUR_BITS-1:0] red,    // code, 0 to 255
    output wire [`PHONG_COLOUR_BITS-1:0] green,  // code, 0 to 255
    output wire [`PHONG_COLOUR_BITS-1:0] blue    // code, 0 to 255
);

  localparam CHANNELS    = `PHONG_CHANNELS;  // 3: red, green, blue; 1: grey
  localparam VALUE_BITS  = `PHONG_NORMAL_BITS;
  localparam COLOUR_BITS = `PHONG_COLOUR_BITS;
  localparam LATENCY     = `PHONG_INTENSITY_CODE_LATENCY;

  reg  [ CHANNELS*VALUE_BITS-1:0] held;  // s1.30, intensities of the current span
  wire [CHANNELS*COLOUR_BITS-1:0] colour;

  always @(posedge clk) if (advance & load) held <= values;

  genvar c;
  generate
    for (c = 0; c < CHANNELS; c = c + 1) begin : gen_channel
      intensity_code u_code (
          .clk(clk),
          .value(held[c*VALUE_BITS+:VALUE_BITS]),
          .colour(colour[c*COLOUR_BITS+:COLOUR_BITS])
      );
    end
  endgenerate

  assign {blue, green, red} = {3 / CHANNELS{colour}};

endmodule

`default_nettype wire
