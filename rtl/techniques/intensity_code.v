// intensity_code: the code of an intensity that may have left [0, 1] by a step's rounding,
//   code = floor(255 clamp(S, 0, 1) + 1/2).
// One result a clock; latency below.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module intensity_code (
    input  wire                          clk,
    input  wire [`PHONG_NORMAL_BITS-1:0] value,  // s1.30, S of one channel
    output reg  [`PHONG_COLOUR_BITS-1:0] colour  // code
);

  localparam VALUE_BITS         = `PHONG_NORMAL_BITS;
  localparam VALUE_FRACTION     = `PHONG_NORMAL_FRACTION;
  localparam INTENSITY_BITS     = `PHONG_INTENSITY_BITS;
  localparam INTENSITY_FRACTION = `PHONG_INTENSITY_FRACTION;
  localparam COLOUR_BITS        = `PHONG_COLOUR_BITS;
  localparam LATENCY            = `PHONG_INTENSITY_CODE_LATENCY;

  localparam SIGN = VALUE_BITS - 1;
  localparam DROP = VALUE_FRACTION - INTENSITY_FRACTION;

  // ---- clamp, cut ----
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
