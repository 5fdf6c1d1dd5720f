// SPDX-License-Identifier: MIT
// colour_channel: Phong 1975, eq. (3), for one of red, green and blue: terms, sum, clamp and code,
//   S = Cp d + Cp (1 - d) cos(i) + W(i) cos(s)^n, code = floor(255 clamp(S, 0, 1) + 1/2).
// Cp d is the ambient coefficient, Cp (1 - d) the diffuse one.
// Latency: LATENCY cycles from `cosine` and `lit` (PHONG_COLOUR_CHANNEL_LATENCY in latency.vh; 7 by
// default).
// Throughput: one result per cycle.
// Reset: none; the tables are undefined until written.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module colour_channel #(
    parameter MATERIAL_BITS        = `PHONG_MATERIAL_BITS,
    parameter COEFFICIENT_BITS     = `PHONG_COEFFICIENT_BITS,
    parameter COEFFICIENT_FRACTION = `PHONG_COEFFICIENT_FRACTION,
    parameter COSINE_BITS          = `PHONG_COSINE_BITS,
    parameter COSINE_FRACTION      = `PHONG_COSINE_FRACTION,
    parameter SPECULAR_BITS        = `PHONG_WEIGHT_BITS + `PHONG_POWER_BITS,
    parameter SPECULAR_FRACTION    = `PHONG_WEIGHT_FRACTION + `PHONG_POWER_FRACTION,
    parameter INTENSITY_BITS       = `PHONG_INTENSITY_BITS,        // S, clamped and cut
    parameter INTENSITY_FRACTION   = `PHONG_INTENSITY_FRACTION,
    parameter COLOUR_BITS          = `PHONG_COLOUR_BITS,
    parameter SPECULAR             = `PHONG_SPECULAR,              // 0: the term is left out
    parameter DIFFUSE              = `PHONG_DIFFUSE,               // 0: the term is left out
    parameter AMBIENT              = `PHONG_AMBIENT,               // 0: the term is left out
    parameter CONSTANT_AMBIENT     = `PHONG_CONSTANT_AMBIENT,      // 1: Cp d is AMBIENT_CODE
    parameter AMBIENT_CODE         = `PHONG_CONSTANT_AMBIENT_RED,  // u1.16
    parameter CONSTANT_DIFFUSE     = `PHONG_CONSTANT_DIFFUSE,      // 1: Cp (1 - d) is DIFFUSE_CODE
    parameter DIFFUSE_CODE         = `PHONG_CONSTANT_DIFFUSE_RED,  // u1.16
    parameter LATENCY              = `PHONG_COLOUR_CHANNEL_LATENCY
) (
    input wire clk,

    // write port of the coefficients
    input wire                        write_ambient,  // Cp d
    input wire                        write_diffuse,  // Cp (1 - d)
    input wire [MATERIAL_BITS-1:0]    write_address,  // material
    input wire [COEFFICIENT_BITS-1:0] write_word,     // u1.16

    // a pixel: its material comes 1 cycle before `cosine` and `lit`, its highlight
    // PHONG_PRODUCTS_LATENCY cycles after them
    input  wire [MATERIAL_BITS-1:0] material_early,  // index
    input  wire [COSINE_BITS-1:0]   cosine,          // u0.18, Zn = cos(i)
    input  wire                     lit,             // 0: ambient term only
    input  wire [SPECULAR_BITS-1:0] specular,        // u1.35, W(i) cos(s)^n
    output wire [COLOUR_BITS-1:0]   colour           // code, 0 to 255
);

  localparam DIFFUSE_BITS = COEFFICIENT_BITS + COSINE_BITS;
  // Left shifts that give diffuse and ambient term the fraction of the specular term.
  localparam DIFFUSE_SHIFT = SPECULAR_FRACTION - COEFFICIENT_FRACTION - COSINE_FRACTION;
  localparam AMBIENT_SHIFT = SPECULAR_FRACTION - COEFFICIENT_FRACTION;
  localparam SUM_BITS = SPECULAR_FRACTION + 2;  // Cp + W <= 2
  localparam WAIT = `PHONG_PRODUCTS_LATENCY;    // cycles of the slowest product

  // ---- intensity: products ----
  wire [COEFFICIENT_BITS-1:0] ambient_p2;  // u1.16, Cp d
  wire [DIFFUSE_BITS-1:0] diffuse_p2;      // u1.34, Cp (1 - d) cos(i), 0 if not lit
  wire lit_p2;

  generate
    if (DIFFUSE && CONSTANT_DIFFUSE) begin : gen_constant_diffuse
      constant_multiplier #(
          .BITS(COSINE_BITS),
          .IS_SIGNED(0),
          .CONSTANT(DIFFUSE_CODE),
          .CONSTANT_BITS(COEFFICIENT_BITS),
          .LATENCY(WAIT)
      ) u_diffuse (
          .clk(clk),
          .word(cosine & {COSINE_BITS{lit}}),
          .product(diffuse_p2)
      );
    end else if (DIFFUSE) begin : gen_diffuse
      wire [COEFFICIENT_BITS-1:0] diffuse;
      wire [DIFFUSE_BITS-1:0] product;

      small_ram #(
          .ADDRESS_BITS(MATERIAL_BITS),
          .WORD_BITS(COEFFICIENT_BITS)
      ) u_diffuse_table (
          .clk(clk),
          .write_enable(write_diffuse),
          .write_address(write_address),
          .write_word(write_word),
          .address(material_early),
          .word(diffuse)
      );

      multiplier #(
          .A_BITS  (COEFFICIENT_BITS),
          .B_BITS  (COSINE_BITS),
          .A_SIGNED(0),
          .B_SIGNED(0)
      ) u_diffuse (
          .clk(clk),
          .a(diffuse),
          .b(cosine & {COSINE_BITS{lit}}),
          .product(product)
      );

      delay #(
          .BITS  (DIFFUSE_BITS),
          .CYCLES(WAIT - `PHONG_MULTIPLIER_LATENCY)
      ) u_wait (
          .clk(clk),
          .in (product),
          .out(diffuse_p2)
      );
    end else begin : gen_no_diffuse
      assign diffuse_p2 = {DIFFUSE_BITS{1'b0}};
    end

    if (AMBIENT && CONSTANT_AMBIENT) begin : gen_constant_ambient
      localparam [COEFFICIENT_BITS-1:0] CODE = AMBIENT_CODE;

      assign ambient_p2 = CODE;
    end else if (AMBIENT) begin : gen_ambient
      wire [COEFFICIENT_BITS-1:0] ambient;

      small_ram #(
          .ADDRESS_BITS(MATERIAL_BITS),
          .WORD_BITS(COEFFICIENT_BITS)
      ) u_ambient_table (
          .clk(clk),
          .write_enable(write_ambient),
          .write_address(write_address),
          .write_word(write_word),
          .address(material_early),
          .word(ambient)
      );

      delay #(
          .BITS  (COEFFICIENT_BITS),
          .CYCLES(WAIT)
      ) u_ambient (
          .clk(clk),
          .in (ambient),
          .out(ambient_p2)
      );
    end else begin : gen_no_ambient
      assign ambient_p2 = {COEFFICIENT_BITS{1'b0}};
    end
  endgenerate

  delay #(
      .BITS  (1),
      .CYCLES(WAIT)
  ) u_lit (
      .clk(clk),
      .in (lit),
      .out(lit_p2)
  );

  // ---- intensity: sum, clamp to 1, cut ----
  wire [SUM_BITS-1:0] sum_p4;             // u2.35, S
  reg [INTENSITY_BITS-1:0] intensity_p5;  // u1.24, S clamped

  wire [SUM_BITS-1:0] ambient_term = {
    {SUM_BITS - COEFFICIENT_BITS - AMBIENT_SHIFT{1'b0}}, ambient_p2, {AMBIENT_SHIFT{1'b0}}
  };
  wire [SUM_BITS-1:0] diffuse_term = {
    {SUM_BITS - DIFFUSE_BITS - DIFFUSE_SHIFT{1'b0}}, diffuse_p2, {DIFFUSE_SHIFT{1'b0}}
  };
  wire [SUM_BITS-1:0] specular_term = {
    {SUM_BITS - SPECULAR_BITS{1'b0}}, specular & {SPECULAR_BITS{lit_p2}}
  };

  generate
    if (AMBIENT && DIFFUSE && SPECULAR) begin : gen_three_terms
      reg [SUM_BITS-1:0] diffuse_sum_p3;
      reg [SUM_BITS-1:0] specular_p3;
      reg [SUM_BITS-1:0] sum;

      always @(posedge clk) begin
        diffuse_sum_p3 <= ambient_term + diffuse_term;
        specular_p3 <= specular_term;
        sum <= diffuse_sum_p3 + specular_p3;
      end

      assign sum_p4 = sum;
    end else begin : gen_fewer_terms
      reg [SUM_BITS-1:0] sum;

      if (SPECULAR) begin : gen_specular
        always @(posedge clk) sum <= (ambient_term | diffuse_term) + specular_term;
      end else begin : gen_no_specular
        always @(posedge clk) sum <= ambient_term + diffuse_term;
      end

      assign sum_p4 = sum;
    end
  endgenerate

  always @(posedge clk) begin
    intensity_p5 <= |sum_p4[SUM_BITS-1:SPECULAR_FRACTION]
        ? {{INTENSITY_BITS - INTENSITY_FRACTION - 1{1'b0}}, 1'b1, {INTENSITY_FRACTION{1'b0}}}
        : sum_p4[SPECULAR_FRACTION-INTENSITY_FRACTION+:INTENSITY_BITS];
  end

  wire unused_sum = &{1'b0, sum_p4[SPECULAR_FRACTION-INTENSITY_FRACTION-1:0]};

  // ---- code: times 255 = 256 - 1, rounded ----
  reg [INTENSITY_BITS+COLOUR_BITS-1:0] scaled_p6;
  reg [COLOUR_BITS-1:0] colour_p7;

  always @(posedge clk) begin
    scaled_p6 <= {intensity_p5, {COLOUR_BITS{1'b0}}} - {{COLOUR_BITS{1'b0}}, intensity_p5};
    colour_p7 <= scaled_p6[INTENSITY_FRACTION+:COLOUR_BITS]
        + {{COLOUR_BITS - 1{1'b0}}, scaled_p6[INTENSITY_FRACTION-1]};
  end

  wire unused_scaled = &{1'b0, scaled_p6[INTENSITY_BITS+COLOUR_BITS-1],
                         scaled_p6[INTENSITY_FRACTION-2:0]};

  assign colour = colour_p7;

endmodule

`default_nettype wire
