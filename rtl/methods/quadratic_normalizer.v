// quadratic_normalizer: cos(i) = Zn / |N| and 1 - cos(s) = 2 |N x h|^2 / |N|^2 from Zn and the two
// squares, which are interpolated themselves (after Duff 1979): with 1/|N| three products, where
// the normalizer and the reflection need eleven.
// The squares are shifted together until |N|^2 is in [1, 4), that of the part across h further, by
// up to 15, so that a small versine keeps its bits.
// One pixel a clock; latency below. |N|^2 = 0 gives an unspecified but defined result.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module quadratic_normalizer (
    input  wire                           clk,
    input  wire                           two_sided,  // 1: shade |Zn|
    input  wire [`PHONG_NORMAL_BITS-1:0]  z,          // s1.30, Zn |N|
    input  wire [`PHONG_SQUARED_BITS-1:0] square,     // s2.42, |N|^2
    input  wire [`PHONG_SQUARED_BITS-1:0] cross_square,      // s2.42, |N x h|^2
    // u0.22, 1 - cos(s); all ones where cos(s) <= 0
    output wire [`PHONG_VERSINE_BITS-1:0] versine,
    output wire [`PHONG_COSINE_BITS-1:0]  cosine,     // u0.18, |Zn| = cos(i)
    output wire                           lit         // Zn > 0 (two-sided: Zn not 0), exact
);

  localparam NORMAL_BITS       = `PHONG_NORMAL_BITS;
  localparam NORMAL_FRACTION   = `PHONG_NORMAL_FRACTION;
  localparam SQUARED_BITS      = `PHONG_SQUARED_BITS;
  localparam MANTISSA_BITS     = `PHONG_QUADRATIC_MANTISSA_BITS;
  localparam MANTISSA_FRACTION = `PHONG_QUADRATIC_MANTISSA_FRACTION;
  localparam OPERAND_BITS      = `PHONG_ROOT_OPERAND_BITS;
  localparam ROOT_BITS         = `PHONG_ROOT_BITS;  // all of them fraction
  localparam COSINE_BITS       = `PHONG_COSINE_BITS;  // all of them fraction
  localparam VERSINE_BITS      = `PHONG_VERSINE_BITS;  // all of them fraction
  localparam LATENCY           = `PHONG_QUADRATIC_NORMALIZER_LATENCY;

  // ---- lit: decided on the interpolated Zn itself ----
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

  // ---- clamp: what rounding took below 0 is 0 ----
  localparam WORD_BITS = SQUARED_BITS - 1;
  localparam COUNT_BITS = $clog2(WORD_BITS + 1);

  reg [WORD_BITS-1:0] square_p1;
  reg [WORD_BITS-1:0] cross_p1;
  reg [NORMAL_BITS-1:0] z_p1;

  always @(posedge clk) begin
    square_p1 <= square[WORD_BITS-1:0] & {WORD_BITS{~square[WORD_BITS]}};
    cross_p1 <= cross_square[WORD_BITS-1:0] & {WORD_BITS{~cross_square[WORD_BITS]}};
    z_p1 <= (z ^ {NORMAL_BITS{z[NORMAL_BITS-1]}}) + {{NORMAL_BITS - 1{1'b0}}, z[NORMAL_BITS-1]};
  end

  // ---- shifts: an even one for |N|^2; how much more for the other ----
  localparam SHIFTS_AT = 1 + `PHONG_LEADING_ZEROS_LATENCY;

  wire [COUNT_BITS-1:0] square_zeros_p3;
  wire [COUNT_BITS-1:0] cross_zeros_p3;
  wire [COUNT_BITS-1:0] even_p3 = {square_zeros_p3[COUNT_BITS-1:1], 1'b0};
  reg [COUNT_BITS-1:0] even_p4;
  reg [COUNT_BITS:0] more_p4;  // two's complement
  reg [3:0] more_p5;
  reg [COUNT_BITS-1:0] cross_shift_p5;

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

  // ---- align ----
  localparam ALIGN_AT = SHIFTS_AT + `PHONG_LEFT_SHIFTER_LATENCY;

  wire [WORD_BITS-1:0] square_p3;
  wire [NORMAL_BITS-1:0] z_p3;
  wire [WORD_BITS-1:0] cross_p5;
  wire [WORD_BITS-1:0] square_p5;
  wire [NORMAL_BITS-1:0] z_p5;
  wire [WORD_BITS-1:0] cross_p7;
  wire [MANTISSA_BITS-1:0] z_p7;

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

  localparam PART_DROP = WORD_BITS - MANTISSA_BITS;

  wire unused_words = &{1'b0, square_p5[WORD_BITS-OPERAND_BITS-1:0], cross_p7[PART_DROP-1:0]};

  // ---- root ----
  localparam ROOT_AT = ALIGN_AT + `PHONG_INVERSE_SQRT_LATENCY;

  wire [OPERAND_BITS-1:0] operand = square_p5[WORD_BITS-1-:OPERAND_BITS];
  wire [ROOT_BITS-1:0] root;

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

  // ---- versine: twice the other square by the square of the root ----
  localparam RECIPROCAL_AT = ROOT_AT + `PHONG_MULTIPLIER_LATENCY + `PHONG_ROUND_SATURATE_LATENCY;
  localparam PRODUCT_AT = RECIPROCAL_AT + `PHONG_MULTIPLIER_LATENCY;
  localparam PRODUCT_BITS = MANTISSA_BITS + ROOT_BITS;

  wire [2*ROOT_BITS-1:0] root_square;
  wire [ROOT_BITS-1:0] reciprocal;
  wire [MANTISSA_BITS-1:0] part;
  wire [3:0] more;
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

  // The aligned square has two integer bits; doubling it takes one from the fraction.
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
