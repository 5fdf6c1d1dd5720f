// versine_of_parts: 1 - cos(s) = 2 (p^2 + q^2) from the parts p, q of the unit normal across the half-way
// vector (see reflection).
// One result a clock; latency below.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module versine_of_parts #(
    parameter UNIT_BITS        = `PHONG_UNIT_BITS,
    parameter UNIT_FRACTION    = `PHONG_UNIT_FRACTION,
    parameter VERSINE_BITS     = `PHONG_VERSINE_BITS,
    parameter VERSINE_FRACTION = `PHONG_VERSINE_FRACTION,
    parameter LATENCY          = `PHONG_VERSINE_OF_PARTS_LATENCY
) (
    input  wire                    clk,
    input  wire [   UNIT_BITS-1:0] p,       // s0.17
    input  wire [   UNIT_BITS-1:0] q,
    output wire [VERSINE_BITS-1:0] versine  // u0.22, 1 - cos(s); all ones where cos(s) <= 0
);

  localparam SUM_BITS = 2 * UNIT_BITS;

  wire [SUM_BITS-1:0] pp_p2, qq_p2;

  multiplier #(
      .A_BITS(UNIT_BITS),
      .B_BITS(UNIT_BITS)
  ) u_pp (
      .clk(clk),
      .a(p),
      .b(p),
      .product(pp_p2)
  );

  multiplier #(
      .A_BITS(UNIT_BITS),
      .B_BITS(UNIT_BITS)
  ) u_qq (
      .clk(clk),
      .a(q),
      .b(q),
      .product(qq_p2)
  );

  reg [SUM_BITS-1:0] pp_p3, qq_p3;
  reg [SUM_BITS-1:0] sum_p4;

  always @(posedge clk) begin
    pp_p3 <= pp_p2;
    qq_p3 <= qq_p2;
    sum_p4 <= pp_p3 + qq_p3;
  end

  round_saturate #(
      .IN_BITS  (SUM_BITS),
      .DROP     (2 * UNIT_FRACTION - 1 - VERSINE_FRACTION),
      .OUT_BITS (VERSINE_BITS),
      .IS_SIGNED(0)
  ) u_versine (
      .clk(clk),
      .in (sum_p4),
      .out(versine)
  );

endmodule

`default_nettype wire
