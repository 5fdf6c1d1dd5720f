// round_saturate: drop DROP low bits, rounded half up, and clamp to OUT_BITS.
// Latency below (round, saturate), one result a clock.
`default_nettype none
`include "latency.vh"

module round_saturate #(
    parameter IN_BITS   = 36,
    parameter DROP      = 18,  // 1 or more
    parameter OUT_BITS  = 18,  // at most IN_BITS - DROP
    parameter IS_SIGNED = 1,   // 1: two's complement, 0: unsigned
    parameter LATENCY   = `PHONG_ROUND_SATURATE_LATENCY
) (
    input  wire                clk,
    input  wire [ IN_BITS-1:0] in,
    output reg  [OUT_BITS-1:0] out
);

  localparam KEPT = IN_BITS - DROP;

  wire sign = (IS_SIGNED != 0) & in[IN_BITS-1];

  reg [KEPT:0] rounded_p1;  // one bit more for the carry

  // In range if all bits above the result's own (signed: and its sign) are alike.
  wire [KEPT-OUT_BITS:0] above = rounded_p1[KEPT:OUT_BITS];
  wire top = (IS_SIGNED != 0) & rounded_p1[OUT_BITS-1];
  wire negative = (IS_SIGNED != 0) & rounded_p1[KEPT];
  wire fits = above == {KEPT - OUT_BITS + 1{top}};

  always @(posedge clk) begin
    rounded_p1 <= {sign, in[IN_BITS-1:DROP]} + {{KEPT{1'b0}}, in[DROP-1]};
    if (fits) out <= rounded_p1[OUT_BITS-1:0];
    else out <= {negative | (IS_SIGNED == 0), {OUT_BITS - 1{~negative}}};
  end

  generate
    if (DROP > 1) begin : gen_unused
      wire unused = &{1'b0, in[DROP-2:0]};
    end
  endgenerate

endmodule

`default_nettype wire
