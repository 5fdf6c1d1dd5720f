// SPDX-License-Identifier: MIT
// quadratic_interpolator: a quadratic along a span by forward differences (after Duff 1979): two
// additions per pixel.
// At a load the value is `start`, and `first` and `second` are latched. At any other advance the
// held differences are added. A value that leaves the word wraps.
// Latency: 1 cycle from `load` to the first value of the span.
// Throughput: one value per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"

module quadratic_interpolator (
    input wire clk,

    // control; `load` acts only together with `advance`
    input wire advance,  // 1: move to the next pixel
    input wire load,     // 1: the current pixel ends its span; the next one starts from `start`

    // offered span
    input wire [`PHONG_SQUARED_BITS-1:0] start,   // s2.42, value at the centre of the first pixel
    input wire [`PHONG_SQUARED_BITS-1:0] first,   // s2.42, second pixel minus first pixel
    input wire [`PHONG_SQUARED_BITS-1:0] second,  // s2.42, growth of that difference per pixel

    // current pixel
    output reg [`PHONG_SQUARED_BITS-1:0] value  // s2.42, at the centre of the pixel
);

  localparam BITS = `PHONG_SQUARED_BITS;

  reg [BITS-1:0] growth;       // s2.42, next value minus current value
  reg [BITS-1:0] second_held;  // s2.42, `second` of the current span

  always @(posedge clk) begin
    if (advance) begin
      if (load) second_held <= second;
      value <= load ? start : value + growth;
      growth <= load ? first : growth + second_held;
    end
  end

endmodule

`default_nettype wire
