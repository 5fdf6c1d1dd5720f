// SPDX-License-Identifier: MIT
// MULT18X18D: simulation model of the ECP5 multiplier, written from Lattice's description (TN1267,
// sysDSP) for the mode that rtl/ecp5/multiplier.v uses: registers at the inputs and at the output,
// all on CLK0.
// Latency: 2 cycles with all registers.
// Throughput: one product per cycle.
// Reset: RST0, synchronous, clears all registers.
`default_nettype none

module MULT18X18D #(
    parameter REG_INPUTA_CLK = "NONE",
    parameter REG_INPUTB_CLK = "NONE",
    parameter REG_OUTPUT_CLK = "NONE",
    parameter GSR            = "ENABLED"
) (
    input wire A0, A1, A2, A3, A4, A5, A6, A7, A8,
    input wire A9, A10, A11, A12, A13, A14, A15, A16, A17,
    input wire B0, B1, B2, B3, B4, B5, B6, B7, B8,
    input wire B9, B10, B11, B12, B13, B14, B15, B16, B17,
    input wire SIGNEDA, SIGNEDB, SOURCEA, SOURCEB, CLK0, CE0, RST0,
    output wire P0, P1, P2, P3, P4, P5, P6, P7, P8,
    output wire P9, P10, P11, P12, P13, P14, P15, P16, P17,
    output wire P18, P19, P20, P21, P22, P23, P24, P25, P26,
    output wire P27, P28, P29, P30, P31, P32, P33, P34, P35
);

  wire [17:0] a = {A17, A16, A15, A14, A13, A12, A11, A10, A9,
    A8, A7, A6, A5, A4, A3, A2, A1, A0};
  wire [17:0] b = {B17, B16, B15, B14, B13, B12, B11, B10, B9,
    B8, B7, B6, B5, B4, B3, B2, B1, B0};

  reg [18:0] a_held, b_held;  // extended by the sign, or by 0 if unsigned
  reg [35:0] product_held;

  wire [18:0] a_in = {SIGNEDA & a[17], a};
  wire [18:0] b_in = {SIGNEDB & b[17], b};
  wire signed [18:0] a_used = REG_INPUTA_CLK == "NONE" ? a_in : a_held;
  wire signed [18:0] b_used = REG_INPUTB_CLK == "NONE" ? b_in : b_held;
  wire signed [37:0] product = a_used * b_used;

  always @(posedge CLK0) begin
    if (RST0) begin
      a_held <= 0;
      b_held <= 0;
      product_held <= 0;
    end else if (CE0) begin
      a_held <= a_in;
      b_held <= b_in;
      product_held <= product[35:0];
    end
  end

  assign {P35, P34, P33, P32, P31, P30, P29, P28, P27,
    P26, P25, P24, P23, P22, P21, P20, P19, P18,
    P17, P16, P15, P14, P13, P12, P11, P10, P9,
    P8, P7, P6, P5, P4, P3, P2, P1, P0}
      = REG_OUTPUT_CLK == "NONE" ? product[35:0] : product_held;

  wire unused = &{1'b0, SOURCEA, SOURCEB, product[37:36], GSR == "ENABLED"};

endmodule

`default_nettype wire
