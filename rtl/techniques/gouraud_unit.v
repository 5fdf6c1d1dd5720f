// gouraud_unit: the paper's Fig. 3 -- intensities from the vertices, interpolated linearly along
// the span, one interpolator a colour. No normal, no shading function, no multiplier.
// One pixel a clock; latency below, from the interpolators, which themselves have 1 from load.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module gouraud_unit (
    input wire clk,

    // a span
    input  wire                                            advance,   // take the next pixel
    // it is the first of the span with `values`
    input  wire                                            load,
    // {step, start} of {blue, green, red}, s1.30
    input  wire [2*`PHONG_CHANNELS*`PHONG_NORMAL_BITS-1:0] values,
    // an intensity has left its word since load
    output wire                                            overflow,

    // a pixel
    output wire [`PHONG_COLOUR_BITS-1:0] red,    // codes
    output wire [`PHONG_COLOUR_BITS-1:0] green,
    output wire [`PHONG_COLOUR_BITS-1:0] blue
);

  localparam CHANNELS    = `PHONG_CHANNELS;  // 3, or 1 for grey
  localparam VALUE_BITS  = `PHONG_NORMAL_BITS;
  localparam COLOUR_BITS = `PHONG_COLOUR_BITS;
  localparam LATENCY     = `PHONG_INTENSITY_CODE_LATENCY;

  wire [CHANNELS*COLOUR_BITS-1:0] colour;
  wire [CHANNELS-1:0] channel_overflow;

  genvar c;
  generate
    for (c = 0; c < CHANNELS; c = c + 1) begin : gen_channel
      wire [VALUE_BITS-1:0] intensity;  // s1.30

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
