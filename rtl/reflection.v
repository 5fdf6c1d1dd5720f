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

module reflection #(
    parameter UNIT_BITS        = `PHONG_UNIT_BITS,
    parameter HALF_BITS        = `PHONG_HALF_VECTOR_BITS,
    parameter VERSINE_BITS     = `PHONG_VERSINE_BITS,
<<<<<<< HEAD
=======
    parameter VERSINE_FRACTION = `PHONG_VERSINE_FRACTION,
    parameter CONSTANT         = `PHONG_CONSTANT_HALF_VECTOR,  // 1: h is a constant
    parameter HALF_X           = `PHONG_CONSTANT_HALF_VECTOR_X,
    parameter HALF_Z           = `PHONG_CONSTANT_HALF_VECTOR_Z,  // 0 or more
>>>>>>> main
    parameter LATENCY          = `PHONG_REFLECTION_LATENCY
) (
    input  wire                    clk,
    input  wire [   HALF_BITS-1:0] half_x,  // s0.17, held for a frame
    input  wire [   HALF_BITS-1:0] half_z,
    input  wire [   UNIT_BITS-1:0] unit_x,  // s0.17, unit normal
    input  wire [   UNIT_BITS-1:0] unit_y,
    input  wire [   UNIT_BITS-1:0] unit_z,
    output wire [VERSINE_BITS-1:0] versine  // u0.22, 1 - cos(s); all ones where cos(s) <= 0
);

<<<<<<< HEAD
=======
  localparam PRODUCT_BITS = HALF_BITS + UNIT_BITS;
  localparam SUM_BITS = 2 * UNIT_BITS;

  // ---- across: the parts of the normal across h ----
  wire [PRODUCT_BITS-1:0] zy_p3, zx_p3, xz_p3;
  reg [PRODUCT_BITS-1:0] across_y_p4;
  reg [PRODUCT_BITS:0] across_x_p4;

  generate
    if (CONSTANT) begin : gen_constant
      localparam LEVELS = `PHONG_CONSTANT_HALF_VECTOR_LEVELS;

      constant_multiplier #(
          .BITS(UNIT_BITS),
          .CONSTANT(HALF_Z),
          .CONSTANT_BITS(HALF_BITS),
          .LATENCY(LEVELS)
      ) u_half_z_unit_y (
          .clk(clk),
          .word(unit_y),
          .product(zy_p3)
      );

      constant_multiplier #(
          .BITS(UNIT_BITS),
          .CONSTANT(HALF_Z),
          .CONSTANT_BITS(HALF_BITS),
          .LATENCY(LEVELS)
      ) u_half_z_unit_x (
          .clk(clk),
          .word(unit_x),
          .product(zx_p3)
      );

      constant_multiplier #(
          .BITS(UNIT_BITS),
          .CONSTANT(HALF_X < 0 ? -HALF_X : HALF_X),
          .CONSTANT_BITS(HALF_BITS),
          .LATENCY(LEVELS)
      ) u_half_x_unit_z (
          .clk(clk),
          .word(unit_z),
          .product(xz_p3)
      );
    end else begin : gen_variable
      wire [PRODUCT_BITS-1:0] zy_p2, zx_p2, xz_p2;
      reg [PRODUCT_BITS-1:0] zy, zx, xz;

      multiplier #(
          .A_BITS(HALF_BITS),
          .B_BITS(UNIT_BITS)
      ) u_half_z_unit_y (
          .clk(clk),
          .a(half_z),
          .b(unit_y),
          .product(zy_p2)
      );

      multiplier #(
          .A_BITS(HALF_BITS),
          .B_BITS(UNIT_BITS)
      ) u_half_z_unit_x (
          .clk(clk),
          .a(half_z),
          .b(unit_x),
          .product(zx_p2)
      );

      multiplier #(
          .A_BITS(HALF_BITS),
          .B_BITS(UNIT_BITS)
      ) u_half_x_unit_z (
          .clk(clk),
          .a(half_x),
          .b(unit_z),
          .product(xz_p2)
      );

      // Products far apart on the chip meet in one long addition, so they are fetched first.
      always @(posedge clk) begin
        zy <= zy_p2;
        zx <= zx_p2;
        xz <= xz_p2;
      end

      assign {zy_p3, zx_p3, xz_p3} = {zy, zx, xz};
    end

    if (CONSTANT && HALF_X < 0) begin : gen_add
      always @(posedge clk) begin
        across_x_p4 <= {zx_p3[PRODUCT_BITS-1], zx_p3} + {xz_p3[PRODUCT_BITS-1], xz_p3};
      end
    end else begin : gen_subtract
      always @(posedge clk) begin
        across_x_p4 <= {zx_p3[PRODUCT_BITS-1], zx_p3} - {xz_p3[PRODUCT_BITS-1], xz_p3};
      end
    end
  endgenerate

  always @(posedge clk) across_y_p4 <= zy_p3;

>>>>>>> main
  wire [UNIT_BITS-1:0] p_p6, q_p6;

  across u_across (
      .clk(clk),
      .half_x(half_x),
      .half_z(half_z),
      .x(unit_x),
      .y(unit_y),
      .z(unit_z),
      .p(p_p6),
      .q(q_p6)
  );

  versine_of_parts u_versine (
      .clk(clk),
      .p(p_p6),
      .q(q_p6),
      .versine(versine)
  );

endmodule

`default_nettype wire
