// SPDX-License-Identifier: MIT
// gouraud_unit: Gouraud shading: the intensities of the vertices, interpolated linearly along the
// span (Phong 1975, Fig. 3), one interpolator per colour channel. There is no normal, no shading
// function and no multiplier.
// Latency: LATENCY cycles from a pixel of span_walker to its colour (PHONG_INTENSITY_CODE_LATENCY
// in latency.vh; 3 by default).
// Throughput: one pixel per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module gouraud_unit (
    input wire clk,

    // control from span_walker; `load` acts only together with `advance`
    input wire advance,  // 1: move to the next pixel
    input wire load,     // 1: the current pixel ends its span; the next one starts from `values`

    // offered span: {step of blue, green, red, start of blue, green, red}, s1.30 each
    input wire [2*`PHONG_CHANNELS*`PHONG_NORMAL_BITS-1:0] values,

    // current pixel
    output wire overflow,  // an intensity has left its word since the span's first pixel

    // colour of a pixel
    output wire [`PHONG_COLOUR_BITS-1:0] red,    // code, 0 to 255
    output wire [`PHONG_COLOUR_BITS-1:0] green,  // code, 0 to 255
    output wire [`PHONG_COLOUR_BITS-1:0] blue    // code, 0 to 255
);

  localparam CHANNELS    = `PHONG_CHANNELS;  // 3: red, green, blue; 1: grey
  localparam VALUE_BITS  = `PHONG_NORMAL_BITS;
  localparam COLOUR_BITS = `PHONG_COLOUR_BITS;
  localparam LATENCY     = `PHONG_INTENSITY_CODE_LATENCY;

  wire [CHANNELS*COLOUR_BITS-1:0] colour;
  wire [CHANNELS-1:0] channel_overflow;

  genvar c;
  generate
    for (c = 0; c < CHANNELS; c = c + 1) begin : gen_channel
      wire [VALUE_BITS-1:0] intensity;  // s1.30, of the current pixel

      linear_interpolator u_interpolator (
          .clk(clk),
          .load(load),
          .advance(advance),
          .start(values[c*VALUE_BITS+:VALUE_BITS]),
          .step(values[(CHANNELS+c)*VALUE_BITS+:VALUE_BITS]),
          .value(intensity),
          .overflow(channel_overflow[c])
      );

      intensity_code u_code (
          .clk(clk),
          .value(intensity),
          .colour(colour[c*COLOUR_BITS+:COLOUR_BITS])
      );
    end
  endgenerate

  assign {blue, green, red} = {3 / CHANNELS{colour}};
  assign overflow = |channel_overflow;

endmodule

`default_nettype wire
