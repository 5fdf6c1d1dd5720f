// flat_unit: one intensity for all pixels of a span, that of its face (the paper's eq. (1) and
// Fig. 1). Nothing is interpolated.
// One pixel a clock; latency below, from the held intensity, which itself has 1 from load.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module flat_unit (
    input wire clk,

    // a span
    input wire                                          advance,  // take the next pixel
    // it is the first of the span with `values`
    input wire                                          load,
    input wire [`PHONG_CHANNELS*`PHONG_NORMAL_BITS-1:0] values,   // {blue, green, red}, s1.30

    // a pixel
    output wire [`PHONG_COLOUR_BITS-1:0] red,    // codes
    output wire [`PHONG_COLOUR_BITS-1:0] green,
    output wire [`PHONG_COLOUR_BITS-1:0] blue
);

  localparam CHANNELS    = `PHONG_CHANNELS;  // 3, or 1 for grey
  localparam VALUE_BITS  = `PHONG_NORMAL_BITS;
  localparam COLOUR_BITS = `PHONG_COLOUR_BITS;
  localparam LATENCY     = `PHONG_INTENSITY_CODE_LATENCY;

  reg  [ CHANNELS*VALUE_BITS-1:0] held;
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
