// SPDX-License-Identifier: MIT
// specular_power_tables: cos(s)^n = 2^(-n * -log2(1 - v)), v = 1 - cos(s).
// Logarithm and exponential are piecewise linear tables; n may be fractional. n = 1 bypasses them:
// the result is cos(s) itself, rounded (specular_cosine).
// `exponent` comes EXPONENT_LATENCY cycles after its `versine`.
// Latency: LATENCY cycles from `versine` (PHONG_SPECULAR_POWER_TABLES_LATENCY in latency.vh; 30 by
// default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module specular_power_tables (
    input  wire                            clk,
    input  wire [`PHONG_VERSINE_BITS-1:0]  versine,   // u0.22, v = 1 - cos(s)
    input  wire [`PHONG_EXPONENT_BITS-1:0] exponent,  // u8.9, n, later than `versine`
    output wire [`PHONG_POWER_BITS-1:0]    power      // u0.18, cos(s)^n
);

  localparam VERSINE_BITS      = `PHONG_VERSINE_BITS;
  localparam LOG_INDEX_BITS    = `PHONG_LOG_INDEX_BITS;     // 2^LOG_INDEX_BITS segments
  localparam LOG_VALUE_BITS    = `PHONG_LOG_VALUE_BITS;     // all of them fraction
  localparam LOG_SLOPE_BITS    = `PHONG_LOG_SLOPE_BITS;     // in units of 2^-LOG_VALUE_BITS
  localparam LOG_MANTISSA_BITS = `PHONG_LOG_MANTISSA_BITS;  // of -log2(cos(s)), times n
  localparam EXPONENT_BITS     = `PHONG_EXPONENT_BITS;
  localparam EXPONENT_FRACTION = `PHONG_EXPONENT_FRACTION;
  localparam LOG_BITS          = `PHONG_POWER_LOG_BITS;     // of n * -log2(cos(s))
  localparam LOG_FRACTION      = `PHONG_POWER_LOG_FRACTION;
  localparam EXP_INDEX_BITS    = `PHONG_EXP_INDEX_BITS;     // 2^EXP_INDEX_BITS segments
  localparam EXP_VALUE_BITS    = `PHONG_EXP_VALUE_BITS;     // all of them fraction
  localparam EXP_SLOPE_BITS    = `PHONG_EXP_SLOPE_BITS;     // in units of 2^-EXP_VALUE_BITS
  localparam POWER_BITS        = `PHONG_POWER_BITS;         // all of them fraction
  localparam OCTAVES           = `PHONG_LOG_OCTAVES;        // 0: cos(s)^n is 0 if cos(s) <= 1/2
  localparam BYPASS            = `PHONG_POWER_BYPASS;       // 0: n is never 1
  localparam CONSTANT          = `PHONG_CONSTANT_EXPONENT;  // 1: n is EXPONENT
  localparam EXPONENT          = `PHONG_CONSTANT_EXPONENT_N;
  localparam LATENCY           = `PHONG_SPECULAR_POWER_TABLES_LATENCY;

  localparam EXPONENT_LATENCY = `PHONG_LOG_LATENCY;  // cycles from `versine` to its `exponent`

  // ---- leading_ones: cos(s) = 2^-e (1 - t), 0 <= t < 1/2; e leading ones of v ----
  // Without octaves e is 0 or 1. Where e is 1 the power is 0, whatever t is.
  localparam E_BITS = OCTAVES ? $clog2(VERSINE_BITS + 1) : 1;
  localparam ONES_LATENCY = OCTAVES ? `PHONG_LEADING_ZEROS_LATENCY : 0;  // cycles to e
  localparam T_LATENCY = OCTAVES ? `PHONG_LEFT_SHIFTER_LATENCY : 0;      // cycles from e to t

  wire [E_BITS-1:0] e_p2;
  wire [VERSINE_BITS-1:0] t_p4;  // u0.22

  generate
    if (OCTAVES) begin : gen_octaves
      wire [VERSINE_BITS-1:0] versine_p2;

      leading_zeros #(
          .BITS(VERSINE_BITS),
          .COUNT_BITS(E_BITS)
      ) u_leading_ones (
          .clk  (clk),
          .word (~versine),
          .count(e_p2)
      );

      delay #(
          .BITS  (VERSINE_BITS),
          .CYCLES(ONES_LATENCY)
      ) u_versine (
          .clk(clk),
          .in (versine),
          .out(versine_p2)
      );

      left_shifter #(
          .BITS(VERSINE_BITS),
          .COUNT_BITS(E_BITS)
      ) u_t (
          .clk(clk),
          .word(versine_p2),
          .count(e_p2),
          .shifted(t_p4)
      );
    end else begin : gen_octave
      assign e_p2 = versine[VERSINE_BITS-1];
      assign t_p4 = {1'b0, versine[VERSINE_BITS-2:0]};
    end
  endgenerate

  // ---- log_lookup: the line of -log2(1 - t) in the segment of t ----
  localparam LOG_OFFSET_BITS = VERSINE_BITS - 1 - LOG_INDEX_BITS;  // place in the segment

  wire [LOG_VALUE_BITS-1:0] log_value_p6;
  wire [LOG_SLOPE_BITS-1:0] log_slope_p6;
  wire [LOG_OFFSET_BITS-1:0] log_offset_p6;

  rom #(
      .ADDRESS_BITS(LOG_INDEX_BITS),
      .WORD_BITS(LOG_VALUE_BITS + LOG_SLOPE_BITS),
      .CONTENTS(`PHONG_LOG_TABLE)
  ) u_log_table (
      .clk(clk),
      .address(t_p4[VERSINE_BITS-2-:LOG_INDEX_BITS]),
      .word({log_value_p6, log_slope_p6})
  );

  delay #(
      .BITS  (LOG_OFFSET_BITS),
      .CYCLES(`PHONG_ROM_LATENCY)
  ) u_log_offset (
      .clk(clk),
      .in (t_p4[LOG_OFFSET_BITS-1:0]),
      .out(log_offset_p6)
  );

  wire unused_t = &{1'b0, t_p4[VERSINE_BITS-1]};  // t < 1/2

  // ---- log_refine: g = -log2(cos s) = e + value + slope * offset ----
  localparam G_BITS = E_BITS + LOG_VALUE_BITS;  // LOG_VALUE_BITS of them fraction

  wire [LOG_SLOPE_BITS+LOG_OFFSET_BITS-1:0] log_rise_p8;
  wire [LOG_VALUE_BITS-1:0] log_value_p8;
  wire [E_BITS-1:0] e_p8;
  reg [G_BITS-1:0] g_p9;

  multiplier #(
      .A_BITS  (LOG_SLOPE_BITS),
      .B_BITS  (LOG_OFFSET_BITS),
      .A_SIGNED(0),
      .B_SIGNED(0)
  ) u_log_slope (
      .clk(clk),
      .a(log_slope_p6),
      .b(log_offset_p6),
      .product(log_rise_p8)
  );

  delay #(
      .BITS  (LOG_VALUE_BITS),
      .CYCLES(`PHONG_MULTIPLIER_LATENCY)
  ) u_log_value (
      .clk(clk),
      .in (log_value_p6),
      .out(log_value_p8)
  );

  delay #(
      .BITS  (E_BITS),
      .CYCLES(T_LATENCY + `PHONG_ROM_LATENCY + `PHONG_MULTIPLIER_LATENCY)
  ) u_e (
      .clk(clk),
      .in (e_p2),
      .out(e_p8)
  );

  always @(posedge clk) begin
    g_p9 <= {e_p8, log_value_p8} + {{G_BITS - LOG_SLOPE_BITS{1'b0}},
                                    log_rise_p8[LOG_SLOPE_BITS+LOG_OFFSET_BITS-1:LOG_OFFSET_BITS]};
  end

  wire unused_rise = &{1'b0, log_rise_p8[LOG_OFFSET_BITS-1:0]};

  // ---- log_normalize: g without its leading zeros, of which at most MOST are dropped ----
  localparam MOST = G_BITS - LOG_MANTISSA_BITS;
  localparam K_BITS = $clog2(MOST + 1);

  wire [K_BITS-1:0] k_p11;  // leading zeros dropped
  wire [G_BITS-1:0] g_p11;
  wire [G_BITS-1:0] mantissa_p13;

  leading_zeros #(
      .BITS(MOST),
      .COUNT_BITS(K_BITS)
  ) u_log_zeros (
      .clk  (clk),
      .word (g_p9[G_BITS-1-:MOST]),
      .count(k_p11)
  );

  delay #(
      .BITS  (G_BITS),
      .CYCLES(`PHONG_LEADING_ZEROS_LATENCY)
  ) u_g (
      .clk(clk),
      .in (g_p9),
      .out(g_p11)
  );

  left_shifter #(
      .BITS(G_BITS),
      .COUNT_BITS(K_BITS)
  ) u_log_mantissa (
      .clk(clk),
      .word(g_p11),
      .count(k_p11),
      .shifted(mantissa_p13)
  );

  wire unused_mantissa = &{1'b0, mantissa_p13[MOST-1:0]};

  // ---- times_exponent: x = n * g, saturated where the power is 0 ----
  localparam N_BITS = LOG_MANTISSA_BITS + EXPONENT_BITS;
  localparam N_DROP = LOG_VALUE_BITS + EXPONENT_FRACTION - LOG_FRACTION - MOST;  // bits cut off
  localparam WIDE_BITS = N_BITS - N_DROP;                                        // the bits kept

  wire [N_BITS-1:0] product_p15;
  wire [K_BITS-1:0] k_p15;
  reg [WIDE_BITS-1:0] coarse_p16;
  reg [1:0] fine_p16;
  reg [WIDE_BITS-1:0] wide_p17;
  reg [LOG_BITS-1:0] x_p18;  // u5.16

  generate
    if (CONSTANT) begin : gen_constant
      constant_multiplier #(
          .BITS(LOG_MANTISSA_BITS),
          .IS_SIGNED(0),
          .CONSTANT(EXPONENT),
          .CONSTANT_BITS(EXPONENT_BITS),
          .LATENCY(`PHONG_TIMES_EXPONENT_LATENCY)
      ) u_times_exponent (
          .clk(clk),
          .word(mantissa_p13[G_BITS-1-:LOG_MANTISSA_BITS]),
          .product(product_p15)
      );
    end else begin : gen_variable
      multiplier #(
          .A_BITS  (LOG_MANTISSA_BITS),
          .B_BITS  (EXPONENT_BITS),
          .A_SIGNED(0),
          .B_SIGNED(0)
      ) u_times_exponent (
          .clk(clk),
          .a(mantissa_p13[G_BITS-1-:LOG_MANTISSA_BITS]),
          .b(exponent),
          .product(product_p15)
      );
    end
  endgenerate

  delay #(
      .BITS  (K_BITS),
      .CYCLES(`PHONG_LEFT_SHIFTER_LATENCY + `PHONG_TIMES_EXPONENT_LATENCY)
  ) u_k (
      .clk(clk),
      .in (k_p11),
      .out(k_p15)
  );

  always @(posedge clk) begin
    coarse_p16 <= product_p15[N_BITS-1:N_DROP] >> {k_p15[K_BITS-1:2], 2'b00};
    fine_p16 <= k_p15[1:0];
    wide_p17 <= coarse_p16 >> fine_p16;
    x_p18 <= wide_p17[LOG_BITS-1:0] | {LOG_BITS{|wide_p17[WIDE_BITS-1:LOG_BITS]}};
  end

  wire unused_product = &{1'b0, product_p15[N_DROP-1:0]};

  // ---- exp_lookup: the line of 2^-f in the segment of f, the fraction of x ----
  localparam EXP_OFFSET_BITS = LOG_FRACTION - EXP_INDEX_BITS;  // place in the segment
  localparam WHOLE_BITS = LOG_BITS - LOG_FRACTION;             // integer part of x

  wire [EXP_VALUE_BITS-1:0] exp_value_p20;
  wire [EXP_SLOPE_BITS-1:0] exp_slope_p20;
  wire [EXP_OFFSET_BITS-1:0] exp_offset_p20;

  rom #(
      .ADDRESS_BITS(EXP_INDEX_BITS),
      .WORD_BITS(EXP_VALUE_BITS + EXP_SLOPE_BITS),
      .CONTENTS(`PHONG_EXP_TABLE)
  ) u_exp_table (
      .clk(clk),
      .address(x_p18[LOG_FRACTION-1-:EXP_INDEX_BITS]),
      .word({exp_value_p20, exp_slope_p20})
  );

  delay #(
      .BITS  (EXP_OFFSET_BITS),
      .CYCLES(`PHONG_ROM_LATENCY)
  ) u_exp_offset (
      .clk(clk),
      .in (x_p18[EXP_OFFSET_BITS-1:0]),
      .out(exp_offset_p20)
  );

  // ---- exp_refine: 2^-f = value - slope * offset ----
  wire [EXP_SLOPE_BITS+EXP_OFFSET_BITS-1:0] exp_fall_p24;
  wire [EXP_VALUE_BITS-1:0] exp_value_p24;
  wire [WHOLE_BITS-1:0] whole_p25;
  reg [EXP_VALUE_BITS-1:0] line_p25;

  slope_multiplier #(
      .A_BITS(EXP_SLOPE_BITS),
      .B_BITS(EXP_OFFSET_BITS)
  ) u_exp_slope (
      .clk(clk),
      .a(exp_slope_p20),
      .b(exp_offset_p20),
      .product(exp_fall_p24)
  );

  delay #(
      .BITS  (EXP_VALUE_BITS),
      .CYCLES(`PHONG_NARROW_MULTIPLIER_LATENCY)
  ) u_exp_value (
      .clk(clk),
      .in (exp_value_p20),
      .out(exp_value_p24)
  );

  delay #(
      .BITS  (WHOLE_BITS),
      .CYCLES(`PHONG_ROM_LATENCY + `PHONG_NARROW_MULTIPLIER_LATENCY + 1)
  ) u_whole (
      .clk(clk),
      .in (x_p18[LOG_BITS-1:LOG_FRACTION]),
      .out(whole_p25)
  );

  always @(posedge clk) begin
    line_p25 <= exp_value_p24 - {{EXP_VALUE_BITS - EXP_SLOPE_BITS{1'b0}},
        exp_fall_p24[EXP_SLOPE_BITS+EXP_OFFSET_BITS-1:EXP_OFFSET_BITS]};
  end

  wire unused_fall = &{1'b0, exp_fall_p24[EXP_OFFSET_BITS-1:0]};

  // ---- exp_shift: 2^-x = 2^-f shifted by the integer part of x, rounded ----
  reg [EXP_VALUE_BITS-1:0] coarse_p26;
  reg [1:0] fine_p26;
  reg [EXP_VALUE_BITS-1:0] shifted_p27;
  wire [POWER_BITS-1:0] power_p29;

  always @(posedge clk) begin
    coarse_p26 <= line_p25 >> {whole_p25[WHOLE_BITS-1:2], 2'b00};
    fine_p26 <= whole_p25[1:0];
    shifted_p27 <= coarse_p26 >> fine_p26;
  end

  round_saturate #(
      .IN_BITS  (EXP_VALUE_BITS),
      .DROP     (EXP_VALUE_BITS - POWER_BITS),
      .OUT_BITS (POWER_BITS),
      .IS_SIGNED(0)
  ) u_power (
      .clk(clk),
      .in (shifted_p27),
      .out(power_p29)
  );

  // ---- bypass: n = 1 ----
  generate
    if (BYPASS) begin : gen_bypass
      wire [POWER_BITS-1:0] cosine_p3;
      wire [POWER_BITS-1:0] cosine_p29;
      wire bypass_p29;
      reg [POWER_BITS-1:0] result_p30;

      specular_cosine u_cosine (
          .clk(clk),
          .versine(versine),
          .cosine(cosine_p3)
      );

      delay #(
          .BITS  (POWER_BITS),
          .CYCLES(LATENCY - `PHONG_SPECULAR_COSINE_LATENCY - 1)
      ) u_cosine_wait (
          .clk(clk),
          .in (cosine_p3),
          .out(cosine_p29)
      );

      delay #(
          .BITS  (1),
          .CYCLES(LATENCY - EXPONENT_LATENCY - 1)
      ) u_bypass (
          .clk(clk),
          .in (exponent == {{EXPONENT_BITS - EXPONENT_FRACTION - 1{1'b0}}, 1'b1,
                            {EXPONENT_FRACTION{1'b0}}}),
          .out(bypass_p29)
      );

      always @(posedge clk) result_p30 <= bypass_p29 ? cosine_p29 : power_p29;

      assign power = result_p30;
    end else begin : gen_no_bypass
      assign power = power_p29;
    end
  endgenerate

endmodule

`default_nettype wire
