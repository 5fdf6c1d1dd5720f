// SPDX-License-Identifier: MIT
// ram for Lattice ECP5: equal to rtl/primitives/ram.v, on one block RAM with its output register.
// A memory that does not fit one block is left to Yosys.
// A read in the cycle of a write to the same address returns an undefined word: write between
// frames only.
// Latency: LATENCY cycles from `address` to `word` (PHONG_RAM_LATENCY in latency.vh; 2 by default).
// Throughput: one read and one write per cycle.
// Reset: none; contents are undefined until written.
`default_nettype none
`include "latency.vh"

module ram #(
    parameter ADDRESS_BITS = 9,
    parameter WORD_BITS    = 36,
    parameter LATENCY      = `PHONG_RAM_LATENCY
) (
    input wire clk,

    // write port
    input wire                    write_enable,
    input wire [ADDRESS_BITS-1:0] write_address,
    input wire [WORD_BITS-1:0]    write_word,  // any format

    // read port
    input  wire [ADDRESS_BITS-1:0] address,
    output wire [WORD_BITS-1:0]    word  // contents at `address`, LATENCY cycles later
);

  generate
    if (ADDRESS_BITS <= 9 && WORD_BITS <= 36) begin : gen_block
      wire [ 8:0] address_wide = {{9 - ADDRESS_BITS{1'b0}}, address};
      wire [ 8:0] write_address_wide = {{9 - ADDRESS_BITS{1'b0}}, write_address};
      wire [35:0] write_word_wide = {{36 - WORD_BITS{1'b0}}, write_word};
      // verilator lint_off UNUSEDSIGNAL
      wire [35:0] full;
      // verilator lint_on UNUSEDSIGNAL

      block_ram u_block (
          .clk(clk),
          .write_enable(write_enable),
          .write_address(write_address_wide),
          .write_word(write_word_wide),
          .address(address_wide),
          .word(full)
      );

      assign word = full[WORD_BITS-1:0];
    end else begin : gen_logic
      reg [WORD_BITS-1:0] array[0:(1<<ADDRESS_BITS)-1];
      reg [WORD_BITS-1:0] word_p1, word_p2;

      always @(posedge clk) begin
        if (write_enable) array[write_address] <= write_word;
        word_p1 <= array[address];
        word_p2 <= word_p1;
      end

      assign word = word_p2;
    end
  endgenerate

endmodule

`default_nettype wire
