// reflection: 1 - cos(s), the versine of the angle between the reflected ray and the eye.
// The paper's cos(s) = 2 Zn (N.u) - u_z is a small difference from 1 near a highlight. With the
// unit vector h = (hx, 0, hz) halfway between light and eye the same quantity is a sum of squares,
//   1 - cos(s) = 2 ((hz Yn)^2 + (hz Xn - hx Zn)^2),
// accurate relative to itself, so that cos(s)^n loses little for any n.
// It is even in N: turning a normal toward the light does not change it.
// One result a clock; latency below.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module reflection (
    input  wire                               clk,
    input  wire [`PHONG_HALF_VECTOR_BITS-1:0] half_x,  // s0.17, held for a frame
    input  wire [`PHONG_HALF_VECTOR_BITS-1:0] half_z,
    input  wire [`PHONG_UNIT_BITS-1:0]        unit_x,  // s0.17, unit normal
    input  wire [`PHONG_UNIT_BITS-1:0]        unit_y,
    input  wire [`PHONG_UNIT_BITS-1:0]        unit_z,
    // u0.22, 1 - cos(s); all ones where cos(s) <= 0
    output wire [`PHONG_VERSINE_BITS-1:0]     versine
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
