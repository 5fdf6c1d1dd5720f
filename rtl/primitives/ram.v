// SPDX-License-Identifier: MIT
// ram: memory with one write port and one read port; synthesis maps it to block RAM.
// A read in the cycle of a write to the same address returns the old word here; block RAM returns
// an undefined one. So write between frames only.
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
    output reg  [WORD_BITS-1:0]    word  // contents at `address`, LATENCY cycles later
);

  reg [WORD_BITS-1:0] array[0:(1<<ADDRESS_BITS)-1];
  reg [WORD_BITS-1:0] word_p1;  // array register; `word` is the output register

  always @(posedge clk) begin
    if (write_enable) array[write_address] <= write_word;
    word_p1 <= array[address];
    word <= word_p1;
  end

endmodule

`default_nettype wire
