// SPDX-License-Identifier: MIT
// inverse_sqrt: 1/sqrt(x), x in [1, 4), by the method that the configuration names.
// Latency: LATENCY cycles (PHONG_INVERSE_SQRT_LATENCY in latency.vh; 8 by default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module inverse_sqrt (
    input  wire                                clk,
    input  wire [`PHONG_ROOT_OPERAND_BITS-1:0] operand,  // u2.20, x
    output wire [`PHONG_ROOT_BITS-1:0]         root      // u0.18, 1/sqrt(x)
);

  localparam METHOD  = `PHONG_ROOT_METHOD;
  localparam LATENCY = `PHONG_INVERSE_SQRT_LATENCY;

  generate
    if (METHOD == `PHONG_ROOT_METHOD_LINES) begin : gen_lines
      inverse_sqrt_linear u_method (
          .clk(clk),
          .operand(operand),
          .root(root)
      );
    end else if (METHOD == `PHONG_ROOT_METHOD_QUADRATIC) begin : gen_quadratic
      inverse_sqrt_quadratic u_method (
          .clk(clk),
          .operand(operand),
          .root(root)
      );
    end else begin : gen_iterated  // method table or fast_inverse
      inverse_sqrt_iterated u_method (
          .clk(clk),
          .operand(operand),
          .root(root)
      );
    end
  endgenerate

endmodule

`default_nettype wire
