// SPDX-License-Identifier: MIT
// light_align: mantissas of the normal of one light. All lights of a pixel see one vector N, each in
// a frame of its own, so that its length is the same for all: that of the first light, N0.
// A normal is shifted as N0 is, so that its mantissas have the length of those of N0. Where a
// component would leave the word, the shift is less; for one vector it is one bit less at most, and
// light_scale doubles the result. A longer normal is taken as shortened by the further bits.
// Latency: LATENCY cycles (PHONG_LIGHT_ALIGN_LATENCY in latency.vh; 9 by default).
// Throughput: one normal per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module light_align (
    input wire clk,

    input wire two_sided,  // register, held for a frame; 1: shade |N.L|
    input wire valid,      // 1: the normal is that of a turn; else it is not lit

    // interpolated normal
    input wire [`PHONG_NORMAL_BITS-1:0] x,  // s1.30, normal, frame of the light, x
    input wire [`PHONG_NORMAL_BITS-1:0] y,  // s1.30, y
    input wire [`PHONG_NORMAL_BITS-1:0] z,  // s1.30, z: toward the light

    // OWN_LATENCY cycles later: the shift that brings the largest component to the top
    output wire [$clog2(`PHONG_NORMAL_BITS)-1:0] own_shift,
    output wire                                  zero,       // 1: the normal is the zero vector

    // one cycle after those: the same of N0
    input wire [$clog2(`PHONG_NORMAL_BITS)-1:0] first_shift,
    input wire                                  first_zero,

    // LATENCY cycles later
    output wire [3*`PHONG_MANTISSA_BITS-1:0] mantissas,  // s0.17 each, {z, y, x}
    output wire                              less,       // 1: shifted by less than N0
    output wire                              lit         // N.L > 0 (two-sided: not 0), exact
);

  localparam NORMAL_BITS   = `PHONG_NORMAL_BITS;
  localparam MANTISSA_BITS = `PHONG_MANTISSA_BITS;
  localparam LATENCY       = `PHONG_LIGHT_ALIGN_LATENCY;
  localparam OWN_LATENCY   = 1 + `PHONG_LEADING_ZEROS_LATENCY;
  localparam SHIFT_AT      = OWN_LATENCY + 2;  // cycles from the input to the shift
  localparam SHIFT_BITS    = $clog2(NORMAL_BITS);
  localparam [SHIFT_BITS-1:0] NO_BIT = NORMAL_BITS[SHIFT_BITS-1:0] - 1'b1;

  // ---- leading_zeros ----
  reg [NORMAL_BITS-2:0] ones_p1;  // bits in which any component differs from its sign
  reg sign_p1;
  wire sign_p3;

  always @(posedge clk) begin
    ones_p1 <= (x[NORMAL_BITS-2:0] ^ {NORMAL_BITS - 1{x[NORMAL_BITS-1]}})
             | (y[NORMAL_BITS-2:0] ^ {NORMAL_BITS - 1{y[NORMAL_BITS-1]}})
             | (z[NORMAL_BITS-2:0] ^ {NORMAL_BITS - 1{z[NORMAL_BITS-1]}});
    sign_p1 <= x[NORMAL_BITS-1] | y[NORMAL_BITS-1] | z[NORMAL_BITS-1];
  end

  leading_zeros #(
      .BITS(NORMAL_BITS - 1),
      .COUNT_BITS(SHIFT_BITS)
  ) u_leading_zeros (
      .clk  (clk),
      .word (ones_p1),
      .count(own_shift)
  );

  delay #(
      .BITS  (1),
      .CYCLES(OWN_LATENCY - 1)
  ) u_sign (
      .clk(clk),
      .in (sign_p1),
      .out(sign_p3)
  );

  assign zero = ~sign_p3 & (own_shift == NO_BIT);

  // ---- shift: that of N0, or less ----
  reg [SHIFT_BITS-1:0] own_shift_p4, shift_p5;
  reg less_p5;

  always @(posedge clk) begin
    own_shift_p4 <= own_shift;
    shift_p5 <= own_shift_p4 < first_shift ? own_shift_p4 : first_shift;
    less_p5 <= own_shift_p4 < first_shift;
  end

  delay #(
      .BITS  (1),
      .CYCLES(LATENCY - SHIFT_AT)
  ) u_less (
      .clk(clk),
      .in (less_p5),
      .out(less)
  );

  // ---- align ----
  wire [3*NORMAL_BITS-1:0] xyz = {z, y, x};

  genvar c;
  generate
    for (c = 0; c < 3; c = c + 1) begin : gen_component
      wire [NORMAL_BITS-1:0] normal_p5, aligned_p7;

      delay #(
          .BITS  (NORMAL_BITS),
          .CYCLES(SHIFT_AT)
      ) u_normal (
          .clk(clk),
          .in (xyz[c*NORMAL_BITS+:NORMAL_BITS]),
          .out(normal_p5)
      );

      left_shifter #(
          .BITS(NORMAL_BITS),
          .COUNT_BITS(SHIFT_BITS)
      ) u_align (
          .clk(clk),
          .word(normal_p5),
          .count(shift_p5),
          .shifted(aligned_p7)
      );

      round_saturate #(
          .IN_BITS (NORMAL_BITS),
          .DROP    (NORMAL_BITS - MANTISSA_BITS),
          .OUT_BITS(MANTISSA_BITS)
      ) u_mantissa (
          .clk(clk),
          .in (aligned_p7),
          .out(mantissas[c*MANTISSA_BITS+:MANTISSA_BITS])
      );
    end
  endgenerate

  // ---- lit: the sign of the interpolated N.L; no light reaches a pixel whose N0 is zero ----
  reg lit_p1, lit_p5;
  wire lit_p4;

  always @(posedge clk) begin
    lit_p1 <= valid & (z != 0) & (two_sided | ~z[NORMAL_BITS-1]);
    lit_p5 <= lit_p4 & ~first_zero;
  end

  delay #(
      .BITS  (1),
      .CYCLES(SHIFT_AT - 2)
  ) u_lit_early (
      .clk(clk),
      .in (lit_p1),
      .out(lit_p4)
  );

  delay #(
      .BITS  (1),
      .CYCLES(LATENCY - SHIFT_AT)
  ) u_lit (
      .clk(clk),
      .in (lit_p5),
      .out(lit)
  );

endmodule

`default_nettype wire
