// SPDX-License-Identifier: MIT
// equal_colour_channel: proof that colour_channel without the specular term equals the full one
// whose specular term is 0, in small words. The pruned channel answers one cycle earlier.
// The two tables are written first, then read.
`default_nettype none

module equal_colour_channel (
    input wire clk,

    // inputs of both channels
    input wire       write_ambient,
    input wire       write_diffuse,
    input wire       write_address,   // one of 2 materials
    input wire [3:0] write_word,      // u1.3
    input wire       material_early,  // one of 2 materials
    input wire [3:0] cosine,          // u0.4
    input wire       lit
);

  localparam COEFFICIENT_BITS = 4, COSINE_BITS = 4, SPECULAR_BITS = 9, INTENSITY_BITS = 8;

  wire [2:0] full_colour, colour;

  colour_channel #(
      .MATERIAL_BITS(1),
      .COEFFICIENT_BITS(COEFFICIENT_BITS),
      .COEFFICIENT_FRACTION(COEFFICIENT_BITS - 1),
      .COSINE_BITS(COSINE_BITS),
      .COSINE_FRACTION(COSINE_BITS),
      .SPECULAR_BITS(SPECULAR_BITS),
      .SPECULAR_FRACTION(SPECULAR_BITS - 1),
      .INTENSITY_BITS(INTENSITY_BITS),
      .INTENSITY_FRACTION(INTENSITY_BITS - 1),
      .COLOUR_BITS(3)
  ) u_full (
      .clk(clk),
      .write_ambient(write_ambient),
      .write_diffuse(write_diffuse),
      .write_address(write_address),
      .write_word(write_word),
      .material_early(material_early),
      .cosine(cosine),
      .lit(lit),
      .specular({SPECULAR_BITS{1'b0}}),
      .colour(full_colour)
  );

  colour_channel #(
      .MATERIAL_BITS(1),
      .COEFFICIENT_BITS(COEFFICIENT_BITS),
      .COEFFICIENT_FRACTION(COEFFICIENT_BITS - 1),
      .COSINE_BITS(COSINE_BITS),
      .COSINE_FRACTION(COSINE_BITS),
      .SPECULAR_BITS(SPECULAR_BITS),
      .SPECULAR_FRACTION(SPECULAR_BITS - 1),
      .INTENSITY_BITS(INTENSITY_BITS),
      .INTENSITY_FRACTION(INTENSITY_BITS - 1),
      .COLOUR_BITS(3),
      .SPECULAR(0)
  ) u_pruned (
      .clk(clk),
      .write_ambient(write_ambient),
      .write_diffuse(write_diffuse),
      .write_address(write_address),
      .write_word(write_word),
      .material_early(material_early),
      .cosine(cosine),
      .lit(lit),
      .specular({SPECULAR_BITS{1'b0}}),
      .colour(colour)
  );

  // The two tables are written in cycles 0 to 3. Colours that depend on them leave the full channel
  // after its latency.
  reg [4:0] f_clock = 0;  // number of the cycle, saturated
  reg [2:0] f_colour;     // colour of the pruned channel, one cycle ago
  wire f_set_up = f_clock < 4;

  always @(posedge clk) begin
    if (!(&f_clock)) f_clock <= f_clock + 1'b1;
    f_colour <= colour;
  end

  always @(*) begin
    if (f_set_up) begin
      assume (write_ambient == ~f_clock[1] && write_diffuse == f_clock[1]);
      assume (write_address == f_clock[0]);
    end else assume (!write_ambient && !write_diffuse);
    if (f_clock > 5 + `PHONG_COLOUR_CHANNEL_LATENCY) a_colour : assert (full_colour == f_colour);
  end

endmodule

`default_nettype wire
