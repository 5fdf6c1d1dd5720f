// colour_channel without the specular term, against the full one whose specular term is 0, in
// small words; the pruned one is a clock earlier. The tables are written first, then read.
`default_nettype none

module equal_colour_channel (
    input wire       clk,
    input wire       write_ambient,
    input wire       write_diffuse,
    input wire       write_address,
    input wire [3:0] write_word,
    input wire       material_early,
    input wire [3:0] cosine,
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

  // Four clocks write the two tables; what comes from them is out after as many as the full has.
  reg [4:0] f_clock = 0;
  reg [2:0] f_colour;
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
