// SPDX-License-Identifier: MIT
// rom for Lattice ECP5: equal to rtl/primitives/rom.v, on one block RAM with its output register.
// A table that does not fit one block is left to Yosys.
// Latency: LATENCY cycles (PHONG_ROM_LATENCY in latency.vh; 2 by default).
// Throughput: one word per cycle.
// Reset: none; contents are part of the configuration.
`default_nettype none
`include "latency.vh"

module rom #(
    parameter ADDRESS_BITS = 9,
    parameter WORD_BITS    = 36,
    parameter [(WORD_BITS<<ADDRESS_BITS)-1:0] CONTENTS = 0,  // word 0 in the lowest bits
    parameter LATENCY      = `PHONG_ROM_LATENCY
) (
    input  wire                    clk,
    input  wire [ADDRESS_BITS-1:0] address,
    output wire [WORD_BITS-1:0]    word  // word `address` of CONTENTS, LATENCY cycles later
);

  // CONTENTS with every word zero-extended to the 36 bits of the block.
  function [512*36-1:0] padded(input integer unused);
    integer k;
    begin
      padded = 0;
      for (k = 0; k < (1 << ADDRESS_BITS); k = k + 1) begin
        padded[36*k+:WORD_BITS] = CONTENTS[WORD_BITS*k+:WORD_BITS];
      end
    end
  endfunction

  generate
    if (ADDRESS_BITS <= 9 && WORD_BITS <= 36) begin : gen_block
      wire [ 8:0] address_wide = {{9 - ADDRESS_BITS{1'b0}}, address};
      // verilator lint_off UNUSEDSIGNAL
      wire [35:0] full;
      // verilator lint_on UNUSEDSIGNAL

      block_ram #(
          .CONTENTS(padded(0))
      ) u_block (
          .clk(clk),
          .write_enable(1'b0),
          .write_address(9'b0),
          .write_word(36'b0),
          .address(address_wide),
          .word(full)
      );

      assign word = full[WORD_BITS-1:0];
    end else begin : gen_logic
      reg [WORD_BITS-1:0] array[0:(1<<ADDRESS_BITS)-1];
      reg [WORD_BITS-1:0] word_p1, word_p2;

      integer k;
      initial begin
        for (k = 0; k < (1 << ADDRESS_BITS); k = k + 1) array[k] = CONTENTS[k*WORD_BITS+:WORD_BITS];
      end

      always @(posedge clk) begin
        word_p1 <= array[address];
        word_p2 <= word_p1;
      end

      assign word = word_p2;
    end
  endgenerate

endmodule

`default_nettype wire
