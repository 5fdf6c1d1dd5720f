// SPDX-License-Identifier: MIT
// light_scale: unit normal of one light, in the light's frame: its mantissas times 1/|N0|.
// Latency: from the root PHONG_LIGHT_SCALE_LATENCY cycles (see latency.vh; 5 by default), from the
// mantissas LATENCY cycles.
// Throughput: one normal per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module light_scale (
    input wire clk,

    input wire [3*`PHONG_MANTISSA_BITS-1:0] mantissas,  // s0.17 each, {z, y, x}
    input wire                              less,       // 1: shifted by one bit less than N0

    // PHONG_HELD_ROOT_LATENCY cycles after the mantissas, from held_root
    input wire [`PHONG_ROOT_BITS-1:0] root,       // u0.18
    input wire                        below_one,  // 1: the root is that of 4 |m|^2

    // unit normal, LATENCY cycles after the mantissas
    output wire [`PHONG_UNIT_BITS-1:0]   unit_x,  // s0.17, x
    output wire [`PHONG_UNIT_BITS-1:0]   unit_y,  // s0.17, y
    output wire [`PHONG_UNIT_BITS-1:0]   unit_z,  // s0.17, z
    output wire [`PHONG_COSINE_BITS-1:0] cosine   // u0.18, |N.L| = |cos(i)|
);

  localparam MANTISSA_BITS     = `PHONG_MANTISSA_BITS;
  localparam MANTISSA_FRACTION = `PHONG_MANTISSA_FRACTION;
  localparam ROOT_BITS         = `PHONG_ROOT_BITS;
  localparam ROOT_FRACTION     = `PHONG_ROOT_FRACTION;
  localparam UNIT_BITS         = `PHONG_UNIT_BITS;
  localparam UNIT_FRACTION     = `PHONG_UNIT_FRACTION;
  localparam COSINE_BITS       = `PHONG_COSINE_BITS;
  localparam COSINE_FRACTION   = `PHONG_COSINE_FRACTION;
  localparam SPECULAR          = `PHONG_SPECULAR;   // 0: only `cosine` is used
  localparam TWO_SIDED         = `PHONG_TWO_SIDED;  // 0: `cosine` is not used where N.L < 0
  localparam LATENCY           = `PHONG_HELD_ROOT_LATENCY + `PHONG_LIGHT_SCALE_LATENCY;

  localparam PRODUCT_BITS = MANTISSA_BITS + ROOT_BITS;
  localparam PRODUCT_FRACTION = MANTISSA_FRACTION + ROOT_FRACTION;
  localparam SCALED_BITS = PRODUCT_BITS + 2;  // shifted left by up to 2 bits
  localparam COSINE_DROP = PRODUCT_FRACTION - COSINE_FRACTION;  // low bits that |N.L| drops
  localparam Z = 2;

  wire [3*MANTISSA_BITS-1:0] waiting;
  wire less_p2;
  reg [1:0] doublings_p2;  // bits to shift the products left by

  delay #(
      .BITS  (3 * MANTISSA_BITS),
      .CYCLES(`PHONG_HELD_ROOT_LATENCY)
  ) u_wait (
      .clk(clk),
      .in (mantissas),
      .out(waiting)
  );

  delay #(
      .BITS  (1),
      .CYCLES(`PHONG_HELD_ROOT_LATENCY + `PHONG_MULTIPLIER_LATENCY - 1)
  ) u_less (
      .clk(clk),
      .in (less),
      .out(less_p2)
  );

  wire below_one_p1;

  delay #(
      .BITS  (1),
      .CYCLES(`PHONG_MULTIPLIER_LATENCY - 1)
  ) u_below_one (
      .clk(clk),
      .in (below_one),
      .out(below_one_p1)
  );

  always @(posedge clk) doublings_p2 <= {1'b0, less_p2} + {1'b0, below_one_p1};

  // ---- scale ----
  wire [SCALED_BITS-1:0] scaled[0:Z];
  wire [COSINE_DROP-2:0] low_z;  // of the product with z
  wire [UNIT_BITS-1:0] unit[0:Z];

  genvar c;
  generate
    for (c = 0; c <= Z; c = c + 1) begin : gen_component
      if (SPECULAR || c == Z) begin : gen_scale
        wire [PRODUCT_BITS-1:0] product;
        reg  [ SCALED_BITS-1:0] shifted;

        multiplier #(
            .A_BITS  (MANTISSA_BITS),
            .B_BITS  (ROOT_BITS),
            .B_SIGNED(0)
        ) u_scale (
            .clk(clk),
            .a(waiting[c*MANTISSA_BITS+:MANTISSA_BITS]),
            .b(root),
            .product(product)
        );

        always @(posedge clk) begin
          shifted <= {{2{product[PRODUCT_BITS-1]}}, product} << doublings_p2;
        end

        assign scaled[c] = shifted;
        if (c == Z) begin : gen_low
          assign low_z = product[COSINE_DROP-2:0];
        end
      end else begin : gen_no_scale
        assign scaled[c] = {SCALED_BITS{1'b0}};
      end

      if (SPECULAR) begin : gen_unit
        round_saturate #(
            .IN_BITS (SCALED_BITS),
            .DROP    (PRODUCT_FRACTION - UNIT_FRACTION),
            .OUT_BITS(UNIT_BITS)
        ) u_unit (
            .clk(clk),
            .in (scaled[c]),
            .out(unit[c])
        );
      end else begin : gen_no_unit
        assign unit[c] = {UNIT_BITS{1'b0}};
      end
    end
  endgenerate

  assign {unit_z, unit_y, unit_x} = {unit[Z], unit[1], unit[0]};

  // ---- round: |N.L|, as in normalizer: the 1 of ~z + 1 is part of the carry of the rounding ----
  localparam MAGNITUDE_BITS = SCALED_BITS - COSINE_DROP;

  wire negative = (TWO_SIDED != 0) & scaled[Z][SCALED_BITS-1];
  wire half = scaled[Z][COSINE_DROP-1];
  reg below_half_zero;  // all bits below `half` are 0

  wire [COSINE_DROP-2:0] low_shifted = low_z << doublings_p2;

  always @(posedge clk) below_half_zero <= low_shifted == 0;

  wire [MAGNITUDE_BITS-1:0] magnitude =
      scaled[Z][SCALED_BITS-1:COSINE_DROP] ^ {MAGNITUDE_BITS{negative}};
  wire carry = negative ? ~half | below_half_zero : half;

  round_saturate #(
      .IN_BITS  (MAGNITUDE_BITS + 1),
      .DROP     (1),
      .OUT_BITS (COSINE_BITS),
      .IS_SIGNED(0)
  ) u_cosine (
      .clk(clk),
      .in ({magnitude, carry}),
      .out(cosine)
  );

endmodule

`default_nettype wire
