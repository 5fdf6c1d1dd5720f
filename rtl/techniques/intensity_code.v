// SPDX-License-Identifier: MIT
// intensity_code: the colour code of an interpolated intensity S,
//   code = floor(255 clamp(S, 0, 1) + 1/2).
// The clamp is needed because the rounding of steps may carry S out of [0, 1].
// Latency: LATENCY cycles (PHONG_INTENSITY_CODE_LATENCY in latency.vh; 3 by default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module intensity_code (
    input  wire                          clk,
    input  wire [`PHONG_NORMAL_BITS-1:0] value,  // s1.30, S of one channel
    output reg  [`PHONG_COLOUR_BITS-1:0] colour  // code, 0 to 255
);

  localparam VALUE_BITS         = `PHONG_NORMAL_BITS;
  localparam VALUE_FRACTION     = `PHONG_NORMAL_FRACTION;
  localparam INTENSITY_BITS     = `PHONG_INTENSITY_BITS;
  localparam INTENSITY_FRACTION = `PHONG_INTENSITY_FRACTION;
  localparam COLOUR_BITS        = `PHONG_COLOUR_BITS;
  localparam LATENCY            = `PHONG_INTENSITY_CODE_LATENCY;

  localparam SIGN = VALUE_BITS - 1;                       // sign bit of `value`
  localparam DROP = VALUE_FRACTION - INTENSITY_FRACTION;  // fraction bits cut off

  // ---- clamp: to [0, 1], then cut ----
  wire at_least_one = |value[SIGN-1:VALUE_FRACTION];

  reg [INTENSITY_BITS-1:0] intensity_p1;  // u1.24

  always @(posedge clk) begin
    if (value[SIGN]) intensity_p1 <= 0;
    else if (at_least_one) intensity_p1 <= 1'b1 << INTENSITY_FRACTION;
    else intensity_p1 <= value[DROP+:INTENSITY_BITS];
  end

  // ---- code: times 255, rounded ----
  reg [INTENSITY_BITS+COLOUR_BITS-1:0] scaled_p2;

  always @(posedge clk) begin
    scaled_p2 <= {intensity_p1, {COLOUR_BITS{1'b0}}} - {{COLOUR_BITS{1'b0}}, intensity_p1};
    colour <= scaled_p2[INTENSITY_FRACTION+:COLOUR_BITS]
        + {{COLOUR_BITS - 1{1'b0}}, scaled_p2[INTENSITY_FRACTION-1]};
  end

  wire unused = &{1'b0, value[DROP-1:0], scaled_p2[INTENSITY_BITS+COLOUR_BITS-1],
                  scaled_p2[INTENSITY_FRACTION-2:0]};

endmodule

`default_nettype wire
