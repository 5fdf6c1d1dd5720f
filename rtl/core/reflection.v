// SPDX-License-Identifier: MIT
// reflection: 1 - cos(s), the versine of the angle s between the reflected ray and the eye.
// Phong 1975 has cos(s) = 2 Zn (N.u) - u_z, where u is the direction of the eye. Near a highlight
// this is a small difference from 1. With the half vector h = (hx, 0, hz), the unit vector halfway
// between light and eye, the same quantity is a sum of two squares,
//   1 - cos(s) = 2 ((hz Yn)^2 + (hz Xn - hx Zn)^2),
// whose relative error is small everywhere, so that cos(s)^n loses little for any n. The squares
// are those of the x and y components of the cross product N x h. (Lyon 1993 uses |R - u|^2 / 2 in
// the same spirit, with more products.)
// The result is even in N: turning a normal toward the light does not change it.
// Latency: LATENCY cycles (PHONG_REFLECTION_LATENCY in latency.vh; 12 by default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module reflection (
    input wire clk,

    // registers, held for a frame
    input wire [`PHONG_HALF_VECTOR_BITS-1:0] half_x,  // s0.17, half vector, x
    input wire [`PHONG_HALF_VECTOR_BITS-1:0] half_z,  // s0.17, half vector, z

    // a pixel
    input  wire [`PHONG_UNIT_BITS-1:0]    unit_x,  // s0.17, unit normal, x
    input  wire [`PHONG_UNIT_BITS-1:0]    unit_y,  // s0.17, y
    input  wire [`PHONG_UNIT_BITS-1:0]    unit_z,  // s0.17, z
    output wire [`PHONG_VERSINE_BITS-1:0] versine  // u0.22, 1 - cos(s); all ones if cos(s) <= 0
);

  localparam UNIT_BITS = `PHONG_UNIT_BITS;
  localparam LATENCY   = `PHONG_REFLECTION_LATENCY;

  wire [UNIT_BITS-1:0] cross_xz_p6, cross_y_p6;

  half_vector_cross u_half_vector_cross (
      .clk(clk),
      .half_x(half_x),
      .half_z(half_z),
      .x(unit_x),
      .y(unit_y),
      .z(unit_z),
      .cross_xz(cross_xz_p6),
      .cross_y(cross_y_p6)
  );

  versine_of_cross u_versine (
      .clk(clk),
      .cross_xz(cross_xz_p6),
      .cross_y(cross_y_p6),
      .versine(versine)
  );

endmodule

`default_nettype wire
