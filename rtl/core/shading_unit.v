// SPDX-License-Identifier: MIT
// shading_unit: the shading function of Phong 1975, eq. (3), for red, green and blue,
//   S = Cp [cos(i) (1 - d) + d] + W(i) cos(s)^n = Cp d + Cp (1 - d) cos(i) + W(i) cos(s)^n.
// The material table holds the products Cp d and Cp (1 - d), which saves a multiplier.
// The module holds the wiring, in data order.
// Latency: LATENCY cycles (PHONG_SHADING_UNIT_LATENCY in latency.vh; 49 by default).
// Throughput: one pixel per cycle.
// Reset: none; the material table is undefined until written.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module shading_unit (
    input wire clk,

    // registers, held for a frame
    input wire [`PHONG_HALF_VECTOR_BITS-1:0] half_x,  // s0.17, half vector, x
    input wire [`PHONG_HALF_VECTOR_BITS-1:0] half_z,  // s0.17, half vector, z

    // write port of the material table, from register_map
    input wire       write_weight,    // W(i) over an interval
    input wire       write_exponent,  // n
    input wire [2:0] write_ambient,   // Cp d of {blue, green, red}
    input wire [2:0] write_diffuse,   // Cp (1 - d) of {blue, green, red}

    // write port of curves and jumps, from reflectance_map
    input wire                                                write_curve,
    input wire [`PHONG_MATERIAL_BITS+`PHONG_SEGMENT_BITS-1:0] write_line,
    input wire [2*`PHONG_MAX_JUMPS-1:0]                       write_curve_jumps,
    input wire [2*`PHONG_MAX_JUMPS-1:0]                       write_weight_jumps,

    // its address: {material, interval or field}; its word: {step s1.16, left u1.16} of W(i),
    // n in u8.9, Cp d or Cp (1 - d) in u1.16
    input wire [`PHONG_MATERIAL_BITS+`PHONG_WEIGHT_INDEX_BITS-1:0] write_address,
    input wire [2*`PHONG_COEFFICIENT_BITS:0]                       write_word,

    // a pixel; by the method dot_first unit_x is hz Xn - hx Zn and unit_y is hz Yn
    input wire [`PHONG_UNIT_BITS-1:0]     unit_x,         // s0.17, unit normal, x
    input wire [`PHONG_UNIT_BITS-1:0]     unit_y,         // s0.17, y
    input wire [`PHONG_UNIT_BITS-1:0]     unit_z,         // s0.17, z
    input wire [`PHONG_VERSINE_BITS-1:0]  given_versine,  // u0.22, 1 - cos(s); quadratic_spans only
    input wire [`PHONG_COSINE_BITS-1:0]   cosine,         // u0.18, cos(i)
    input wire                            lit,            // 0: ambient term only
    input wire [`PHONG_MATERIAL_BITS-1:0] material,       // index

    // its colour, LATENCY cycles later
    output wire [`PHONG_COLOUR_BITS-1:0] red,    // code, 0 to 255
    output wire [`PHONG_COLOUR_BITS-1:0] green,  // code, 0 to 255
    output wire [`PHONG_COLOUR_BITS-1:0] blue    // code, 0 to 255
);

  localparam NORMAL_METHOD        = `PHONG_NORMAL_METHOD;
  localparam COSINE_BITS          = `PHONG_COSINE_BITS;
  localparam MATERIAL_BITS        = `PHONG_MATERIAL_BITS;
  localparam COEFFICIENT_BITS     = `PHONG_COEFFICIENT_BITS;
  localparam COEFFICIENT_FRACTION = `PHONG_COEFFICIENT_FRACTION;
  localparam INDEX_BITS           = `PHONG_WEIGHT_INDEX_BITS;
  localparam EXPONENT_BITS        = `PHONG_EXPONENT_BITS;
  localparam VERSINE_BITS         = `PHONG_VERSINE_BITS;
  localparam POWER_BITS           = `PHONG_POWER_BITS;
  localparam WEIGHT_BITS          = `PHONG_WEIGHT_BITS;
  localparam WEIGHT_FRACTION      = `PHONG_WEIGHT_FRACTION;
  localparam COLOUR_BITS          = `PHONG_COLOUR_BITS;
  localparam CHANNELS             = `PHONG_CHANNELS;           // 3: red, green, blue; 1: grey
  localparam SPECULAR             = `PHONG_SPECULAR;           // 0: no highlight
  localparam POWER_FUNCTION       = `PHONG_POWER_FUNCTION;     // 0: n is always 1
  localparam WEIGHT_FUNCTION      = `PHONG_WEIGHT_FUNCTION;    // 0: W does not depend on i
  localparam HAS_CURVES           = `PHONG_HAS_CURVES;         // 1: any curve in place of cos(s)^n
  localparam CONSTANT_EXPONENT    = `PHONG_CONSTANT_EXPONENT;  // 1: n is a constant of the build
  localparam CONSTANT_WEIGHT      = `PHONG_CONSTANT_WEIGHT;    // 1: W is a constant of the build
  localparam LATENCY              = `PHONG_SHADING_UNIT_LATENCY;

  // Cycles from the input to the use of cos(s)^n, n and W(i).
  localparam POWER_AT = `PHONG_SPECULAR_LATENCY;
  localparam EXPONENT_AT = `PHONG_HIGHLIGHT_LATENCY + `PHONG_EXPONENT_LATENCY;
  localparam WEIGHT_AT = POWER_AT - `PHONG_WEIGHT_LATENCY;

  // Cycles from the input to the look-ups by material, EXPONENT_FROM first and COLOUR_FROM last.
  localparam COLOUR_FROM = POWER_AT - `PHONG_SMALL_RAM_LATENCY;
  localparam WEIGHT_FROM = SPECULAR ? WEIGHT_AT : 0;
  localparam EXPONENT_FROM =
      SPECULAR && POWER_FUNCTION ? EXPONENT_AT - `PHONG_SMALL_RAM_LATENCY : 0;

  wire [MATERIAL_BITS-1:0] write_material = write_address[INDEX_BITS+:MATERIAL_BITS];
  wire [MATERIAL_BITS-1:0] material_exponent;
  wire [MATERIAL_BITS-1:0] material_weight;
  wire [MATERIAL_BITS-1:0] material_early;  // 1 cycle before the rest of the pixel

  delay #(
      .BITS  (MATERIAL_BITS),
      .CYCLES(EXPONENT_FROM)
  ) u_material_exponent (
      .clk(clk),
      .in (material),
      .out(material_exponent)
  );

  delay #(
      .BITS  (MATERIAL_BITS),
      .CYCLES(WEIGHT_FROM - EXPONENT_FROM)
  ) u_material_weight (
      .clk(clk),
      .in (material_exponent),
      .out(material_weight)
  );

  delay #(
      .BITS  (MATERIAL_BITS),
      .CYCLES(COLOUR_FROM - WEIGHT_FROM)
  ) u_material_early (
      .clk(clk),
      .in (material_weight),
      .out(material_early)
  );

  // cos(i) is needed by the weight first, then by the products.
  localparam COSINE_WEIGHT_AT = SPECULAR && WEIGHT_FUNCTION ? WEIGHT_AT : 0;

  wire [COSINE_BITS-1:0] cosine_weight;
  wire [COSINE_BITS-1:0] cosine_power;
  wire lit_power;

  delay #(
      .BITS  (COSINE_BITS),
      .CYCLES(COSINE_WEIGHT_AT)
  ) u_cosine_weight (
      .clk(clk),
      .in (cosine),
      .out(cosine_weight)
  );

  delay #(
      .BITS  (COSINE_BITS),
      .CYCLES(POWER_AT - COSINE_WEIGHT_AT)
  ) u_cosine_power (
      .clk(clk),
      .in (cosine_weight),
      .out(cosine_power)
  );

  delay #(
      .BITS  (1),
      .CYCLES(POWER_AT)
  ) u_lit_power (
      .clk(clk),
      .in (lit),
      .out(lit_power)
  );

  // ---- W(i) cos(s)^n ----
  wire [WEIGHT_BITS+POWER_BITS-1:0] specular;  // u1.35

  generate
    if (SPECULAR) begin : gen_specular
      wire [VERSINE_BITS-1:0] versine;  // u0.22, 1 - cos(s)
      wire [POWER_BITS-1:0] power;      // u0.18, cos(s)^n
      wire [WEIGHT_BITS-1:0] weight;    // u1.17, W(i)

      if (NORMAL_METHOD == `PHONG_NORMAL_METHOD_DOT_FIRST) begin : gen_versine
        versine_of_cross u_versine (
            .clk(clk),
            .cross_xz(unit_y),
            .cross_y(unit_x),
            .versine(versine)
        );

        wire unused = &{1'b0, half_x, half_z, unit_z, given_versine};
      end else if (NORMAL_METHOD == `PHONG_NORMAL_METHOD_QUADRATIC_SPANS) begin : gen_given
        assign versine = given_versine;

        wire unused = &{1'b0, half_x, half_z, unit_x, unit_y, unit_z};
      end else begin : gen_reflection
        reflection u_reflection (
            .clk(clk),
            .half_x(half_x),
            .half_z(half_z),
            .unit_x(unit_x),
            .unit_y(unit_y),
            .unit_z(unit_z),
            .versine(versine)
        );

        wire unused = &{1'b0, given_versine};
      end

      wire [EXPONENT_BITS-1:0] exponent;

      if (!POWER_FUNCTION || HAS_CURVES) begin : gen_no_exponent
        assign exponent = {EXPONENT_BITS{1'b0}};
      end else if (CONSTANT_EXPONENT) begin : gen_constant_exponent
        assign exponent = `PHONG_CONSTANT_EXPONENT_N;
      end else begin : gen_exponent
        small_ram #(
            .ADDRESS_BITS(MATERIAL_BITS),
            .WORD_BITS(EXPONENT_BITS)
        ) u_exponent_table (
            .clk(clk),
            .write_enable(write_exponent),
            .write_address(write_material),
            .write_word(write_word[EXPONENT_BITS-1:0]),
            .address(material_exponent),
            .word(exponent)
        );
      end

      specular_factors u_specular_factors (
          .clk(clk),
          .write_weight(write_weight),
          .write_curve(write_curve),
          .write_line(write_line),
          .write_curve_jumps(write_curve_jumps),
          .write_weight_jumps(write_weight_jumps),
          .write_address(write_address),
          .write_word(write_word),
          .versine(versine),
          .material_curve(material_exponent),
          .exponent(exponent),
          .cosine(cosine_weight),
          .material_weight(material_weight),
          .power(power),
          .weight(weight)
      );

      if (CONSTANT_WEIGHT) begin : gen_constant_product
        constant_multiplier #(
            .BITS(POWER_BITS),
            .IS_SIGNED(0),
            .CONSTANT(`PHONG_CONSTANT_WEIGHT_W << (WEIGHT_FRACTION - COEFFICIENT_FRACTION)),
            .CONSTANT_BITS(WEIGHT_BITS),
            .LATENCY(`PHONG_PRODUCTS_LATENCY)
        ) u_specular (
            .clk(clk),
            .word(power),
            .product(specular)
        );
      end else begin : gen_product
        wire [WEIGHT_BITS+POWER_BITS-1:0] product;

        multiplier #(
            .A_BITS  (WEIGHT_BITS),
            .B_BITS  (POWER_BITS),
            .A_SIGNED(0),
            .B_SIGNED(0)
        ) u_specular (
            .clk(clk),
            .a(weight),
            .b(power),
            .product(product)
        );

        delay #(
            .BITS  (WEIGHT_BITS + POWER_BITS),
            .CYCLES(`PHONG_PRODUCTS_LATENCY - `PHONG_MULTIPLIER_LATENCY)
        ) u_wait (
            .clk(clk),
            .in (product),
            .out(specular)
        );
      end
    end else begin : gen_no_specular
      assign specular = {WEIGHT_BITS + POWER_BITS{1'b0}};
    end
  endgenerate

  // ---- red, green, blue ----
  wire [CHANNELS*COLOUR_BITS-1:0] colour;

  genvar c;
  generate
    for (c = 0; c < CHANNELS; c = c + 1) begin : gen_channel
      colour_channel #(
          .AMBIENT_CODE(c == 0 ? `PHONG_CONSTANT_AMBIENT_RED
                 : c == 1 ? `PHONG_CONSTANT_AMBIENT_GREEN : `PHONG_CONSTANT_AMBIENT_BLUE),
          .DIFFUSE_CODE(c == 0 ? `PHONG_CONSTANT_DIFFUSE_RED
                   : c == 1 ? `PHONG_CONSTANT_DIFFUSE_GREEN : `PHONG_CONSTANT_DIFFUSE_BLUE)
      ) u_channel (
          .clk(clk),
          .write_ambient(write_ambient[c]),
          .write_diffuse(write_diffuse[c]),
          .write_address(write_material),
          .write_word(write_word[COEFFICIENT_BITS-1:0]),
          .material_early(material_early),
          .cosine(cosine_power),
          .lit(lit_power),
          .specular(specular),
          .colour(colour[c*COLOUR_BITS+:COLOUR_BITS])
      );
    end
  endgenerate

  assign {blue, green, red} = {3 / CHANNELS{colour}};

endmodule

`default_nettype wire
