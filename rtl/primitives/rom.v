// SPDX-License-Identifier: MIT
// rom: constant table with a registered read; synthesis maps it to block RAM.
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
    output reg  [WORD_BITS-1:0]    word  // word `address` of CONTENTS, LATENCY cycles later
);

  reg [WORD_BITS-1:0] array[0:(1<<ADDRESS_BITS)-1];
  reg [WORD_BITS-1:0] word_p1;  // array register; `word` is the output register

  integer k;
  initial begin
    for (k = 0; k < (1 << ADDRESS_BITS); k = k + 1) array[k] = CONTENTS[k*WORD_BITS+:WORD_BITS];
  end

  always @(posedge clk) begin
    word_p1 <= array[address];
    word <= word_p1;
  end

endmodule

`default_nettype wire
