// SPDX-License-Identifier: MIT
// specular_power_schlick: Schlick's approximation (1994) in place of cos(s)^n,
//   x / (n - n x + x) = x / (1 + (n - 1) v), x = cos(s), v = 1 - x.
// At cos(s) = 1 value and slope are those of cos(s)^n. Elsewhere the approximation falls more
// slowly: it is a different curve, and the picture visibly differs.
// The quotient is a product with the reciprocal of the denominator, from a piecewise linear table.
// n may be fractional; n below 1 is taken as 1.
// Latency: LATENCY cycles (PHONG_SPECULAR_POWER_SCHLICK_LATENCY in latency.vh; 22 by default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module specular_power_schlick (
    input  wire                            clk,
    input  wire [`PHONG_VERSINE_BITS-1:0]  versine,   // u0.22, v = 1 - cos(s)
    input  wire [`PHONG_EXPONENT_BITS-1:0] exponent,  // u8.9, n, in the cycle of `versine`
    output wire [`PHONG_POWER_BITS-1:0]    power      // u0.18, stands for cos(s)^n
);

  localparam VERSINE_BITS      = `PHONG_VERSINE_BITS;
  localparam EXPONENT_BITS     = `PHONG_EXPONENT_BITS;
  localparam EXPONENT_FRACTION = `PHONG_EXPONENT_FRACTION;
  localparam POWER_BITS        = `PHONG_POWER_BITS;             // all of them fraction
  localparam INDEX_BITS        = `PHONG_RECIPROCAL_INDEX_BITS;  // 2^INDEX_BITS segments of 1/m
  localparam VALUE_BITS        = `PHONG_RECIPROCAL_VALUE_BITS;  // all of them fraction
  localparam SLOPE_BITS        = `PHONG_RECIPROCAL_SLOPE_BITS;  // in units of 2^-VALUE_BITS
  localparam LATENCY           = `PHONG_SPECULAR_POWER_SCHLICK_LATENCY;

  localparam WHOLE_BITS = EXPONENT_BITS - EXPONENT_FRACTION;  // integer bits of n
  localparam PRODUCT_BITS = EXPONENT_BITS + POWER_BITS;
  localparam DENOMINATOR_BITS = WHOLE_BITS + POWER_BITS;      // POWER_BITS of them fraction

  // ---- denominator: 1 + (n - 1) v ----
  reg [EXPONENT_BITS-1:0] n_less_p1;  // u8.9, n - 1, or 0 if n < 1
  wire [EXPONENT_BITS-1:0] n_less_p2;
  wire [POWER_BITS-1:0] versine_p2;
  wire [PRODUCT_BITS-1:0] product_p4;
  reg [DENOMINATOR_BITS-1:0] denominator_p5;

  wire [WHOLE_BITS-1:0] whole = exponent[EXPONENT_BITS-1:EXPONENT_FRACTION];

  always @(posedge clk) begin
    n_less_p1 <= whole == 0
        ? {EXPONENT_BITS{1'b0}} : {whole - 1'b1, exponent[EXPONENT_FRACTION-1:0]};
  end

  delay #(
      .BITS  (EXPONENT_BITS),
      .CYCLES(`PHONG_ROUND_SATURATE_LATENCY - 1)
  ) u_n_less (
      .clk(clk),
      .in (n_less_p1),
      .out(n_less_p2)
  );

  round_saturate #(
      .IN_BITS  (VERSINE_BITS),
      .DROP     (VERSINE_BITS - POWER_BITS),
      .OUT_BITS (POWER_BITS),
      .IS_SIGNED(0)
  ) u_versine (
      .clk(clk),
      .in (versine),
      .out(versine_p2)
  );

  multiplier #(
      .A_BITS  (EXPONENT_BITS),
      .B_BITS  (POWER_BITS),
      .A_SIGNED(0),
      .B_SIGNED(0)
  ) u_product (
      .clk(clk),
      .a(n_less_p2),
      .b(versine_p2),
      .product(product_p4)
  );

  always @(posedge clk) begin
    denominator_p5 <= {product_p4[PRODUCT_BITS-1-:WHOLE_BITS] + 1'b1,
                       product_p4[EXPONENT_FRACTION+:POWER_BITS]};
  end

  wire unused_product = &{1'b0, product_p4[EXPONENT_FRACTION-1:0]};

  // ---- normalize: denominator = 2^e m, 1 <= m < 2 ----
  localparam K_BITS = $clog2(WHOLE_BITS + 1);

  wire [K_BITS-1:0] k_p7;            // leading zeros, WHOLE_BITS - 1 - e
  wire [DENOMINATOR_BITS-1:0] denominator_p7;
  wire [DENOMINATOR_BITS-1:0] m_p9;  // m, its leading one in the top bit

  leading_zeros #(
      .BITS(WHOLE_BITS),
      .COUNT_BITS(K_BITS)
  ) u_leading_zeros (
      .clk  (clk),
      .word (denominator_p5[DENOMINATOR_BITS-1-:WHOLE_BITS]),
      .count(k_p7)
  );

  delay #(
      .BITS  (DENOMINATOR_BITS),
      .CYCLES(`PHONG_LEADING_ZEROS_LATENCY)
  ) u_denominator (
      .clk(clk),
      .in (denominator_p5),
      .out(denominator_p7)
  );

  left_shifter #(
      .BITS(DENOMINATOR_BITS),
      .COUNT_BITS(K_BITS)
  ) u_m (
      .clk(clk),
      .word(denominator_p7),
      .count(k_p7),
      .shifted(m_p9)
  );

  wire unused_m = &{1'b0, m_p9[DENOMINATOR_BITS-1]};

  // ---- reciprocal: 1/m = value - slope * offset ----
  localparam OFFSET_BITS = DENOMINATOR_BITS - 1 - INDEX_BITS;

  wire [VALUE_BITS-1:0] value_p11;
  wire [SLOPE_BITS-1:0] slope_p11;
  wire [OFFSET_BITS-1:0] offset_p11;
  wire [SLOPE_BITS+OFFSET_BITS-1:0] fall_p13;
  wire [VALUE_BITS-1:0] value_p13;
  reg [VALUE_BITS-1:0] line_p14;
  wire [POWER_BITS-1:0] reciprocal_p16;  // u0.18, 1/m

  rom #(
      .ADDRESS_BITS(INDEX_BITS),
      .WORD_BITS(VALUE_BITS + SLOPE_BITS),
      .CONTENTS(`PHONG_RECIPROCAL_TABLE)
  ) u_table (
      .clk(clk),
      .address(m_p9[DENOMINATOR_BITS-2-:INDEX_BITS]),
      .word({value_p11, slope_p11})
  );

  delay #(
      .BITS  (OFFSET_BITS),
      .CYCLES(`PHONG_ROM_LATENCY)
  ) u_offset (
      .clk(clk),
      .in (m_p9[OFFSET_BITS-1:0]),
      .out(offset_p11)
  );

  multiplier #(
      .A_BITS  (SLOPE_BITS),
      .B_BITS  (OFFSET_BITS),
      .A_SIGNED(0),
      .B_SIGNED(0)
  ) u_slope (
      .clk(clk),
      .a(slope_p11),
      .b(offset_p11),
      .product(fall_p13)
  );

  delay #(
      .BITS  (VALUE_BITS),
      .CYCLES(`PHONG_MULTIPLIER_LATENCY)
  ) u_value (
      .clk(clk),
      .in (value_p11),
      .out(value_p13)
  );

  always @(posedge clk) begin
    line_p14 <= value_p13 - {{VALUE_BITS - SLOPE_BITS{1'b0}},
                             fall_p13[SLOPE_BITS+OFFSET_BITS-1:OFFSET_BITS]};
  end

  wire unused_fall = &{1'b0, fall_p13[OFFSET_BITS-1:0]};

  round_saturate #(
      .IN_BITS  (VALUE_BITS),
      .DROP     (VALUE_BITS - POWER_BITS),
      .OUT_BITS (POWER_BITS),
      .IS_SIGNED(0)
  ) u_reciprocal (
      .clk(clk),
      .in (line_p14),
      .out(reciprocal_p16)
  );

  // ---- quotient: x / m, shifted by e, rounded ----
  // Cycles from the input to x / m, to 1/m and to the leading zeros.
  localparam QUOTIENT_AT = LATENCY - `PHONG_ROUND_SATURATE_LATENCY - 2;
  localparam RECIPROCAL_AT = QUOTIENT_AT - `PHONG_MULTIPLIER_LATENCY;
  localparam K_AT = `PHONG_ROUND_SATURATE_LATENCY + `PHONG_MULTIPLIER_LATENCY + 1
      + `PHONG_LEADING_ZEROS_LATENCY;

  wire [POWER_BITS-1:0] cosine_p3;
  wire [POWER_BITS-1:0] cosine_p16;
  wire [K_BITS-1:0] k_p18;
  wire [2*POWER_BITS-1:0] quotient_p18;
  reg [2*POWER_BITS-1:0] coarse_p19;
  reg [1:0] fine_p19;
  reg [2*POWER_BITS-1:0] shifted_p20;

  specular_cosine u_cosine (
      .clk(clk),
      .versine(versine),
      .cosine(cosine_p3)
  );

  delay #(
      .BITS  (POWER_BITS),
      .CYCLES(RECIPROCAL_AT - `PHONG_SPECULAR_COSINE_LATENCY)
  ) u_cosine_wait (
      .clk(clk),
      .in (cosine_p3),
      .out(cosine_p16)
  );

  delay #(
      .BITS  (K_BITS),
      .CYCLES(QUOTIENT_AT - K_AT)
  ) u_k (
      .clk(clk),
      .in (k_p7),
      .out(k_p18)
  );

  multiplier #(
      .A_BITS  (POWER_BITS),
      .B_BITS  (POWER_BITS),
      .A_SIGNED(0),
      .B_SIGNED(0)
  ) u_quotient (
      .clk(clk),
      .a(cosine_p16),
      .b(reciprocal_p16),
      .product(quotient_p18)
  );

  // k = 7 - e in three bits, so e is the complement of k.
  wire [2:0] e_p18 = ~k_p18[2:0];
  wire unused_k = &{1'b0, k_p18[K_BITS-1:3]};

  always @(posedge clk) begin
    coarse_p19 <= e_p18[2] ? {4'b0000, quotient_p18[2*POWER_BITS-1:4]} : quotient_p18;
    fine_p19 <= e_p18[1:0];
    shifted_p20 <= coarse_p19 >> fine_p19;
  end

  round_saturate #(
      .IN_BITS  (2 * POWER_BITS),
      .DROP     (POWER_BITS),
      .OUT_BITS (POWER_BITS),
      .IS_SIGNED(0)
  ) u_power (
      .clk(clk),
      .in (shifted_p20),
      .out(power)
  );

endmodule

`default_nettype wire
