// SPDX-License-Identifier: MIT
// light_map: decodes what the write port holds for lights, beside register_map.
//
//   address                         word
//   {light, 0 or 1, material, ...}  as in register_map; the fields diffuse, half_x and half_z are
//                                   those of the light
//   {light, 1, material, 11...13}   ks Ls of red, green, blue (u1.16)
//   {light, 1, k / 16, 16 + k % 16} {step s1.16, left u1.16} of interval k of the factor of the
//                                   distance; in builds with jumps the fields belong to
//                                   reflectance_map
//   {any, 1, any, 10}               bits 3 to 1: lights of the frame minus 1
//
// The light l is shaded in turn l / UNITS by the unit l mod UNITS.
// Latency: 1 cycle from a write to the strobes, 2 to `last_turn`, 4 to `unsupported`.
// Throughput: one write per cycle.
// Reset: none; the register is undefined until written.
`default_nettype none
`include "phong_config.vh"

module light_map #(
    parameter MATERIAL_BITS    = `PHONG_MATERIAL_BITS,
    parameter INDEX_BITS       = `PHONG_WEIGHT_INDEX_BITS,  // of a field
    parameter COEFFICIENT_BITS = `PHONG_COEFFICIENT_BITS,
    parameter LIGHTS           = `PHONG_LIGHTS,
    parameter LIGHT_BITS       = `PHONG_LIGHT_BITS,
    parameter UNITS            = `PHONG_UNITS,
    parameter TURN_BITS        = `PHONG_TURN_BITS,
    parameter HIGHLIGHT_COLOUR = `PHONG_HIGHLIGHT_COLOUR,   // 0: every ks Ls is 1
    parameter SPAN_HALF_VECTOR = `PHONG_SPAN_HALF_VECTOR,   // 1: spans bring hx and hz
    parameter ATTENUATION      = `PHONG_ATTENUATION,        // 0: no factor of the distance
    parameter JUMPS            = `PHONG_CURVE_JUMPS + `PHONG_WEIGHT_JUMPS,
    parameter SPECULAR         = `PHONG_SPECULAR,           // 0: no highlight
    parameter CHANNELS         = `PHONG_CHANNELS            // 3: red, green, blue; 1: grey
) (
    input wire clk,

    // write port
    input wire                                         write_enable,   // 1: write
    input wire [LIGHT_BITS+MATERIAL_BITS+INDEX_BITS:0] write_address,  // see above
    input wire [2*COEFFICIENT_BITS:0]                  write_word,     // see above

    output wire [TURN_BITS-1:0] last_turn,  // register, held for a frame: turns of a pixel minus 1

    // strobes for the tables of the lights, with the light's place
    output reg                 write_half_x,     // hx
    output reg                 write_half_z,     // hz
    output reg [2:0]           write_highlight,  // ks Ls of {blue, green, red}
    output reg                 write_factor,     // an interval of the factor of the distance
    output reg [UNITS-1:0]     to_unit,          // 1: the light belongs to this unit
    output reg [TURN_BITS-1:0] to_turn,

    output wire unsupported  // one-cycle pulse: a word needs what this build leaves out
);

  localparam [INDEX_BITS-1:0] DIFFUSE = `PHONG_FIELD_DIFFUSE;      // then green, blue
  localparam [INDEX_BITS-1:0] HALF_X = `PHONG_FIELD_HALF_X;
  localparam [INDEX_BITS-1:0] HALF_Z = `PHONG_FIELD_HALF_Z;
  localparam [INDEX_BITS-1:0] CONTROL = `PHONG_FIELD_CONTROL;
  localparam [INDEX_BITS-1:0] HIGHLIGHT = `PHONG_FIELD_HIGHLIGHT;  // then green, blue
  localparam FACTOR = `PHONG_FIELD_ATTENUATION;                    // then the other intervals
  localparam [COEFFICIENT_BITS-1:0] ONE = 1 << `PHONG_COEFFICIENT_FRACTION;

  localparam UNIT_BITS = $clog2(UNITS);
  localparam BELOW = 1 + MATERIAL_BITS + INDEX_BITS;  // bits below the number of the light
  localparam WIDE = 6;                                // holds the number of a light, and zeros

  wire [BELOW+WIDE-1:0] padded = {{WIDE - LIGHT_BITS{1'b0}}, write_address};
  wire [WIDE-1:0] light = padded[BELOW+:WIDE];
  wire [WIDE-1:0] its_turn = light >> UNIT_BITS;
  wire [WIDE-1:0] its_unit = light - (its_turn << UNIT_BITS);
  wire [INDEX_BITS-1:0] field = write_address[INDEX_BITS-1:0];
  wire write_field = write_enable & write_address[BELOW-1];
  wire is_factor = (JUMPS == 0) & ({{32 - INDEX_BITS{1'b0}}, field} >= FACTOR);

  reg write_control, of_a_light, no_light;
  reg [WIDE-1:0] last_light;  // lights of the frame minus 1
  reg [COEFFICIENT_BITS-1:0] code;
  reg sloped;  // the word is an interval whose step is not 0

  integer c, u;
  always @(posedge clk) begin
    write_half_x <= write_field & (field == HALF_X);
    write_half_z <= write_field & (field == HALF_Z);
    write_control <= write_field & (field == CONTROL);
    write_factor <= write_field & is_factor;
    of_a_light <= write_field & ((field == HALF_X) | (field == HALF_Z) | is_factor);
    for (c = 0; c < 3; c = c + 1) begin
      write_highlight[c] <= write_field & (field == HIGHLIGHT + c[INDEX_BITS-1:0]);
      if (write_field & ((field == HIGHLIGHT + c[INDEX_BITS-1:0])
                         | (field == DIFFUSE + c[INDEX_BITS-1:0]))) of_a_light <= 1'b1;
    end
    for (u = 0; u < UNITS; u = u + 1) to_unit[u] <= its_unit == u[WIDE-1:0];
    to_turn <= its_turn[TURN_BITS-1:0];
    no_light <= light >= LIGHTS;
    last_light <= {{WIDE - 3{1'b0}}, write_word[3:1]};
    code <= write_word[COEFFICIENT_BITS-1:0];
    sloped <= |write_word[2*COEFFICIENT_BITS:COEFFICIENT_BITS];
  end

  // ---- register ----
  wire [WIDE-1:0] turns = last_light >> UNIT_BITS;

  reg [TURN_BITS-1:0] last_turn_held;

  always @(posedge clk) if (write_control) last_turn_held <= turns[TURN_BITS-1:0];

  assign last_turn = last_turn_held;

  // ---- unsupported: not timing critical, but in the same cycle as that of register_map ----
  reg flagged_p2;

  always @(posedge clk) begin
    flagged_p2 <= of_a_light & no_light
        | (LIGHTS > 1) & write_control & (last_light >= LIGHTS)
        | (SPECULAR != 0) & (HIGHLIGHT_COLOUR == 0) & |write_highlight & (code != ONE)
        | (SPECULAR != 0) & (CHANNELS < 3) & |write_highlight[2:1]
        | (SPECULAR != 0) & (SPAN_HALF_VECTOR != 0) & (write_half_x | write_half_z)
        | (ATTENUATION == 0) & write_factor & (sloped | (code != ONE));
  end

  delay #(
      .BITS  (1),
      .CYCLES(2)
  ) u_unsupported (
      .clk(clk),
      .in (flagged_p2),
      .out(unsupported)
  );

  wire unused = &{1'b0, padded, its_turn, its_unit, turns};

endmodule

`default_nettype wire
