// SPDX-License-Identifier: MIT
// specular_cosine: cos(s) = 1 - versine, rounded: cos(s)^n for n = 1.
// Latency: LATENCY cycles (PHONG_SPECULAR_COSINE_LATENCY in latency.vh; 3 by default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module specular_cosine (
    input  wire                           clk,
    input  wire [`PHONG_VERSINE_BITS-1:0] versine,  // u0.22, 1 - cos(s)
    output wire [`PHONG_POWER_BITS-1:0]   cosine    // u0.18, cos(s)
);

  localparam VERSINE_BITS     = `PHONG_VERSINE_BITS;
  localparam VERSINE_FRACTION = `PHONG_VERSINE_FRACTION;
  localparam POWER_BITS       = `PHONG_POWER_BITS;  // all of them fraction
  localparam LATENCY          = `PHONG_SPECULAR_COSINE_LATENCY;

  reg [VERSINE_BITS:0] cosine_p1;

  always @(posedge clk) cosine_p1 <= {1'b1, {VERSINE_FRACTION{1'b0}}} - {1'b0, versine};

  round_saturate #(
      .IN_BITS  (VERSINE_BITS + 1),
      .DROP     (VERSINE_FRACTION - POWER_BITS),
      .OUT_BITS (POWER_BITS),
      .IS_SIGNED(0)
  ) u_cosine (
      .clk(clk),
      .in (cosine_p1),
      .out(cosine)
  );

endmodule

`default_nettype wire
