// SPDX-License-Identifier: MIT
// span_walker: turns spans into pixels, left to right, and steers the interpolators.
// Latency: 1 cycle from an accepted span to its first pixel at the outputs.
// Throughput: one pixel per cycle while there is credit; no gap between spans, even of one pixel.
// Reset: synchronous; drops the active span. The place and the material of a pixel are not reset.
`default_nettype none
`include "phong_config.vh"

module span_walker #(
    parameter COORDINATE_BITS = `PHONG_COORDINATE_BITS,
    parameter MATERIAL_BITS   = `PHONG_MATERIAL_BITS
) (
    input wire clk,
    input wire reset,  // synchronous

    // offered span; accepted in a cycle in which span_valid and span_ready are 1
    input  wire                       span_valid,
    output wire                       span_ready,     // does not depend on span_valid
    input  wire [COORDINATE_BITS-1:0] span_x,         // pixels, place of the first pixel
    input  wire [COORDINATE_BITS-1:0] span_y,         // pixels
    input  wire [COORDINATE_BITS:0]   span_length,    // pixels, 1 or more
    input  wire [MATERIAL_BITS-1:0]   span_material,  // index
    input  wire                       span_last,      // the span is the last of the frame

    // control of the interpolators, to which the `values` of the offered span (start, step) go;
    // `load` acts only together with `advance`. While no span is active, `load` is 1, too, and the
    // interpolators may load anything.
    output wire advance,   // 1: move to the next pixel; 0: hold the current one
    output wire load,      // 1: the current pixel ends its span; the next one starts from `values`
    input  wire overflow,  // an interpolated component has left its word since the first pixel

    // current pixel, in the cycle of its interpolated values
    input  wire                       credit,          // 1: a pixel may leave
    output wire                       pixel_valid,     // 1: the pixel leaves
    output reg  [COORDINATE_BITS-1:0] pixel_x,         // pixels
    output reg  [COORDINATE_BITS-1:0] pixel_y,         // pixels
    output reg  [MATERIAL_BITS-1:0]   pixel_material,  // index
    output wire                       pixel_last,      // the pixel is the last of the frame

    // one-cycle pulse, one cycle after the last pixel of an illegal span: the span is empty, its x
    // leaves the range of coordinates, or a component has left its word
    output wire illegal_span
);

  reg busy;                           // a span is active
  reg walking;                        // copy of ~at_end for local use; at_end has a large fan-out
  reg at_end;                         // the current pixel ends its span, or no span is active
  reg next_ends;                      // the pixel after the current one is the last of the span
  reg [COORDINATE_BITS:0] remaining;  // pixels of the span after the current one
  reg [1:0] beyond;                   // how often pixel_x has wrapped; all ones for an empty span
  reg last;                           // the span is the last of the frame
  reg ended;                          // the last pixel of a span left one cycle ago
  reg illegal;                        // that span was illegal

  assign pixel_valid = busy & credit;
  assign pixel_last = last & ~walking;
  assign span_ready = credit & ~walking;

  // `advance` and `load` drive whole words, so both come from registers. span_valid decides only
  // whether the loaded values belong to a span. Without credit nothing moves, and no span is
  // accepted even while none is active.
  assign advance = credit;
  assign load = at_end;

  // The next pixel is the last of its span, or there will be none.
  wire ends = walking ? next_ends : ~span_valid | (span_length[COORDINATE_BITS:1] == 0);

  always @(posedge clk) begin
    if (advance) begin
      if (~walking) begin
        {beyond, pixel_x} <= {{2{span_length == 0}}, span_x};
        pixel_y <= span_y;
        pixel_material <= span_material;
        last <= span_last;
        remaining <= span_length - 1'b1;
        next_ends <= span_length == 2;
      end else begin
        {beyond, pixel_x} <= {beyond, pixel_x} + 1'b1;
        remaining <= remaining - 1'b1;
        next_ends <= remaining == 2;
      end
    end

    if (reset) begin
      busy <= 1'b0;
      at_end <= 1'b1;
      walking <= 1'b0;
    end else if (advance) begin
      busy <= span_valid | walking;
      at_end <= ends;
      walking <= ~ends;
    end

    ended <= ~reset & pixel_valid & ~walking;
    illegal <= (beyond != 0) | overflow;
  end

  assign illegal_span = ended & illegal;

endmodule

`default_nettype wire
