// SPDX-License-Identifier: MIT
// light_sum: one colour of a pixel: the sum over its lights, clamp and code,
//   I = (e + ka Ia + sum of ka La) + sum of terms, code = floor(255 clamp(I, 0, 1) + 1/2).
// The lights of a turn are added in a tree, the turns in an accumulator. The sum keeps all bits.
// Latency: LATENCY cycles from the terms of the last turn (PHONG_LIGHT_SUM_LATENCY in latency.vh; 5
// by default).
// Throughput: one turn per cycle.
// Reset: none; the table is undefined until written.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module light_sum #(
    parameter MATERIAL_BITS      = `PHONG_MATERIAL_BITS,
    parameter COEFFICIENT_BITS   = `PHONG_COEFFICIENT_BITS,
    parameter FRACTION           = `PHONG_WEIGHT_FRACTION + `PHONG_POWER_FRACTION,
    parameter INTENSITY_BITS     = `PHONG_INTENSITY_BITS,
    parameter INTENSITY_FRACTION = `PHONG_INTENSITY_FRACTION,
    parameter COLOUR_BITS        = `PHONG_COLOUR_BITS,
    parameter LIGHTS             = `PHONG_LIGHTS,
    parameter UNITS              = `PHONG_UNITS,
    parameter AMBIENT            = `PHONG_AMBIENT,  // 0: the first part is left out
    parameter LATENCY            = `PHONG_LIGHT_SUM_LATENCY
) (
    input wire clk,

    // write port of the first part
    input wire                        write_ambient,
    input wire [MATERIAL_BITS-1:0]    write_address,  // material
    input wire [COEFFICIENT_BITS-1:0] write_word,     // u1.16

    // a turn: its terms, and with them
    input  wire [UNITS*(FRACTION+2)-1:0] terms,     // u2.35 each, the first unit in the lowest bits
    input  wire                          first,     // 1: the turn is the first of its pixel
    input  wire [MATERIAL_BITS-1:0]      material,  // index
    output wire [COLOUR_BITS-1:0]        colour     // code, 0 to 255, after the last turn
);

  localparam TERM_BITS = FRACTION + 2;
  localparam LEVELS = $clog2(UNITS);
  // The first part is below 2, a term below 4.
  localparam SUM_BITS = FRACTION + $clog2(2 + 4 * LIGHTS);
  localparam AMBIENT_SHIFT = FRACTION - `PHONG_COEFFICIENT_FRACTION;

  // ---- tree: the units; a heap, in which level l starts at 2^(LEVELS-l) ----
  wire [SUM_BITS-1:0] node[0:2*UNITS-1];

  assign node[0] = {SUM_BITS{1'b0}};

  genvar l, i;
  generate
    for (i = 0; i < UNITS; i = i + 1) begin : gen_leaf
      assign node[UNITS+i] =
          {{SUM_BITS - TERM_BITS{1'b0}}, terms[i*TERM_BITS+:TERM_BITS]};
    end

    for (l = 1; l <= LEVELS; l = l + 1) begin : gen_level
      for (i = 0; i < (UNITS >> l); i = i + 1) begin : gen_node
        localparam HERE = (UNITS >> l) + i;

        reg [SUM_BITS-1:0] sum;

        always @(posedge clk) sum <= node[2*HERE] + node[2*HERE+1];

        assign node[HERE] = sum;
      end
    end
  endgenerate

  // ---- accumulate: the turns ----
  wire first_tree;
  wire [COEFFICIENT_BITS-1:0] ambient;  // u1.16
  reg [SUM_BITS-1:0] sum;

  delay #(
      .BITS  (1),
      .CYCLES(LEVELS + 1)
  ) u_first (
      .clk(clk),
      .in (first),
      .out(first_tree)
  );

  generate
    if (AMBIENT) begin : gen_ambient
      wire [MATERIAL_BITS-1:0] material_tree;

      delay #(
          .BITS  (MATERIAL_BITS),
          .CYCLES(LEVELS)
      ) u_material (
          .clk(clk),
          .in (material),
          .out(material_tree)
      );

      small_ram #(
          .ADDRESS_BITS(MATERIAL_BITS),
          .WORD_BITS(COEFFICIENT_BITS)
      ) u_table (
          .clk(clk),
          .write_enable(write_ambient),
          .write_address(write_address),
          .write_word(write_word),
          .address(material_tree),
          .word(ambient)
      );
    end else begin : gen_no_ambient
      assign ambient = {COEFFICIENT_BITS{1'b0}};

      wire unused = &{1'b0, write_ambient, write_address, write_word, material};
    end
  endgenerate

  wire [SUM_BITS-1:0] sum_before = first_tree
      ? {{SUM_BITS - COEFFICIENT_BITS - AMBIENT_SHIFT{1'b0}}, ambient, {AMBIENT_SHIFT{1'b0}}}
      : sum;
  reg [SUM_BITS-1:0] root_p1;  // of the tree, beside the look-up of `ambient`

  always @(posedge clk) begin
    root_p1 <= node[1];
    sum <= sum_before + root_p1;
  end

  // ---- clamp: to 1, cut ----
  reg [INTENSITY_BITS-1:0] intensity;  // u1.24

  always @(posedge clk) begin
    intensity <= |sum[SUM_BITS-1:FRACTION]
        ? {{INTENSITY_BITS - INTENSITY_FRACTION - 1{1'b0}}, 1'b1, {INTENSITY_FRACTION{1'b0}}}
        : sum[FRACTION-INTENSITY_FRACTION+:INTENSITY_BITS];
  end

  // ---- code: times 255 = 256 - 1, rounded ----
  reg [INTENSITY_BITS+COLOUR_BITS-1:0] scaled;
  reg [COLOUR_BITS-1:0] code;

  always @(posedge clk) begin
    scaled <= {intensity, {COLOUR_BITS{1'b0}}} - {{COLOUR_BITS{1'b0}}, intensity};
    code <= scaled[INTENSITY_FRACTION+:COLOUR_BITS]
        + {{COLOUR_BITS - 1{1'b0}}, scaled[INTENSITY_FRACTION-1]};
  end

  assign colour = code;

  wire unused_bits = &{1'b0, scaled[INTENSITY_BITS+COLOUR_BITS-1], scaled[INTENSITY_FRACTION-2:0],
                       node[0]};

endmodule

`default_nettype wire
