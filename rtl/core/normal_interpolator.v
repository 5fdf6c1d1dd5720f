// SPDX-License-Identifier: MIT
// normal_interpolator: one component of the normal along a span, by the order NORMAL_ORDER of the
// configuration: linear (1), or quadratic (2, with second differences).
// Latency: 1 cycle from `load` to the first value of the span.
// Throughput: one value per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"

module normal_interpolator (
    input wire clk,

    // control; `load` acts only together with `advance`
    input wire advance,  // 1: move to the next pixel
    input wire load,     // 1: the current pixel ends its span; the next one starts from `start`

    // offered span
    input wire [`PHONG_NORMAL_BITS-1:0] start,  // s1.30, at the centre of the first pixel
    input wire [`PHONG_NORMAL_BITS-1:0] step,   // s1.30, from the first pixel to the second

    // s1.42, growth of the step per pixel; not used for NORMAL_ORDER 1
    input wire [`PHONG_NORMAL_BITS+`PHONG_BEND_FRACTION_BITS-1:0] bend,

    // current pixel
    output wire [`PHONG_NORMAL_BITS-1:0] value,    // s1.30, at the centre of the pixel
    output wire                          overflow  // a word has been left since the first pixel
);

  localparam NORMAL_ORDER = `PHONG_NORMAL_ORDER;

  generate
    if (NORMAL_ORDER == 2) begin : gen_quadratic
      second_difference_interpolator u_order (
          .clk(clk),
          .load(load),
          .advance(advance),
          .start(start),
          .step(step),
          .bend(bend),
          .value(value),
          .overflow(overflow)
      );
    end else begin : gen_linear
      linear_interpolator u_order (
          .clk(clk),
          .load(load),
          .advance(advance),
          .start(start),
          .step(step),
          .value(value),
          .overflow(overflow)
      );

      wire unused = &{1'b0, bend};
    end
  endgenerate

endmodule

`default_nettype wire
