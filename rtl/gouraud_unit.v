// gouraud_unit: the paper's Fig. 3 -- intensities from the vertices, interpolated linearly along
// the span, one interpolator a colour. No normal, no shading function, no multiplier.
// One pixel a clock; latency below, from the interpolators, which themselves have 1 from load.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module gouraud_unit #(
    parameter CHANNELS    = `PHONG_CHANNELS,  // 3, or 1 for grey
    parameter VALUE_BITS  = `PHONG_NORMAL_BITS,
    parameter COLOUR_BITS = `PHONG_COLOUR_BITS,
    parameter LATENCY     = `PHONG_INTENSITY_CODE_LATENCY
) (
    input wire clk,

    // a span
    input  wire                             advance,  // take the next pixel
    input  wire                             load,     // it is the first of the span with `values`
    input  wire [2*CHANNELS*VALUE_BITS-1:0] values,   // {step, start} of {blue, green, red}, s1.30
    output wire                             overflow, // an intensity has left its word since load

    // a pixel
    output wire [COLOUR_BITS-1:0] red,  // codes
    output wire [COLOUR_BITS-1:0] green,
    output wire [COLOUR_BITS-1:0] blue
);

  wire [CHANNELS*COLOUR_BITS-1:0] colour;
  wire [CHANNELS-1:0] left;

  genvar c;
  generate
    for (c = 0; c < CHANNELS; c = c + 1) begin : gen_channel
      wire [VALUE_BITS-1:0] intensity;  // s1.30

      normal_interpolator u_interpolator (
          .clk(clk),
          .load(load),
          .advance(advance),
          .start(values[c*VALUE_BITS+:VALUE_BITS]),
          .step(values[(CHANNELS+c)*VALUE_BITS+:VALUE_BITS]),
          .value(intensity),
          .overflow(left[c])
      );

      intensity_code u_code (
          .clk(clk),
          .value(intensity),
          .colour(colour[c*COLOUR_BITS+:COLOUR_BITS])
      );
    end
  endgenerate

  assign {blue, green, red} = {3 / CHANNELS{colour}};
  assign overflow = |left;

endmodule

`default_nettype wire
