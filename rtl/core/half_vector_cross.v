// SPDX-License-Identifier: MIT
// half_vector_cross: x and y components of the cross product of a vector and the half vector
// h = (hx, 0, hz), rounded:
//   cross_xz = hz y, cross_y = hz x - hx z (the y component with the opposite sign).
// The z component, -hx y, is not needed: see reflection.
// Latency: LATENCY cycles (PHONG_HALF_VECTOR_CROSS_LATENCY in latency.vh; 6 by default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module half_vector_cross #(
    parameter VECTOR_BITS = `PHONG_UNIT_BITS,               // width of x, y, z
    parameter OUT_BITS    = `PHONG_UNIT_BITS,
    parameter HALF_BITS   = `PHONG_HALF_VECTOR_BITS,
    parameter DROP        = `PHONG_HALF_VECTOR_FRACTION,    // fraction bits that rounding drops
    parameter CONSTANT    = `PHONG_CONSTANT_HALF_VECTOR,    // 1: h is {HALF_X, 0, HALF_Z}
    parameter HALF_X      = `PHONG_CONSTANT_HALF_VECTOR_X,
    parameter HALF_Z      = `PHONG_CONSTANT_HALF_VECTOR_Z,  // 0 or more
    parameter LATENCY     = `PHONG_HALF_VECTOR_CROSS_LATENCY
) (
    input wire clk,

    // registers, held for a frame
    input wire [HALF_BITS-1:0] half_x,  // s0.17, half vector, x
    input wire [HALF_BITS-1:0] half_z,  // s0.17, half vector, z

    // a vector
    input wire [VECTOR_BITS-1:0] x,  // two's complement; s0.17 for a unit normal
    input wire [VECTOR_BITS-1:0] y,  // two's complement; s0.17 for a unit normal
    input wire [VECTOR_BITS-1:0] z,  // two's complement; s0.17 for a unit normal

    // its products; with the default DROP in the format of the vector
    output wire [OUT_BITS-1:0] cross_xz,  // two's complement, hz y
    output wire [OUT_BITS-1:0] cross_y    // two's complement, hz x - hx z
);

  localparam PRODUCT_BITS = HALF_BITS + VECTOR_BITS;

  wire [PRODUCT_BITS-1:0] zy_p3, zx_p3, xz_p3;  // hz y, hz x, hx z; constant h: |hx| z
  reg [PRODUCT_BITS-1:0] cross_xz_p4;
  reg [PRODUCT_BITS:0] cross_y_p4;

  generate
    if (CONSTANT) begin : gen_constant
      localparam LEVELS = `PHONG_CONSTANT_HALF_VECTOR_LEVELS;

      constant_multiplier #(
          .BITS(VECTOR_BITS),
          .CONSTANT(HALF_Z),
          .CONSTANT_BITS(HALF_BITS),
          .LATENCY(LEVELS)
      ) u_half_z_y (
          .clk(clk),
          .word(y),
          .product(zy_p3)
      );

      constant_multiplier #(
          .BITS(VECTOR_BITS),
          .CONSTANT(HALF_Z),
          .CONSTANT_BITS(HALF_BITS),
          .LATENCY(LEVELS)
      ) u_half_z_x (
          .clk(clk),
          .word(x),
          .product(zx_p3)
      );

      constant_multiplier #(
          .BITS(VECTOR_BITS),
          .CONSTANT(HALF_X < 0 ? -HALF_X : HALF_X),
          .CONSTANT_BITS(HALF_BITS),
          .LATENCY(LEVELS)
      ) u_half_x_z (
          .clk(clk),
          .word(z),
          .product(xz_p3)
      );
    end else begin : gen_variable
      wire [PRODUCT_BITS-1:0] zy_p2, zx_p2, xz_p2;
      reg [PRODUCT_BITS-1:0] zy, zx, xz;

      multiplier #(
          .A_BITS(HALF_BITS),
          .B_BITS(VECTOR_BITS)
      ) u_half_z_y (
          .clk(clk),
          .a(half_z),
          .b(y),
          .product(zy_p2)
      );

      multiplier #(
          .A_BITS(HALF_BITS),
          .B_BITS(VECTOR_BITS)
      ) u_half_z_x (
          .clk(clk),
          .a(half_z),
          .b(x),
          .product(zx_p2)
      );

      multiplier #(
          .A_BITS(HALF_BITS),
          .B_BITS(VECTOR_BITS)
      ) u_half_x_z (
          .clk(clk),
          .a(half_x),
          .b(z),
          .product(xz_p2)
      );

      // The products come from DSP blocks far apart and meet in one long addition. A register stage
      // after the blocks leaves that addition a whole cycle.
      always @(posedge clk) begin
        zy <= zy_p2;
        zx <= zx_p2;
        xz <= xz_p2;
      end

      assign {zy_p3, zx_p3, xz_p3} = {zy, zx, xz};
    end

    if (CONSTANT && HALF_X < 0) begin : gen_add
      always @(posedge clk) begin
        cross_y_p4 <= {zx_p3[PRODUCT_BITS-1], zx_p3} + {xz_p3[PRODUCT_BITS-1], xz_p3};
      end
    end else begin : gen_subtract
      always @(posedge clk) begin
        cross_y_p4 <= {zx_p3[PRODUCT_BITS-1], zx_p3} - {xz_p3[PRODUCT_BITS-1], xz_p3};
      end
    end
  endgenerate

  always @(posedge clk) cross_xz_p4 <= zy_p3;

  round_saturate #(
      .IN_BITS (PRODUCT_BITS),
      .DROP    (DROP),
      .OUT_BITS(OUT_BITS)
  ) u_cross_xz (
      .clk(clk),
      .in (cross_xz_p4),
      .out(cross_xz)
  );

  round_saturate #(
      .IN_BITS (PRODUCT_BITS + 1),
      .DROP    (DROP),
      .OUT_BITS(OUT_BITS)
  ) u_cross_y (
      .clk(clk),
      .in (cross_y_p4),
      .out(cross_y)
  );

endmodule

`default_nettype wire
