// ram: one write port, one registered read port, made for block RAM.
// Read latency below (array register, output register), one word a clock.
`default_nettype none
`include "latency.vh"

module ram #(
    parameter ADDRESS_BITS = 9,
    parameter WORD_BITS = 36,
    parameter LATENCY = `PHONG_RAM_LATENCY
) (
    input  wire                    clk,
    input  wire                    write_enable,
    input  wire [ADDRESS_BITS-1:0] write_address,
    input  wire [   WORD_BITS-1:0] write_word,
    input  wire [ADDRESS_BITS-1:0] address,
    output reg  [   WORD_BITS-1:0] word
);

  reg [WORD_BITS-1:0] array[0:(1<<ADDRESS_BITS)-1];
  reg [WORD_BITS-1:0] word_p1;

  always @(posedge clk) begin
    if (write_enable) array[write_address] <= write_word;
    word_p1 <= array[address];
    word <= word_p1;
  end

endmodule

`default_nettype wire
