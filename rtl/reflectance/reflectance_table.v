// SPDX-License-Identifier: MIT
// reflectance_table: any curve of cos(s), per material, in place of cos(s)^n (Ohbuchi and Unno 2002).
// A curve is a table of straight lines over v = 1 - cos(s). Their lengths grow by octaves from both
// ends: below 1/2 by the leading zeros of v, else by those of v inverted, which is cos(s) minus one
// LSB. Neighbouring lines need not meet. A jump at another place takes a comparator (see jumps).
// Latency: LATENCY cycles from `versine` (PHONG_REFLECTANCE_TABLE_LATENCY in latency.vh; 13 by
// default).
// Throughput: one result per cycle.
// Reset: none; the tables are undefined until written.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module reflectance_table (
    input wire clk,

    // write port, from reflectance_map: a line at {material, line}, {step s1.16, left u1.16}; jumps
    // at the material, see `jumps`
    input wire                                                write_curve,
    input wire [`PHONG_MATERIAL_BITS+`PHONG_SEGMENT_BITS-1:0] write_line,
    input wire [2*`PHONG_MAX_JUMPS-1:0]                       write_jumps,
    input wire [`PHONG_MATERIAL_BITS-1:0]                     write_material,
    input wire [2*`PHONG_COEFFICIENT_BITS:0]                  write_word,

    // a pixel: its material comes PHONG_CURVE_OCTAVE_LATENCY cycles after its versine
    input  wire [`PHONG_VERSINE_BITS-1:0]  versine,   // u0.22, 1 - cos(s)
    input  wire [`PHONG_MATERIAL_BITS-1:0] material,  // index
    output wire [`PHONG_POWER_BITS-1:0]    power      // u0.18, the curve at cos(s)
);

  localparam VERSINE_BITS     = `PHONG_VERSINE_BITS;
  localparam OCTAVE_BITS      = `PHONG_CURVE_OCTAVE_BITS;
  localparam INDEX_BITS       = `PHONG_CURVE_INDEX_BITS;  // 2^INDEX_BITS lines an octave
  localparam SEGMENT_BITS     = `PHONG_SEGMENT_BITS;      // {mirrored, octave, index}
  localparam MATERIAL_BITS    = `PHONG_MATERIAL_BITS;
  localparam IDLE             = `PHONG_IDLE_MATERIAL_BITS;  // top bits of `material` that are 0
  localparam COEFFICIENT_BITS = `PHONG_COEFFICIENT_BITS;
  localparam POWER_BITS       = `PHONG_POWER_BITS;        // all of them fraction
  localparam JUMPS            = `PHONG_CURVE_JUMPS;
  localparam LATENCY          = `PHONG_REFLECTANCE_TABLE_LATENCY;

  localparam HALF_BITS = VERSINE_BITS - 1;
  localparam OFFSET_BITS = VERSINE_BITS - 2 - INDEX_BITS;  // place in the segment
  localparam ADDRESS_BITS = MATERIAL_BITS - IDLE + SEGMENT_BITS;
  localparam OCTAVE_LATENCY = `PHONG_CURVE_OCTAVE_LATENCY;

  // ---- fold ----
  wire mirrored = versine[VERSINE_BITS-1];
  wire [HALF_BITS-1:0] folded = versine[HALF_BITS-1:0] ^ {HALF_BITS{mirrored}};

  // ---- octave: zeros at the top, up to the last octave but one ----
  localparam MOST_ZEROS = (1 << OCTAVE_BITS) - 2;

  wire [OCTAVE_BITS-1:0] zeros_p2, zeros_p4;
  wire mirrored_p4;
  wire [HALF_BITS-1:0] folded_p2;
  wire [HALF_BITS-1:0] place_p4;  // the top bit is 0 in the last octave only

  leading_zeros #(
      .BITS(MOST_ZEROS),
      .COUNT_BITS(OCTAVE_BITS)
  ) u_zeros (
      .clk  (clk),
      .word (folded[HALF_BITS-1-:MOST_ZEROS]),
      .count(zeros_p2)
  );

  delay #(
      .BITS  (HALF_BITS),
      .CYCLES(`PHONG_LEADING_ZEROS_LATENCY)
  ) u_folded (
      .clk(clk),
      .in (folded),
      .out(folded_p2)
  );

  left_shifter #(
      .BITS(HALF_BITS),
      .COUNT_BITS(OCTAVE_BITS)
  ) u_place (
      .clk(clk),
      .word(folded_p2),
      .count(zeros_p2),
      .shifted(place_p4)
  );

  delay #(
      .BITS  (OCTAVE_BITS),
      .CYCLES(`PHONG_LEFT_SHIFTER_LATENCY)
  ) u_octave (
      .clk(clk),
      .in (zeros_p2),
      .out(zeros_p4)
  );

  delay #(
      .BITS  (1),
      .CYCLES(OCTAVE_LATENCY)
  ) u_mirrored (
      .clk(clk),
      .in (mirrored),
      .out(mirrored_p4)
  );

  // ---- lookup: block RAMs of 512 words side by side, then the one of the material ----
  localparam BLOCK_BITS = ADDRESS_BITS > 9 ? 9 : ADDRESS_BITS;
  localparam BANK_BITS = ADDRESS_BITS - BLOCK_BITS;
  localparam WORD_BITS = 2 * COEFFICIENT_BITS + 1;

  wire [MATERIAL_BITS+SEGMENT_BITS-1:0] line_p4 = {
    material, mirrored_p4, zeros_p4 | {{OCTAVE_BITS - 1{1'b0}}, ~place_p4[HALF_BITS-1]},
    place_p4[OFFSET_BITS+:INDEX_BITS]
  };
  wire [MATERIAL_BITS+SEGMENT_BITS-1:0] bank_p4 = line_p4 >> BLOCK_BITS;
  wire [MATERIAL_BITS+SEGMENT_BITS-1:0] write_bank = write_line >> BLOCK_BITS;
  wire [MATERIAL_BITS+SEGMENT_BITS-1:0] bank_p6;
  wire [(1<<BANK_BITS)*WORD_BITS-1:0] words_p6;
  wire [OFFSET_BITS-1:0] offset_p7;
  reg [WORD_BITS-1:0] word_p7;  // {step, left}

  genvar b;
  generate
    for (b = 0; b < (1 << BANK_BITS); b = b + 1) begin : gen_bank
      localparam [MATERIAL_BITS+SEGMENT_BITS-1:0] BANK = b;

      ram #(
          .ADDRESS_BITS(BLOCK_BITS),
          .WORD_BITS(WORD_BITS)
      ) u_lines (
          .clk(clk),
          .write_enable(write_curve & (write_bank == BANK)),
          .write_address(write_line[BLOCK_BITS-1:0]),
          .write_word(write_word),
          .address(line_p4[BLOCK_BITS-1:0]),
          .word(words_p6[b*WORD_BITS+:WORD_BITS])
      );
    end
  endgenerate

  delay #(
      .BITS  (MATERIAL_BITS + SEGMENT_BITS),
      .CYCLES(`PHONG_RAM_LATENCY)
  ) u_bank (
      .clk(clk),
      .in (bank_p4),
      .out(bank_p6)
  );

  delay #(
      .BITS  (OFFSET_BITS),
      .CYCLES(`PHONG_RAM_LATENCY + 1)
  ) u_offset (
      .clk(clk),
      .in (place_p4[OFFSET_BITS-1:0]),
      .out(offset_p7)
  );

  always @(posedge clk) word_p7 <= words_p6[bank_p6*WORD_BITS+:WORD_BITS];

  // ---- jumps: they are due when the line is ----
  localparam JUMPS_AT = OCTAVE_LATENCY + `PHONG_RAM_LATENCY + 1 + `PHONG_STEPPED_FALL_LATENCY
      - `PHONG_JUMPS_LATENCY;  // cycles from `versine` to the look-up

  wire [COEFFICIENT_BITS+1:0] fall;

  generate
    if (JUMPS > 0) begin : gen_jumps
      wire [MATERIAL_BITS-1:0] material_jumps;
      wire [VERSINE_BITS-1:0] versine_jumps;

      delay #(
          .BITS  (MATERIAL_BITS),
          .CYCLES(JUMPS_AT - OCTAVE_LATENCY)
      ) u_material (
          .clk(clk),
          .in (material),
          .out(material_jumps)
      );

      delay #(
          .BITS  (VERSINE_BITS),
          .CYCLES(JUMPS_AT + `PHONG_SMALL_RAM_LATENCY)
      ) u_versine (
          .clk(clk),
          .in (versine),
          .out(versine_jumps)
      );

      jumps #(
          .JUMPS(JUMPS),
          .OPERAND_BITS(VERSINE_BITS)
      ) u_jumps (
          .clk(clk),
          .write_enable(write_jumps),
          .write_address(write_material),
          .write_word(write_word[VERSINE_BITS:0]),
          .material(material_jumps),
          .operand(versine_jumps),
          .sum(fall)
      );
    end else begin : gen_no_jumps
      assign fall = {COEFFICIENT_BITS + 2{1'b0}};

      wire unused = &{1'b0, write_jumps, write_material};
    end
  endgenerate

  // ---- level, result ----
  stepped_line #(
      .OFFSET_BITS(OFFSET_BITS),
      .OUT_BITS(POWER_BITS),
      .DROP(OFFSET_BITS + `PHONG_COEFFICIENT_FRACTION - `PHONG_POWER_FRACTION)
  ) u_line (
      .clk(clk),
      .left(word_p7[COEFFICIENT_BITS-1:0]),
      .step(word_p7[WORD_BITS-1:COEFFICIENT_BITS]),
      .offset(offset_p7),
      .fall(fall),
      .value(power)
  );

endmodule

`default_nettype wire
