// SPDX-License-Identifier: MIT
// equal_constant_product: proof that constant_multiplier equals the product of word and constant,
// for an unsigned and for a signed word.
`default_nettype none

module equal_constant_product #(
    parameter BITS          = 18,
    parameter CONSTANT_BITS = 17,
    parameter CONSTANT      = 26214,
    parameter LATENCY       = 3
) (
    input wire            clk,
    input wire [BITS-1:0] word  // of both multipliers
);

  wire [BITS+CONSTANT_BITS-1:0] unsigned_product, signed_product;

  constant_multiplier #(
      .BITS(BITS),
      .IS_SIGNED(0),
      .CONSTANT(CONSTANT),
      .CONSTANT_BITS(CONSTANT_BITS),
      .LATENCY(LATENCY)
  ) u_unsigned (
      .clk(clk),
      .word(word),
      .product(unsigned_product)
  );

  constant_multiplier #(
      .BITS(BITS),
      .IS_SIGNED(1),
      .CONSTANT(CONSTANT),
      .CONSTANT_BITS(CONSTANT_BITS),
      .LATENCY(LATENCY)
  ) u_signed (
      .clk(clk),
      .word(word),
      .product(signed_product)
  );

  localparam [CONSTANT_BITS-1:0] CODE = CONSTANT;

  reg [LATENCY-1:0] f_there = 0;   // top bit: LATENCY cycles have passed
  reg [BITS*LATENCY-1:0] f_words;  // the words of the last LATENCY cycles
  wire [BITS-1:0] f_word = f_words[BITS*(LATENCY-1)+:BITS];  // the word of the products
  wire signed [BITS+CONSTANT_BITS:0] f_signed = $signed(f_word) * $signed({1'b0, CODE});

  always @(posedge clk) begin
    f_there <= {f_there, 1'b1};
    f_words <= {f_words, word};
  end

  always @(*) begin
    if (f_there[LATENCY-1]) begin
      a_unsigned : assert (unsigned_product == f_word * CODE);
      a_signed : assert (signed_product == f_signed[BITS+CONSTANT_BITS-1:0]);
    end
  end

endmodule

`default_nettype wire
