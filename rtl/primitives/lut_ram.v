// SPDX-License-Identifier: MIT
// lut_ram: memory of a few words that is read in the same cycle; synthesis maps it to the RAM of logic
// cells.
// A read in the cycle of a write to the same address returns the old word.
// Latency: 0 cycles from `address` to `word`; a written word can be read in the next cycle.
// Throughput: one read and one write per cycle.
// Reset: none; contents are undefined until written.
`default_nettype none

module lut_ram #(
    parameter ADDRESS_BITS = 3,
    parameter WORD_BITS    = 16
) (
    input wire clk,

    // write port
    input wire                    write_enable,
    input wire [ADDRESS_BITS-1:0] write_address,
    input wire [WORD_BITS-1:0]    write_word,  // any format

    // read port
    input  wire [ADDRESS_BITS-1:0] address,
    output wire [WORD_BITS-1:0]    word  // contents at `address`
);

  (* ram_style = "distributed" *)
  reg [WORD_BITS-1:0] array[0:(1<<ADDRESS_BITS)-1];

  always @(posedge clk) if (write_enable) array[write_address] <= write_word;

  assign word = array[address];

endmodule

`default_nettype wire
