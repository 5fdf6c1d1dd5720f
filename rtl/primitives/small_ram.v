// small_ram: one write port, one registered read port, made for a few words in logic cells.
// Read latency below, one word a clock.
`default_nettype none
`include "latency.vh"

module small_ram #(
    parameter ADDRESS_BITS = 4,
    parameter WORD_BITS = 17,
    parameter LATENCY = `PHONG_SMALL_RAM_LATENCY
) (
    input  wire                    clk,
    input  wire                    write_enable,
    input  wire [ADDRESS_BITS-1:0] write_address,
    input  wire [   WORD_BITS-1:0] write_word,
    input  wire [ADDRESS_BITS-1:0] address,
    output reg  [   WORD_BITS-1:0] word
);

  reg [WORD_BITS-1:0] array[0:(1<<ADDRESS_BITS)-1];

  always @(posedge clk) begin
    if (write_enable) array[write_address] <= write_word;
    word <= array[address];
  end

endmodule

`default_nettype wire
