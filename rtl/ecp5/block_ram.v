// SPDX-License-Identifier: MIT
// block_ram: memory of 512 words of 36 bits with one write port and one read port, on one DP16KD.
// The block's output register is used, which Yosys does not do when it infers a memory.
// A read in the cycle of a write to the same address returns an undefined word.
// Latency: 2 cycles from `address` to `word` (array register, output register).
// Throughput: one read and one write per cycle.
// Reset: none.
`default_nettype none

module block_ram #(
    parameter [512*36-1:0] CONTENTS = 0  // initial words, word 0 in the lowest bits
) (
    input wire clk,

    // write port
    input wire        write_enable,
    input wire [8:0]  write_address,
    input wire [35:0] write_word,  // any format

    // read port
    input  wire [8:0]  address,
    output wire [35:0] word  // contents at `address`, 2 cycles later
);

  // Initial values of the block: row r holds 16 half words of 18 bits, each in a field of 20 bits.
  function [319:0] row(input integer r);
    integer k;
    begin
      row = 320'b0;
      for (k = 0; k < 16; k = k + 1) row[20*k+:18] = CONTENTS[(16*r+k)*18+:18];
    end
  endfunction

  // In the mode of 36 bits, port A writes and port B reads. For both, the lower half of the word is
  // at the data pins of A and the upper half at those of B. The four lowest address bits of A are
  // byte enables.
  DP16KD #(
      .INITVAL_00(row(0)), .INITVAL_01(row(1)), .INITVAL_02(row(2)), .INITVAL_03(row(3)),
      .INITVAL_04(row(4)), .INITVAL_05(row(5)), .INITVAL_06(row(6)), .INITVAL_07(row(7)),
      .INITVAL_08(row(8)), .INITVAL_09(row(9)), .INITVAL_0A(row(10)), .INITVAL_0B(row(11)),
      .INITVAL_0C(row(12)), .INITVAL_0D(row(13)), .INITVAL_0E(row(14)), .INITVAL_0F(row(15)),
      .INITVAL_10(row(16)), .INITVAL_11(row(17)), .INITVAL_12(row(18)), .INITVAL_13(row(19)),
      .INITVAL_14(row(20)), .INITVAL_15(row(21)), .INITVAL_16(row(22)), .INITVAL_17(row(23)),
      .INITVAL_18(row(24)), .INITVAL_19(row(25)), .INITVAL_1A(row(26)), .INITVAL_1B(row(27)),
      .INITVAL_1C(row(28)), .INITVAL_1D(row(29)), .INITVAL_1E(row(30)), .INITVAL_1F(row(31)),
      .INITVAL_20(row(32)), .INITVAL_21(row(33)), .INITVAL_22(row(34)), .INITVAL_23(row(35)),
      .INITVAL_24(row(36)), .INITVAL_25(row(37)), .INITVAL_26(row(38)), .INITVAL_27(row(39)),
      .INITVAL_28(row(40)), .INITVAL_29(row(41)), .INITVAL_2A(row(42)), .INITVAL_2B(row(43)),
      .INITVAL_2C(row(44)), .INITVAL_2D(row(45)), .INITVAL_2E(row(46)), .INITVAL_2F(row(47)),
      .INITVAL_30(row(48)), .INITVAL_31(row(49)), .INITVAL_32(row(50)), .INITVAL_33(row(51)),
      .INITVAL_34(row(52)), .INITVAL_35(row(53)), .INITVAL_36(row(54)), .INITVAL_37(row(55)),
      .INITVAL_38(row(56)), .INITVAL_39(row(57)), .INITVAL_3A(row(58)), .INITVAL_3B(row(59)),
      .INITVAL_3C(row(60)), .INITVAL_3D(row(61)), .INITVAL_3E(row(62)), .INITVAL_3F(row(63)),
      .DATA_WIDTH_A(36),
      .DATA_WIDTH_B(36),
      .REGMODE_A("OUTREG"),
      .REGMODE_B("OUTREG"),
      .RESETMODE("SYNC"),
      .ASYNC_RESET_RELEASE("SYNC"),
      .CSDECODE_A("0b000"),
      .CSDECODE_B("0b000"),
      .CLKAMUX("CLKA"),
      .CLKBMUX("CLKB"),
      .WRITEMODE_A("NORMAL"),
      .WRITEMODE_B("NORMAL"),
      .GSR("DISABLED")
  ) u_block (
      .CLKA(clk), .CEA(write_enable), .WEA(1'b1), .OCEA(1'b1), .RSTA(1'b0),
      .CSA0(1'b0), .CSA1(1'b0), .CSA2(1'b0),
      .CLKB(clk), .CEB(1'b1), .WEB(1'b0), .OCEB(1'b1), .RSTB(1'b0),
      .CSB0(1'b0), .CSB1(1'b0), .CSB2(1'b0),
      .ADA0(1'b1), .ADA1(1'b1), .ADA2(1'b1), .ADA3(1'b1), .ADA4(1'b0),
      .ADA5(write_address[0]), .ADA6(write_address[1]), .ADA7(write_address[2]),
      .ADA8(write_address[3]), .ADA9(write_address[4]), .ADA10(write_address[5]),
      .ADA11(write_address[6]), .ADA12(write_address[7]), .ADA13(write_address[8]),
      .ADB0(1'b0), .ADB1(1'b0), .ADB2(1'b0), .ADB3(1'b0), .ADB4(1'b0),
      .ADB5(address[0]), .ADB6(address[1]), .ADB7(address[2]),
      .ADB8(address[3]), .ADB9(address[4]), .ADB10(address[5]),
      .ADB11(address[6]), .ADB12(address[7]), .ADB13(address[8]),
      .DIA0(write_word[0]), .DIA1(write_word[1]), .DIA2(write_word[2]),
      .DIA3(write_word[3]), .DIA4(write_word[4]), .DIA5(write_word[5]),
      .DIA6(write_word[6]), .DIA7(write_word[7]), .DIA8(write_word[8]),
      .DIA9(write_word[9]), .DIA10(write_word[10]), .DIA11(write_word[11]),
      .DIA12(write_word[12]), .DIA13(write_word[13]), .DIA14(write_word[14]),
      .DIA15(write_word[15]), .DIA16(write_word[16]), .DIA17(write_word[17]),
      .DIB0(write_word[18]), .DIB1(write_word[19]), .DIB2(write_word[20]),
      .DIB3(write_word[21]), .DIB4(write_word[22]), .DIB5(write_word[23]),
      .DIB6(write_word[24]), .DIB7(write_word[25]), .DIB8(write_word[26]),
      .DIB9(write_word[27]), .DIB10(write_word[28]), .DIB11(write_word[29]),
      .DIB12(write_word[30]), .DIB13(write_word[31]), .DIB14(write_word[32]),
      .DIB15(write_word[33]), .DIB16(write_word[34]), .DIB17(write_word[35]),
      .DOA0(word[0]), .DOA1(word[1]), .DOA2(word[2]),
      .DOA3(word[3]), .DOA4(word[4]), .DOA5(word[5]),
      .DOA6(word[6]), .DOA7(word[7]), .DOA8(word[8]),
      .DOA9(word[9]), .DOA10(word[10]), .DOA11(word[11]),
      .DOA12(word[12]), .DOA13(word[13]), .DOA14(word[14]),
      .DOA15(word[15]), .DOA16(word[16]), .DOA17(word[17]),
      .DOB0(word[18]), .DOB1(word[19]), .DOB2(word[20]),
      .DOB3(word[21]), .DOB4(word[22]), .DOB5(word[23]),
      .DOB6(word[24]), .DOB7(word[25]), .DOB8(word[26]),
      .DOB9(word[27]), .DOB10(word[28]), .DOB11(word[29]),
      .DOB12(word[30]), .DOB13(word[31]), .DOB14(word[32]),
      .DOB15(word[33]), .DOB16(word[34]), .DOB17(word[35])
  );

endmodule

`default_nettype wire
