// SPDX-License-Identifier: MIT
// small_ram: memory of a few words with one write port and one read port; synthesis maps it to
// logic cells.
// Latency: LATENCY cycles from `address` to `word` (PHONG_SMALL_RAM_LATENCY in
// latency.vh; 1 by default).
// Throughput: one read and one write per cycle.
// Reset: none; contents are undefined until written.
`default_nettype none
`include "latency.vh"

module small_ram #(
    parameter ADDRESS_BITS = 4,
    parameter WORD_BITS    = 17,
    parameter LATENCY      = `PHONG_SMALL_RAM_LATENCY
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

  always @(posedge clk) begin
    if (write_enable) array[write_address] <= write_word;
    word <= array[address];
  end

endmodule

`default_nettype wire
