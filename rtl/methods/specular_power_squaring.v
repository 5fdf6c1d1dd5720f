// SPDX-License-Identifier: MIT
// specular_power_squaring: cos(s)^n for whole n by repeated squaring: cos(s)^1, ^2, ^4 .. ^128 and
// the product of those whose bit of n is 1.
// n is rounded to a whole number, half up: 1.5 gives the square. For n > 128 only bit 7 counts;
// n = 0 gives the largest code.
// `exponent` comes PHONG_EXPONENT_LATENCY cycles after its `versine`, 1 cycle before cos(s).
// Latency: LATENCY cycles (PHONG_SPECULAR_POWER_SQUARING_LATENCY in latency.vh; 39 by default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module specular_power_squaring (
    input  wire                            clk,
    input  wire [`PHONG_VERSINE_BITS-1:0]  versine,   // u0.22, 1 - cos(s)
    input  wire [`PHONG_EXPONENT_BITS-1:0] exponent,  // u8.9, n, later than `versine`
    output wire [`PHONG_POWER_BITS-1:0]    power      // u0.18, cos(s)^n
);

  localparam EXPONENT_BITS     = `PHONG_EXPONENT_BITS;
  localparam EXPONENT_FRACTION = `PHONG_EXPONENT_FRACTION;
  localparam POWER_BITS        = `PHONG_POWER_BITS;  // all of them fraction
  localparam LATENCY           = `PHONG_SPECULAR_POWER_SQUARING_LATENCY;

  localparam N_BITS = EXPONENT_BITS - EXPONENT_FRACTION;  // integer bits of n
  localparam STAGES = N_BITS - 1;                         // squarings
  localparam STAGE_LATENCY = `PHONG_SQUARING_STAGE_LATENCY;

  // ---- whole: n rounded, beside cos(s) ----
  // At the input of stage j:
  wire [POWER_BITS-1:0] base[0:STAGES];    // u0.18, cos(s)^(2^j)
  wire [POWER_BITS-1:0] result[0:STAGES];  // u0.18, product of the powers of bits 0 to j - 1 of n
  wire [STAGES:0] some;                    // one of the bits 0 to j - 1 of n is 1
  wire [N_BITS-1:0] n[0:STAGES];           // n >> j: bit 0 is that of stage j
  reg [N_BITS-1:0] n_p3;                   // n rounded

  specular_cosine u_cosine (
      .clk(clk),
      .versine(versine),
      .cosine(base[0])
  );

  always @(posedge clk) begin
    n_p3 <= exponent[EXPONENT_BITS-1:EXPONENT_FRACTION]
        + {{N_BITS - 1{1'b0}}, exponent[EXPONENT_FRACTION-1]};
  end

  wire unused = &{1'b0, exponent[EXPONENT_FRACTION-2:0]};

  assign result[0] = {POWER_BITS{1'b1}};
  assign some[0] = 1'b0;
  assign n[0] = n_p3;

  // ---- square, times: square the base; multiply the result by the base where bit j of n is 1 ----
  genvar j;
  generate
    for (j = 0; j < STAGES; j = j + 1) begin : gen_stage
      wire [2*POWER_BITS-1:0] square_p2;
      wire [POWER_BITS-1:0] square_p4;
      wire [POWER_BITS-1:0] base_p4;
      wire [POWER_BITS-1:0] result_p4;
      wire [POWER_BITS-1:0] product_p4;
      wire some_p4;
      wire [N_BITS-1:0] n_p4;
      reg [POWER_BITS-1:0] base_p5;
      reg [POWER_BITS-1:0] result_p5;
      reg some_p5;
      reg [N_BITS-1:0] n_p5;

      multiplier #(
          .A_BITS  (POWER_BITS),
          .B_BITS  (POWER_BITS),
          .A_SIGNED(0),
          .B_SIGNED(0)
      ) u_square (
          .clk(clk),
          .a(base[j]),
          .b(base[j]),
          .product(square_p2)
      );

      round_saturate #(
          .IN_BITS  (2 * POWER_BITS),
          .DROP     (POWER_BITS),
          .OUT_BITS (POWER_BITS),
          .IS_SIGNED(0)
      ) u_square_round (
          .clk(clk),
          .in (square_p2),
          .out(square_p4)
      );

      if (j == 0) begin : gen_first
        assign product_p4 = base_p4;
      end else begin : gen_product
        wire [2*POWER_BITS-1:0] product_p2;

        multiplier #(
            .A_BITS  (POWER_BITS),
            .B_BITS  (POWER_BITS),
            .A_SIGNED(0),
            .B_SIGNED(0)
        ) u_product (
            .clk(clk),
            .a(base[j]),
            .b(result[j]),
            .product(product_p2)
        );

        round_saturate #(
            .IN_BITS  (2 * POWER_BITS),
            .DROP     (POWER_BITS),
            .OUT_BITS (POWER_BITS),
            .IS_SIGNED(0)
        ) u_product_round (
            .clk(clk),
            .in (product_p2),
            .out(product_p4)
        );
      end

      delay #(
          .BITS  (2 * POWER_BITS + 1 + N_BITS),
          .CYCLES(STAGE_LATENCY - 1)
      ) u_wait (
          .clk(clk),
          .in ({base[j], result[j], some[j], n[j]}),
          .out({base_p4, result_p4, some_p4, n_p4})
      );

      always @(posedge clk) begin
        base_p5 <= square_p4;
        result_p5 <= ~n_p4[0] ? result_p4 : some_p4 ? product_p4 : base_p4;
        some_p5 <= some_p4 | n_p4[0];
        n_p5 <= {1'b0, n_p4[N_BITS-1:1]};
      end

      assign base[j+1] = base_p5;
      assign result[j+1] = result_p5;
      assign some[j+1] = some_p5;
      assign n[j+1] = n_p5;
    end
  endgenerate

  // ---- last: bit 7 of n. It is the only one of n = 128 that is 1, so no product is needed ----
  reg [POWER_BITS-1:0] power_out;

  always @(posedge clk) power_out <= n[STAGES][0] ? base[STAGES] : result[STAGES];

  wire unused_last = &{1'b0, some[STAGES], n[STAGES][N_BITS-1:1]};

  assign power = power_out;

endmodule

`default_nettype wire
