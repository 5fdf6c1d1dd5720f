// SPDX-License-Identifier: MIT
// quadratic_normalizer: cos(i) and 1 - cos(s) from Zn and two interpolated squares (after Duff
// 1979),
//   cos(i) = Zn / |N|, 1 - cos(s) = 2 C / |N|^2, C = (hz y)^2 + (hz x - hx z)^2.
// C is the squared length of the x and y components of the cross product N x h (see reflection).
// Besides 1/|N| this takes three products; normalizer and reflection take eleven.
// Both squares are shifted together until |N|^2 is in [1, 4). C is then shifted by up to 15 bits
// more, so that a small versine keeps its bits.
// |N|^2 = 0 gives an unspecified but defined result.
// Latency: LATENCY cycles (PHONG_QUADRATIC_NORMALIZER_LATENCY in latency.vh; 23 by default).
// Throughput: one pixel per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module quadratic_normalizer (
    input wire clk,
    input wire two_sided,  // register, held for a frame; 1: shade |Zn|

    // interpolated values of a pixel
    input wire [`PHONG_NORMAL_BITS-1:0]  z,             // s1.30, z of the normal, not normalized
    input wire [`PHONG_SQUARED_BITS-1:0] square,        // s2.42, |N|^2
    input wire [`PHONG_SQUARED_BITS-1:0] cross_square,  // s2.42, C

    // the same pixel, LATENCY cycles later
    output wire [`PHONG_VERSINE_BITS-1:0] versine,  // u0.22, 1 - cos(s); all ones if cos(s) <= 0
    output wire [`PHONG_COSINE_BITS-1:0]  cosine,   // u0.18, |Zn| = |cos(i)|
    output wire                           lit       // Zn > 0 (two-sided: Zn not 0), exact
);

  localparam NORMAL_BITS       = `PHONG_NORMAL_BITS;
  localparam NORMAL_FRACTION   = `PHONG_NORMAL_FRACTION;
  localparam SQUARED_BITS      = `PHONG_SQUARED_BITS;
  localparam MANTISSA_BITS     = `PHONG_QUADRATIC_MANTISSA_BITS;
  localparam MANTISSA_FRACTION = `PHONG_QUADRATIC_MANTISSA_FRACTION;
  localparam OPERAND_BITS      = `PHONG_ROOT_OPERAND_BITS;
  localparam ROOT_BITS         = `PHONG_ROOT_BITS;     // all of them fraction
  localparam COSINE_BITS       = `PHONG_COSINE_BITS;   // all of them fraction
  localparam VERSINE_BITS      = `PHONG_VERSINE_BITS;  // all of them fraction
  localparam LATENCY           = `PHONG_QUADRATIC_NORMALIZER_LATENCY;

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

  // ---- clamp: a square that rounding made negative is 0 ----
  localparam WORD_BITS = SQUARED_BITS - 1;  // u2.42
  localparam COUNT_BITS = $clog2(WORD_BITS + 1);

  reg [WORD_BITS-1:0] square_p1;
  reg [WORD_BITS-1:0] cross_p1;
  reg [NORMAL_BITS-1:0] z_p1;  // u2.30, |Zn|

  always @(posedge clk) begin
    square_p1 <= square[WORD_BITS-1:0] & {WORD_BITS{~square[WORD_BITS]}};
    cross_p1 <= cross_square[WORD_BITS-1:0] & {WORD_BITS{~cross_square[WORD_BITS]}};
    z_p1 <= (z ^ {NORMAL_BITS{z[NORMAL_BITS-1]}}) + {{NORMAL_BITS - 1{1'b0}}, z[NORMAL_BITS-1]};
  end

  // ---- shifts: an even shift of |N|^2, and how many bits more C is shifted ----
  localparam SHIFTS_AT = 1 + `PHONG_LEADING_ZEROS_LATENCY;  // cycles from the input to the counts

  wire [COUNT_BITS-1:0] square_zeros_p3;
  wire [COUNT_BITS-1:0] cross_zeros_p3;
  wire [COUNT_BITS-1:0] even_p3 = {square_zeros_p3[COUNT_BITS-1:1], 1'b0};
  reg [COUNT_BITS-1:0] even_p4;
  reg [COUNT_BITS:0] more_p4;           // two's complement
  reg [3:0] more_p5;                    // more_p4 clamped to 0 .. 15
  reg [COUNT_BITS-1:0] cross_shift_p5;  // whole shift of C

  wire [3:0] more_clamped =
      more_p4[COUNT_BITS] ? 4'd0 : |more_p4[COUNT_BITS-1:4] ? 4'd15 : more_p4[3:0];

  leading_zeros #(
      .BITS(WORD_BITS),
      .COUNT_BITS(COUNT_BITS)
  ) u_square_zeros (
      .clk  (clk),
      .word (square_p1),
      .count(square_zeros_p3)
  );

  leading_zeros #(
      .BITS(WORD_BITS),
      .COUNT_BITS(COUNT_BITS)
  ) u_cross_zeros (
      .clk  (clk),
      .word (cross_p1),
      .count(cross_zeros_p3)
  );

  always @(posedge clk) begin
    even_p4 <= even_p3;
    more_p4 <= {1'b0, cross_zeros_p3} - {1'b0, even_p3};
    more_p5 <= more_clamped;
    cross_shift_p5 <= even_p4 + {{COUNT_BITS - 4{1'b0}}, more_clamped};
  end

  wire unused_zeros = &{1'b0, square_zeros_p3[0]};

  // ---- align: |N|^2 and C by their shifts, |Zn| by half the even shift ----
  localparam ALIGN_AT = SHIFTS_AT + `PHONG_LEFT_SHIFTER_LATENCY;  // cycles to the aligned |N|^2

  wire [WORD_BITS-1:0] square_p3;
  wire [NORMAL_BITS-1:0] z_p3;
  wire [WORD_BITS-1:0] cross_p5;
  wire [WORD_BITS-1:0] square_p5;
  wire [NORMAL_BITS-1:0] z_p5;
  wire [WORD_BITS-1:0] cross_p7;
  wire [MANTISSA_BITS-1:0] z_p7;  // u1.17

  delay #(
      .BITS  (WORD_BITS + NORMAL_BITS),
      .CYCLES(`PHONG_LEADING_ZEROS_LATENCY)
  ) u_words (
      .clk(clk),
      .in ({square_p1, z_p1}),
      .out({square_p3, z_p3})
  );

  delay #(
      .BITS  (WORD_BITS),
      .CYCLES(`PHONG_LEADING_ZEROS_LATENCY + 2)
  ) u_cross (
      .clk(clk),
      .in (cross_p1),
      .out(cross_p5)
  );

  left_shifter #(
      .BITS(WORD_BITS),
      .COUNT_BITS(COUNT_BITS)
  ) u_square_shifter (
      .clk(clk),
      .word(square_p3),
      .count(even_p3),
      .shifted(square_p5)
  );

  left_shifter #(
      .BITS(NORMAL_BITS),
      .COUNT_BITS(COUNT_BITS - 1)
  ) u_z_shifter (
      .clk(clk),
      .word(z_p3),
      .count(even_p3[COUNT_BITS-1:1]),
      .shifted(z_p5)
  );

  left_shifter #(
      .BITS(WORD_BITS),
      .COUNT_BITS(COUNT_BITS)
  ) u_cross_shifter (
      .clk(clk),
      .word(cross_p5),
      .count(cross_shift_p5),
      .shifted(cross_p7)
  );

  round_saturate #(
      .IN_BITS  (NORMAL_BITS),
      .DROP     (NORMAL_FRACTION - MANTISSA_FRACTION),
      .OUT_BITS (MANTISSA_BITS),
      .IS_SIGNED(0)
  ) u_z (
      .clk(clk),
      .in (z_p5),
      .out(z_p7)
  );

  localparam PART_DROP = WORD_BITS - MANTISSA_BITS;  // low bits of C cut off

  wire unused_words = &{1'b0, square_p5[WORD_BITS-OPERAND_BITS-1:0], cross_p7[PART_DROP-1:0]};

  // ---- root ----
  localparam ROOT_AT = ALIGN_AT + `PHONG_INVERSE_SQRT_LATENCY;  // cycles to 1/|N|

  wire [OPERAND_BITS-1:0] operand = square_p5[WORD_BITS-1-:OPERAND_BITS];  // u2.20, |N|^2
  wire [ROOT_BITS-1:0] root;                                               // u0.18, 1/|N|

  inverse_sqrt u_inverse_sqrt (
      .clk(clk),
      .operand(operand),
      .root(root)
  );

  // ---- cosine: |Zn| / |N| ----
  wire [MANTISSA_BITS-1:0] z_root;
  wire [MANTISSA_BITS+ROOT_BITS-1:0] cosine_product;
  wire [COSINE_BITS-1:0] cosine_early;

  delay #(
      .BITS  (MANTISSA_BITS),
      .CYCLES(ROOT_AT - ALIGN_AT - `PHONG_ROUND_SATURATE_LATENCY)
  ) u_z_wait (
      .clk(clk),
      .in (z_p7),
      .out(z_root)
  );

  multiplier #(
      .A_BITS  (MANTISSA_BITS),
      .B_BITS  (ROOT_BITS),
      .A_SIGNED(0),
      .B_SIGNED(0)
  ) u_cosine_product (
      .clk(clk),
      .a(z_root),
      .b(root),
      .product(cosine_product)
  );

  round_saturate #(
      .IN_BITS  (MANTISSA_BITS + ROOT_BITS),
      .DROP     (MANTISSA_FRACTION + ROOT_BITS - COSINE_BITS),
      .OUT_BITS (COSINE_BITS),
      .IS_SIGNED(0)
  ) u_cosine (
      .clk(clk),
      .in (cosine_product),
      .out(cosine_early)
  );

  delay #(
      .BITS  (COSINE_BITS),
      .CYCLES(LATENCY - ROOT_AT - `PHONG_MULTIPLIER_LATENCY - `PHONG_ROUND_SATURATE_LATENCY)
  ) u_cosine_wait (
      .clk(clk),
      .in (cosine_early),
      .out(cosine)
  );

  // ---- versine: 2 C / |N|^2 ----
  // Cycles from the input to 1/|N|^2 and to its product with C.
  localparam RECIPROCAL_AT = ROOT_AT + `PHONG_MULTIPLIER_LATENCY + `PHONG_ROUND_SATURATE_LATENCY;
  localparam PRODUCT_AT = RECIPROCAL_AT + `PHONG_MULTIPLIER_LATENCY;
  localparam PRODUCT_BITS = MANTISSA_BITS + ROOT_BITS;

  wire [2*ROOT_BITS-1:0] root_square;
  wire [ROOT_BITS-1:0] reciprocal;  // u0.18, 1/|N|^2
  wire [MANTISSA_BITS-1:0] part;    // u2.16, aligned C
  wire [3:0] more;                  // bits that C was shifted more than |N|^2
  wire [PRODUCT_BITS-1:0] product;
  reg [PRODUCT_BITS-1:0] coarse;
  reg [1:0] fine;
  reg [PRODUCT_BITS-1:0] shifted;

  multiplier #(
      .A_BITS  (ROOT_BITS),
      .B_BITS  (ROOT_BITS),
      .A_SIGNED(0),
      .B_SIGNED(0)
  ) u_root_square (
      .clk(clk),
      .a(root),
      .b(root),
      .product(root_square)
  );

  round_saturate #(
      .IN_BITS  (2 * ROOT_BITS),
      .DROP     (ROOT_BITS),
      .OUT_BITS (ROOT_BITS),
      .IS_SIGNED(0)
  ) u_reciprocal (
      .clk(clk),
      .in (root_square),
      .out(reciprocal)
  );

  delay #(
      .BITS  (MANTISSA_BITS),
      .CYCLES(RECIPROCAL_AT - ALIGN_AT - 2)
  ) u_part (
      .clk(clk),
      .in (cross_p7[WORD_BITS-1-:MANTISSA_BITS]),
      .out(part)
  );

  delay #(
      .BITS  (4),
      .CYCLES(PRODUCT_AT - SHIFTS_AT - 2)
  ) u_more (
      .clk(clk),
      .in (more_p5),
      .out(more)
  );

  multiplier #(
      .A_BITS  (MANTISSA_BITS),
      .B_BITS  (ROOT_BITS),
      .A_SIGNED(0),
      .B_SIGNED(0)
  ) u_product (
      .clk(clk),
      .a(part),
      .b(reciprocal),
      .product(product)
  );

  always @(posedge clk) begin
    coarse <= product >> {more[3:2], 2'b00};
    fine <= more[1:0];
    shifted <= coarse >> fine;
  end

  // The aligned C has two integer bits; the factor 2 takes one bit from the fraction.
  round_saturate #(
      .IN_BITS  (PRODUCT_BITS),
      .DROP     (MANTISSA_BITS - 2 + ROOT_BITS - 1 - VERSINE_BITS),
      .OUT_BITS (VERSINE_BITS),
      .IS_SIGNED(0)
  ) u_versine (
      .clk(clk),
      .in (shifted),
      .out(versine)
  );

endmodule

`default_nettype wire
