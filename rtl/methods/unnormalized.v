// SPDX-License-Identifier: MIT
// unnormalized: takes the place of the normalizer in a study: the interpolated vector itself is
// shaded as if it were a unit normal. It is only rounded to the words of one.
// Latency: LATENCY cycles (PHONG_UNNORMALIZED_LATENCY in latency.vh; 3 by default).
// Throughput: one normal per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module unnormalized (
    input wire clk,
    input wire two_sided,  // register, held for a frame; 1: shade |Zn|

    // interpolated normal of a pixel
    input wire [`PHONG_NORMAL_BITS-1:0] x,  // s1.30, normal, light frame, x
    input wire [`PHONG_NORMAL_BITS-1:0] y,  // s1.30, y
    input wire [`PHONG_NORMAL_BITS-1:0] z,  // s1.30, z: toward the light

    // the same pixel, LATENCY cycles later
    output wire [`PHONG_UNIT_BITS-1:0]   unit_x,  // s0.17, x, rounded and saturated
    output wire [`PHONG_UNIT_BITS-1:0]   unit_y,  // s0.17, y
    output wire [`PHONG_UNIT_BITS-1:0]   unit_z,  // s0.17, z
    output wire [`PHONG_COSINE_BITS-1:0] cosine,  // u0.18, |z|, stands for cos(i)
    output wire                          lit      // z > 0 (two-sided: z not 0), exact
);

  localparam NORMAL_BITS     = `PHONG_NORMAL_BITS;
  localparam NORMAL_FRACTION = `PHONG_NORMAL_FRACTION;
  localparam UNIT_BITS       = `PHONG_UNIT_BITS;
  localparam UNIT_FRACTION   = `PHONG_UNIT_FRACTION;
  localparam COSINE_BITS     = `PHONG_COSINE_BITS;
  localparam COSINE_FRACTION = `PHONG_COSINE_FRACTION;
  localparam LATENCY         = `PHONG_UNNORMALIZED_LATENCY;

  // ---- lit: the sign of the interpolated z, before any rounding ----
  reg lit_p1;

  always @(posedge clk) lit_p1 <= (z != 0) & (two_sided | ~z[NORMAL_BITS-1]);

  delay #(
      .BITS  (1),
      .CYCLES(LATENCY - 1)
  ) u_lit (
      .clk(clk),
      .in (lit_p1),
      .out(lit)
  );

  // ---- round ----
  reg [3*NORMAL_BITS-1:0] xyz_p1;
  reg [  NORMAL_BITS-1:0] magnitude_p1;  // u2.30, |z|
  wire [3*UNIT_BITS-1:0] unit;

  always @(posedge clk) begin
    xyz_p1 <= {z, y, x};
    magnitude_p1 <= (z ^ {NORMAL_BITS{z[NORMAL_BITS-1]}})
        + {{NORMAL_BITS - 1{1'b0}}, z[NORMAL_BITS-1]};
  end

  genvar c;
  generate
    for (c = 0; c < 3; c = c + 1) begin : gen_component
      round_saturate #(
          .IN_BITS (NORMAL_BITS),
          .DROP    (NORMAL_FRACTION - UNIT_FRACTION),
          .OUT_BITS(UNIT_BITS)
      ) u_unit (
          .clk(clk),
          .in (xyz_p1[c*NORMAL_BITS+:NORMAL_BITS]),
          .out(unit[c*UNIT_BITS+:UNIT_BITS])
      );
    end
  endgenerate

  assign {unit_z, unit_y, unit_x} = unit;

  round_saturate #(
      .IN_BITS  (NORMAL_BITS),
      .DROP     (NORMAL_FRACTION - COSINE_FRACTION),
      .OUT_BITS (COSINE_BITS),
      .IS_SIGNED(0)
  ) u_cosine (
      .clk(clk),
      .in (magnitude_p1),
      .out(cosine)
  );

endmodule

`default_nettype wire
