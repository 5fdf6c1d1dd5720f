// SPDX-License-Identifier: MIT
// delay: shift register; `out` repeats `in` after CYCLES cycles.
// Latency: CYCLES cycles; 0 makes it a wire.
// Throughput: one word per cycle.
// Reset: none; the first CYCLES words after power-up are undefined.
`default_nettype none

module delay #(
    parameter BITS   = 1,  // width of a word
    parameter CYCLES = 1   // 0 or more
) (
    input  wire            clk,
    input  wire [BITS-1:0] in,  // word of any format
    output wire [BITS-1:0] out  // the same word, CYCLES cycles later
);

  generate
    if (CYCLES == 0) begin : gen_wire
      wire unused = clk;
      assign out = in;
    end else begin : gen_line
      reg [BITS-1:0] line[0:CYCLES-1];
      integer i;
      always @(posedge clk) begin
        line[0] <= in;
        for (i = 1; i < CYCLES; i = i + 1) line[i] <= line[i-1];
      end
      assign out = line[CYCLES-1];
    end
  endgenerate

endmodule

`default_nettype wire
