// SPDX-License-Identifier: MIT
// normalizer: unit normal N / |N| of an interpolated normal of any length: the "extra hardware to
// normalize the outputs of the interpolators" of Phong 1975.
// Block normalization first: the components are shifted together until the largest fills the word,
// so that a short normal loses no more direction than a long one. This gives m. Then
//   unit normal = m / |m|: three squares, one 1/sqrt, three products.
// By the method dot_first the x and y components of the cross product N x h (see half_vector_cross)
// are scaled in place of x and y of m.
// The zero vector gives zeros, is not lit, and is flagged.
// Latency: LATENCY cycles (PHONG_NORMALIZER_LATENCY in latency.vh; 25 by default).
// Throughput: one normal per cycle.
// Reset: synchronous; of zero_normal only.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module normalizer (
    input wire clk,
    input wire reset,  // synchronous

    input wire two_sided,  // register, held for a frame; 1: shade |Zn|
    input wire valid,      // 1: the normal is that of a pixel; for zero_normal only

    // registers, held for a frame; for dot_first only
    input wire [`PHONG_HALF_VECTOR_BITS-1:0] half_x,  // s0.17, half vector, x
    input wire [`PHONG_HALF_VECTOR_BITS-1:0] half_z,  // s0.17, half vector, z

    // interpolated normal
    input wire [`PHONG_NORMAL_BITS-1:0] x,  // s1.30, normal, light frame, x
    input wire [`PHONG_NORMAL_BITS-1:0] y,  // s1.30, y
    input wire [`PHONG_NORMAL_BITS-1:0] z,  // s1.30, z: toward the light

    // unit normal, LATENCY cycles later
    output wire [`PHONG_UNIT_BITS-1:0]   unit_x,  // s0.17, x; dot_first: hz x - hx z
    output wire [`PHONG_UNIT_BITS-1:0]   unit_y,  // s0.17, y; dot_first: hz y
    output wire [`PHONG_UNIT_BITS-1:0]   unit_z,  // s0.17, z
    output wire [`PHONG_COSINE_BITS-1:0] cosine,  // u0.18, |Zn| = |cos(i)|
    output wire                          lit,     // Zn > 0 (two-sided: Zn not 0), exact

    // PHONG_ZERO_NORMAL_LATENCY cycles after the pixel
    output wire zero_normal  // one-cycle pulse: its normal is the zero vector
);

  localparam METHOD            = `PHONG_NORMAL_METHOD;
  localparam HALF_FRACTION     = `PHONG_HALF_VECTOR_FRACTION;
  localparam NORMAL_BITS       = `PHONG_NORMAL_BITS;
  localparam MANTISSA_BITS     = `PHONG_MANTISSA_BITS;   // of a component of m
  localparam MANTISSA_FRACTION = `PHONG_MANTISSA_FRACTION;
  localparam OPERAND_BITS      = `PHONG_ROOT_OPERAND_BITS;
  localparam OPERAND_FRACTION  = `PHONG_ROOT_OPERAND_FRACTION;
  localparam ROOT_BITS         = `PHONG_ROOT_BITS;
  localparam ROOT_FRACTION     = `PHONG_ROOT_FRACTION;
  localparam UNIT_BITS         = `PHONG_UNIT_BITS;
  localparam UNIT_FRACTION     = `PHONG_UNIT_FRACTION;
  localparam COSINE_BITS       = `PHONG_COSINE_BITS;
  localparam COSINE_FRACTION   = `PHONG_COSINE_FRACTION;
  localparam CONSTANT_SHIFT    = `PHONG_CONSTANT_SHIFT;  // 1: all normals are shifted by SHIFT
  localparam SHIFT             = `PHONG_CONSTANT_SHIFT_BY;
  localparam SPECULAR          = `PHONG_SPECULAR;        // 0: only `cosine` is used
  localparam TWO_SIDED         = `PHONG_TWO_SIDED;       // 0: `cosine` is not used where Zn < 0
  localparam LATENCY           = `PHONG_NORMALIZER_LATENCY;

  localparam SHIFT_BITS   = $clog2(NORMAL_BITS);
  localparam SQUARE_BITS  = 2 * MANTISSA_BITS;
  localparam ONE          = 2 * MANTISSA_FRACTION;   // bit of weight 1 in a square
  localparam OPERAND_DROP = ONE - OPERAND_FRACTION;  // low bits of |m|^2 cut off
  localparam PRODUCT_BITS = MANTISSA_BITS + ROOT_BITS;
  localparam PRODUCT_FRACTION = MANTISSA_FRACTION + ROOT_FRACTION;

  // ---- lit: the sign of the interpolated Zn, before any rounding ----
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

  // ---- leading_zeros: the shift that brings the largest component to the top ----
  localparam SHIFT_LATENCY = CONSTANT_SHIFT ? 0 : 1 + `PHONG_LEADING_ZEROS_LATENCY;

  wire [SHIFT_BITS-1:0] shift_p3;

  generate
    if (CONSTANT_SHIFT) begin : gen_constant_shift
      assign shift_p3 = SHIFT;
      assign zero_normal = 1'b0;  // span_guard flags it, as of another size
    end else begin : gen_shift
      reg [NORMAL_BITS-2:0] ones_p1;  // bits in which any component differs from its sign

      always @(posedge clk) begin
        ones_p1 <= (x[NORMAL_BITS-2:0] ^ {NORMAL_BITS - 1{x[NORMAL_BITS-1]}})
                 | (y[NORMAL_BITS-2:0] ^ {NORMAL_BITS - 1{y[NORMAL_BITS-1]}})
                 | (z[NORMAL_BITS-2:0] ^ {NORMAL_BITS - 1{z[NORMAL_BITS-1]}});
      end

      leading_zeros #(
          .BITS(NORMAL_BITS - 1),
          .COUNT_BITS(SHIFT_BITS)
      ) u_leading_zeros (
          .clk  (clk),
          .word (ones_p1),
          .count(shift_p3)
      );

      // zero: the zero vector has no bit that differs from its sign, and no negative sign.
      localparam [SHIFT_BITS-1:0] NO_BIT = NORMAL_BITS[SHIFT_BITS-1:0] - 1'b1;

      reg sign_p1, zero;
      wire sign_p3;
      reg [SHIFT_LATENCY-1:0] in_flight;  // `valid` of the last cycles

      always @(posedge clk) begin
        sign_p1 <= x[NORMAL_BITS-1] | y[NORMAL_BITS-1] | z[NORMAL_BITS-1];
        zero <= ~reset & in_flight[SHIFT_LATENCY-1] & ~sign_p3 & (shift_p3 == NO_BIT);
        if (reset) in_flight <= {SHIFT_LATENCY{1'b0}};
        else in_flight <= {in_flight[SHIFT_LATENCY-2:0], valid};
      end

      delay #(
          .BITS  (1),
          .CYCLES(SHIFT_LATENCY - 1)
      ) u_sign (
          .clk(clk),
          .in (sign_p1),
          .out(sign_p3)
      );

      assign zero_normal = zero;
    end
  endgenerate

  // ---- the words to be scaled: x, y, z of m; dot_first: hz x - hx z, hz y and z ----
  // |m| may be up to sqrt(3), so the products with h have one fraction bit less.
  // ROOT_WAIT: cycles from m to 1/|m|.
  localparam ROOT_WAIT = `PHONG_MULTIPLIER_LATENCY + 2 + 1 + `PHONG_INVERSE_SQRT_LATENCY;
  localparam DOT_FIRST = METHOD == `PHONG_NORMAL_METHOD_DOT_FIRST;
  localparam LESS = DOT_FIRST ? 1 : 0;  // fraction bits less

  wire [3*MANTISSA_BITS-1:0] mantissas_p7;  // m, {z, y, x}
  wire [3*MANTISSA_BITS-1:0] scaled_in;     // operands of the products with 1/|m|

  generate
    if (DOT_FIRST) begin : gen_cross
      wire [2*MANTISSA_BITS-1:0] crossed;  // {cross_xz, cross_y}

      half_vector_cross #(
          .VECTOR_BITS(MANTISSA_BITS),
          .OUT_BITS   (MANTISSA_BITS),
          .DROP       (HALF_FRACTION + LESS)
      ) u_half_vector_cross (
          .clk(clk),
          .half_x(half_x),
          .half_z(half_z),
          .x(mantissas_p7[MANTISSA_BITS-1:0]),
          .y(mantissas_p7[MANTISSA_BITS+:MANTISSA_BITS]),
          .z(mantissas_p7[2*MANTISSA_BITS+:MANTISSA_BITS]),
          .cross_xz(crossed[MANTISSA_BITS+:MANTISSA_BITS]),
          .cross_y(crossed[MANTISSA_BITS-1:0])
      );

      delay #(
          .BITS  (2 * MANTISSA_BITS),
          .CYCLES(ROOT_WAIT - `PHONG_HALF_VECTOR_CROSS_LATENCY)
      ) u_crossed (
          .clk(clk),
          .in (crossed),
          .out(scaled_in[2*MANTISSA_BITS-1:0])
      );

      delay #(
          .BITS  (MANTISSA_BITS),
          .CYCLES(ROOT_WAIT)
      ) u_z (
          .clk(clk),
          .in (mantissas_p7[2*MANTISSA_BITS+:MANTISSA_BITS]),
          .out(scaled_in[2*MANTISSA_BITS+:MANTISSA_BITS])
      );
    end else begin : gen_components
      delay #(
          .BITS  (3 * MANTISSA_BITS),
          .CYCLES(ROOT_WAIT)
      ) u_wait (
          .clk(clk),
          .in (mantissas_p7),
          .out(scaled_in)
      );

      wire unused = &{1'b0, half_x, half_z};
    end
  endgenerate

  // ---- align, sum_of_squares, scale, round: the same for the three components ----
  localparam X = 0, Y = 1, Z = 2;

  wire [SQUARE_BITS-1:0] square_p9[X:Z];
  wire [ROOT_BITS-1:0] root;  // u0.18, 1/sqrt of the operand
  wire below_one;             // 1: the operand is 4 |m|^2, so the products are doubled
  wire [UNIT_BITS-1:0] unit[X:Z];
  wire [PRODUCT_BITS:0] product[X:Z];
  wire [PRODUCT_BITS-1:0] scaled_z;

  wire [3*NORMAL_BITS-1:0] xyz = {z, y, x};

  genvar c;
  generate
    for (c = X; c <= Z; c = c + 1) begin : gen_component
      wire [  NORMAL_BITS-1:0] normal_p3;
      wire [  NORMAL_BITS-1:0] aligned_p5;
      wire [MANTISSA_BITS-1:0] mantissa_p7;

      delay #(
          .BITS  (NORMAL_BITS),
          .CYCLES(SHIFT_LATENCY)
      ) u_normal (
          .clk(clk),
          .in (xyz[c*NORMAL_BITS+:NORMAL_BITS]),
          .out(normal_p3)
      );

      if (CONSTANT_SHIFT) begin : gen_constant_align
        assign aligned_p5 = normal_p3 << SHIFT;
      end else begin : gen_align
        left_shifter #(
            .BITS(NORMAL_BITS),
            .COUNT_BITS(SHIFT_BITS)
        ) u_align (
            .clk(clk),
            .word(normal_p3),
            .count(shift_p3),
            .shifted(aligned_p5)
        );
      end

      round_saturate #(
          .IN_BITS (NORMAL_BITS),
          .DROP    (NORMAL_BITS - MANTISSA_BITS),
          .OUT_BITS(MANTISSA_BITS)
      ) u_mantissa (
          .clk(clk),
          .in (aligned_p5),
          .out(mantissa_p7)
      );

      assign mantissas_p7[c*MANTISSA_BITS+:MANTISSA_BITS] = mantissa_p7;

      multiplier #(
          .A_BITS(MANTISSA_BITS),
          .B_BITS(MANTISSA_BITS)
      ) u_square (
          .clk(clk),
          .a(mantissa_p7),
          .b(mantissa_p7),
          .product(square_p9[c])
      );

      if (SPECULAR || c == Z) begin : gen_scale
        wire [PRODUCT_BITS-1:0] scaled;
        reg  [  PRODUCT_BITS:0] doubled;

        multiplier #(
            .A_BITS  (MANTISSA_BITS),
            .B_BITS  (ROOT_BITS),
            .B_SIGNED(0)
        ) u_scale (
            .clk(clk),
            .a(scaled_in[c*MANTISSA_BITS+:MANTISSA_BITS]),
            .b(root),
            .product(scaled)
        );

        always @(posedge clk) begin
          doubled <= below_one ? {scaled, 1'b0} : {scaled[PRODUCT_BITS-1], scaled};
        end

        assign product[c] = doubled;
        if (c == Z) begin : gen_scaled
          assign scaled_z = scaled;
        end
      end else begin : gen_no_scale
        assign product[c] = {PRODUCT_BITS + 1{1'b0}};
      end

      if (SPECULAR) begin : gen_unit
        round_saturate #(
            .IN_BITS (PRODUCT_BITS + 1),
            .DROP    (PRODUCT_FRACTION - UNIT_FRACTION - (c == Z ? 0 : LESS)),
            .OUT_BITS(UNIT_BITS)
        ) u_unit (
            .clk(clk),
            .in (product[c]),
            .out(unit[c])
        );
      end else begin : gen_no_unit
        assign unit[c] = {UNIT_BITS{1'b0}};
      end
    end
  endgenerate

  assign unit_x = unit[X];
  assign unit_y = unit[Y];
  assign unit_z = unit[Z];

  // ---- sum_of_squares ----
  reg [SQUARE_BITS-1:0] sum_xy_p10;
  reg [SQUARE_BITS-1:0] square_z_p10;
  reg [SQUARE_BITS-1:0] sum_p11;

  always @(posedge clk) begin
    sum_xy_p10 <= square_p9[X] + square_p9[Y];
    square_z_p10 <= square_p9[Z];
    sum_p11 <= sum_xy_p10 + square_z_p10;
  end

  // ---- root_operand: |m|^2, or 4 |m|^2 if |m|^2 < 1, in [1, 4) ----
  wire below_one_p11 = ~|sum_p11[SQUARE_BITS-1:ONE];

  reg [OPERAND_BITS-1:0] operand_p12;
  reg below_one_p12;

  always @(posedge clk) begin
    operand_p12 <= below_one_p11 ? sum_p11[OPERAND_DROP-2+:OPERAND_BITS]
                             : sum_p11[OPERAND_DROP+:OPERAND_BITS];
    below_one_p12 <= below_one_p11;
  end

  wire unused = &{1'b0, sum_p11[OPERAND_DROP-3:0]};

  inverse_sqrt u_inverse_sqrt (
      .clk(clk),
      .operand(operand_p12),
      .root(root)
  );

  delay #(
      .BITS  (1),
      .CYCLES(`PHONG_INVERSE_SQRT_LATENCY + `PHONG_MULTIPLIER_LATENCY)
  ) u_below_one (
      .clk(clk),
      .in (below_one_p12),
      .out(below_one)
  );

  // ---- round: |Zn|, with one bit more than the unit normal ----
  // Rounding z half up adds `half`, the highest of the dropped bits. For z < 0 the magnitude is
  // ~z + 1, and this 1 is part of the same carry: the carry into the kept bits is ~half, or 1 if
  // all bits below `half` are 0. So |Zn| needs no adder of its own.
  localparam COSINE_DROP = PRODUCT_FRACTION - COSINE_FRACTION;  // low bits dropped
  localparam MAGNITUDE_BITS = PRODUCT_BITS + 1 - COSINE_DROP;

  wire negative = (TWO_SIDED != 0) & product[Z][PRODUCT_BITS];
  wire half = product[Z][COSINE_DROP-1];
  reg below_half_zero;  // all bits below `half` are 0

  always @(posedge clk) begin
    below_half_zero <= ~|scaled_z[COSINE_DROP-3:0] & (below_one | ~scaled_z[COSINE_DROP-2]);
  end

  wire [MAGNITUDE_BITS-1:0] magnitude =
      product[Z][PRODUCT_BITS:COSINE_DROP] ^ {MAGNITUDE_BITS{negative}};
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
