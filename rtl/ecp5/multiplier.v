// SPDX-License-Identifier: MIT
// multiplier for Lattice ECP5: equal to rtl/primitives/multiplier.v, on one MULT18X18D.
// The block's own input and output registers are used, which Yosys does not do when it infers a
// multiplier. Operands of more than the block's 18 bits are left to Yosys.
// Latency: LATENCY cycles (PHONG_MULTIPLIER_LATENCY in latency.vh; 2 by default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "latency.vh"

module multiplier #(
    parameter A_BITS   = 18,  // at most 18 for one DSP block
    parameter B_BITS   = 18,
    parameter A_SIGNED = 1,   // 1: two's complement, 0: unsigned
    parameter B_SIGNED = 1,
    parameter LATENCY  = `PHONG_MULTIPLIER_LATENCY
) (
    input  wire                     clk,
    input  wire [A_BITS-1:0]        a,       // format as A_SIGNED says
    input  wire [B_BITS-1:0]        b,       // format as B_SIGNED says
    output wire [A_BITS+B_BITS-1:0] product  // two's complement if `a` or `b` is
);

  generate
    if (A_BITS <= 18 && B_BITS <= 18) begin : gen_block
      wire [17:0] a_wide = {{18 - A_BITS{(A_SIGNED != 0) & a[A_BITS-1]}}, a};
      wire [17:0] b_wide = {{18 - B_BITS{(B_SIGNED != 0) & b[B_BITS-1]}}, b};
      // verilator lint_off UNUSEDSIGNAL
      wire [35:0] full;
      // verilator lint_on UNUSEDSIGNAL

      MULT18X18D #(
          .REG_INPUTA_CLK("CLK0"),
          .REG_INPUTB_CLK("CLK0"),
          .REG_OUTPUT_CLK("CLK0"),
          .GSR("DISABLED")
      ) u_block (
          .CLK0(clk), .CE0(1'b1), .RST0(1'b0),
          .SIGNEDA(A_SIGNED != 0), .SIGNEDB(B_SIGNED != 0), .SOURCEA(1'b0), .SOURCEB(1'b0),
          .A0(a_wide[0]), .A1(a_wide[1]), .A2(a_wide[2]),
          .A3(a_wide[3]), .A4(a_wide[4]), .A5(a_wide[5]),
          .A6(a_wide[6]), .A7(a_wide[7]), .A8(a_wide[8]),
          .A9(a_wide[9]), .A10(a_wide[10]), .A11(a_wide[11]),
          .A12(a_wide[12]), .A13(a_wide[13]), .A14(a_wide[14]),
          .A15(a_wide[15]), .A16(a_wide[16]), .A17(a_wide[17]),
          .B0(b_wide[0]), .B1(b_wide[1]), .B2(b_wide[2]),
          .B3(b_wide[3]), .B4(b_wide[4]), .B5(b_wide[5]),
          .B6(b_wide[6]), .B7(b_wide[7]), .B8(b_wide[8]),
          .B9(b_wide[9]), .B10(b_wide[10]), .B11(b_wide[11]),
          .B12(b_wide[12]), .B13(b_wide[13]), .B14(b_wide[14]),
          .B15(b_wide[15]), .B16(b_wide[16]), .B17(b_wide[17]),
          .P0(full[0]), .P1(full[1]), .P2(full[2]),
          .P3(full[3]), .P4(full[4]), .P5(full[5]),
          .P6(full[6]), .P7(full[7]), .P8(full[8]),
          .P9(full[9]), .P10(full[10]), .P11(full[11]),
          .P12(full[12]), .P13(full[13]), .P14(full[14]),
          .P15(full[15]), .P16(full[16]), .P17(full[17]),
          .P18(full[18]), .P19(full[19]), .P20(full[20]),
          .P21(full[21]), .P22(full[22]), .P23(full[23]),
          .P24(full[24]), .P25(full[25]), .P26(full[26]),
          .P27(full[27]), .P28(full[28]), .P29(full[29]),
          .P30(full[30]), .P31(full[31]), .P32(full[32]),
          .P33(full[33]), .P34(full[34]), .P35(full[35])
      );

      assign product = full[A_BITS+B_BITS-1:0];
    end else begin : gen_logic
      reg signed [A_BITS:0] a_p1;
      reg signed [B_BITS:0] b_p1;
      reg [A_BITS+B_BITS-1:0] product_p2;

      always @(posedge clk) begin
        a_p1 <= {(A_SIGNED != 0) & a[A_BITS-1], a};
        b_p1 <= {(B_SIGNED != 0) & b[B_BITS-1], b};
        product_p2 <= a_p1 * b_p1;
      end

      assign product = product_p2;
    end
  endgenerate

endmodule

`default_nettype wire
