// SPDX-License-Identifier: MIT
// round_saturate: drops the DROP lowest bits, rounding half up, and saturates to OUT_BITS.
// Two steps: round, then saturate.
// Latency: LATENCY cycles (PHONG_ROUND_SATURATE_LATENCY in latency.vh; 2 by default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "latency.vh"

module round_saturate #(
    parameter IN_BITS   = 36,
    parameter DROP      = 18,  // bits dropped, 1 or more
    parameter OUT_BITS  = 18,  // at most IN_BITS - DROP
    parameter IS_SIGNED = 1,   // 1: two's complement, 0: unsigned
    parameter LATENCY   = `PHONG_ROUND_SATURATE_LATENCY
) (
    input  wire                clk,
    input  wire [IN_BITS-1:0]  in,  // a format with f fraction bits
    output reg  [OUT_BITS-1:0] out  // f - DROP fraction bits
);

  localparam KEPT = IN_BITS - DROP;  // bits left after rounding

  wire sign = (IS_SIGNED != 0) & in[IN_BITS-1];

  reg [KEPT:0] rounded_p1;  // one more bit, for the carry

  // The rounded word fits OUT_BITS if all bits above these are 0 (signed: repeat the sign bit).
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
