// delay: a word, CYCLES clocks later. No reset.
`default_nettype none

module delay #(
    parameter BITS   = 1,
    parameter CYCLES = 1   // 0 or more
) (
    input  wire            clk,
    input  wire [BITS-1:0] in,
    output wire [BITS-1:0] out
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
