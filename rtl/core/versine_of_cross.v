// SPDX-License-Identifier: MIT
// versine_of_cross: 1 - cos(s) = 2 (cross_xz^2 + cross_y^2), from the x and y components of the
// cross product of the unit normal and the half vector (see reflection).
// Latency: LATENCY cycles (PHONG_VERSINE_OF_CROSS_LATENCY in latency.vh; 6 by default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module versine_of_cross (
    input  wire                           clk,
    input  wire [`PHONG_UNIT_BITS-1:0]    cross_xz,  // s0.17, hz Yn
    input  wire [`PHONG_UNIT_BITS-1:0]    cross_y,   // s0.17, hz Xn - hx Zn
    output wire [`PHONG_VERSINE_BITS-1:0] versine    // u0.22, 1 - cos(s); all ones if cos(s) <= 0
);

  localparam UNIT_BITS        = `PHONG_UNIT_BITS;
  localparam UNIT_FRACTION    = `PHONG_UNIT_FRACTION;
  localparam VERSINE_BITS     = `PHONG_VERSINE_BITS;
  localparam VERSINE_FRACTION = `PHONG_VERSINE_FRACTION;
  localparam LATENCY          = `PHONG_VERSINE_OF_CROSS_LATENCY;

  localparam SUM_BITS = 2 * UNIT_BITS;

  wire [SUM_BITS-1:0] xz_squared_p2, y_squared_p2;

  multiplier #(
      .A_BITS(UNIT_BITS),
      .B_BITS(UNIT_BITS)
  ) u_xz_squared (
      .clk(clk),
      .a(cross_xz),
      .b(cross_xz),
      .product(xz_squared_p2)
  );

  multiplier #(
      .A_BITS(UNIT_BITS),
      .B_BITS(UNIT_BITS)
  ) u_y_squared (
      .clk(clk),
      .a(cross_y),
      .b(cross_y),
      .product(y_squared_p2)
  );

  reg [SUM_BITS-1:0] xz_squared_p3, y_squared_p3;
  reg [SUM_BITS-1:0] sum_p4;

  always @(posedge clk) begin
    xz_squared_p3 <= xz_squared_p2;
    y_squared_p3 <= y_squared_p2;
    sum_p4 <= xz_squared_p3 + y_squared_p3;
  end

  round_saturate #(
      .IN_BITS  (SUM_BITS),
      .DROP     (2 * UNIT_FRACTION - 1 - VERSINE_FRACTION),
      .OUT_BITS (VERSINE_BITS),
      .IS_SIGNED(0)
  ) u_versine (
      .clk(clk),
      .in (sum_p4),
      .out(versine)
  );

endmodule

`default_nettype wire
