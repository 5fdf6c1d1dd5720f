// shading_unit: the paper's eq. (3) for red, green and blue,
//   S = Cp [cos(i) (1 - d) + d] + W(i) cos(s)^n = Cp d + Cp (1 - d) cos(i) + W(i) cos(s)^n.
// The material table holds the products Cp d and Cp (1 - d), which saves a multiplier.
// One pixel a clock; latency below. Wiring in data order.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module shading_unit (
    input wire clk,

    // registers and material table, held for a frame
    input wire [`PHONG_HALF_VECTOR_BITS-1:0]                       half_x,          // s0.17
    input wire [`PHONG_HALF_VECTOR_BITS-1:0]                       half_z,
    input wire                                                     write_weight,
    input wire                                                     write_exponent,
    // blue, green, red
    input wire [2:0]                                               write_ambient,
    input wire [2:0]                                               write_diffuse,
    // {material, interval}
    input wire [`PHONG_MATERIAL_BITS+`PHONG_WEIGHT_INDEX_BITS-1:0] write_address,
    input wire [2*`PHONG_COEFFICIENT_BITS:0]                       write_word,

    // a pixel
    input wire [`PHONG_UNIT_BITS-1:0]     unit_x,         // s0.17, unit normal
    input wire [`PHONG_UNIT_BITS-1:0]     unit_y,
    input wire [`PHONG_UNIT_BITS-1:0]     unit_z,
    input wire [`PHONG_VERSINE_BITS-1:0]  given_versine,  // u0.22, 1 - cos(s); for differences only
    input wire [`PHONG_COSINE_BITS-1:0]   cosine,         // u0.18, cos(i)
    input wire                            lit,
    input wire [`PHONG_MATERIAL_BITS-1:0] material,

    output wire [`PHONG_COLOUR_BITS-1:0] red,    // codes
    output wire [`PHONG_COLOUR_BITS-1:0] green,
    output wire [`PHONG_COLOUR_BITS-1:0] blue
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
  localparam CHANNELS             = `PHONG_CHANNELS;
  localparam SPECULAR             = `PHONG_SPECULAR;
  localparam POWER_FUNCTION       = `PHONG_POWER_FUNCTION;
  localparam WEIGHT_FUNCTION      = `PHONG_WEIGHT_FUNCTION;
  localparam CONSTANT_EXPONENT    = `PHONG_CONSTANT_EXPONENT;
  localparam CONSTANT_WEIGHT      = `PHONG_CONSTANT_WEIGHT;
  localparam LATENCY              = `PHONG_SHADING_UNIT_LATENCY;

  // Clocks from the input to where a thing is needed.
  localparam POWER_AT = `PHONG_SPECULAR_LATENCY;
  localparam EXPONENT_AT = `PHONG_HIGHLIGHT_LATENCY + `PHONG_EXPONENT_LATENCY;
  localparam WEIGHT_AT = POWER_AT - `PHONG_SPECULAR_WEIGHT_LATENCY;

  // Clocks from the input to where the material is looked up, in this order.
  localparam COLOUR_FROM = POWER_AT - `PHONG_SMALL_RAM_LATENCY;
  localparam WEIGHT_FROM = !SPECULAR ? 0 : WEIGHT_FUNCTION ? WEIGHT_AT : COLOUR_FROM;
  localparam EXPONENT_FROM =
      SPECULAR && POWER_FUNCTION ? EXPONENT_AT - `PHONG_SMALL_RAM_LATENCY : 0;

  wire [MATERIAL_BITS-1:0] write_material = write_address[INDEX_BITS+:MATERIAL_BITS];
  wire [MATERIAL_BITS-1:0] material_exponent;
  wire [MATERIAL_BITS-1:0] material_weight;
  wire [MATERIAL_BITS-1:0] material_early;

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

  // cos(i) comes to the weight first, then to the products.
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
  wire [WEIGHT_BITS+POWER_BITS-1:0] specular;

  generate
    if (SPECULAR) begin : gen_specular
      wire [VERSINE_BITS-1:0] versine;
      wire [POWER_BITS-1:0] power;
      wire [WEIGHT_BITS-1:0] weight;

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

      if (POWER_FUNCTION) begin : gen_power
        wire [EXPONENT_BITS-1:0] exponent;

        if (CONSTANT_EXPONENT) begin : gen_constant_exponent
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

        specular_power u_specular_power (
            .clk(clk),
            .versine(versine),
            .exponent(exponent),
            .power(power)
        );
      end else begin : gen_cosine
        specular_cosine u_specular_cosine (
            .clk(clk),
            .versine(versine),
            .cosine(power)
        );
      end

      if (WEIGHT_FUNCTION) begin : gen_weight
        specular_weight u_specular_weight (
            .clk(clk),
            .write_enable(write_weight),
            .write_address(write_address),
            .write_word(write_word),
            .material(material_weight),
            .cosine(cosine_weight),
            .weight(weight)
        );
      end else if (CONSTANT_WEIGHT) begin : gen_constant_weight
        assign weight = {WEIGHT_BITS{1'b0}};
      end else begin : gen_material_weight  // interval 0 stands for all
        wire [COEFFICIENT_BITS-1:0] left;

        small_ram #(
            .ADDRESS_BITS(MATERIAL_BITS),
            .WORD_BITS(COEFFICIENT_BITS)
        ) u_weight_table (
            .clk(clk),
            .write_enable(write_weight),
            .write_address(write_material),
            .write_word(write_word[COEFFICIENT_BITS-1:0]),
            .address(material_weight),
            .word(left)
        );

        assign weight = {left, {WEIGHT_FRACTION - COEFFICIENT_FRACTION{1'b0}}};
      end

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
