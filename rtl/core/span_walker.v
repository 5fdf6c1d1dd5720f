// span_walker: spans become pixels, left to right; it starts and steps the interpolators.
// A pixel a clock as long as there is credit, and no bubble between spans, also of one pixel.
// Latency 1: a span accepted now has its first pixel at the outputs in the next clock.
`default_nettype none
`include "phong_config.vh"

module span_walker #(
    parameter COORDINATE_BITS = `PHONG_COORDINATE_BITS,
    parameter MATERIAL_BITS   = `PHONG_MATERIAL_BITS
) (
    input wire clk,
    input wire reset,  // synchronous; drops the span at work

    // span, with the normal's start and step at the interpolators
    input  wire                       span_valid,
    output wire                       span_ready,
    input  wire [COORDINATE_BITS-1:0] span_x,         // pixels, first pixel
    input  wire [COORDINATE_BITS-1:0] span_y,
    input  wire [  COORDINATE_BITS:0] span_length,    // pixels, 1 or more
    input  wire [  MATERIAL_BITS-1:0] span_material,
    input  wire                       span_last,      // last span of the frame

    // interpolators; while there is no span they may load anything
    output wire advance,   // take the next value
    output wire load,      // as the next value take start, and step with it; else add step
    input  wire overflow,  // a component has left its word since load

    // pixel, at the time of the interpolators' values
    input  wire                       credit,  // a pixel may leave
    output wire                       pixel_valid,
    output reg  [COORDINATE_BITS-1:0] pixel_x,
    output reg  [COORDINATE_BITS-1:0] pixel_y,
    output reg  [  MATERIAL_BITS-1:0] pixel_material,
    output wire                       pixel_last,  // last pixel of the frame

    output wire illegal_span  // for one clock: a span was empty, left its word or the counter
);

  reg busy;
  reg walking;  // ~at_end once more, for use in here: at_end drives registers far and wide
  reg at_end;  // the pixel at the outputs is the last of its span, or there is none
  reg next_ends;  // the pixel after it is
  reg [COORDINATE_BITS:0] remaining;  // pixels of the span after this one
  reg [1:0] beyond;  // of pixel_x: how often it left the counter; all ones for an empty span
  reg last;
  reg ended;  // a span did, one clock ago
  reg illegal;  // it was

  assign pixel_valid = busy & credit;
  assign pixel_last = last & ~walking;
  assign span_ready = credit & ~walking;

  // Both drive whole words, so they are registers: span_valid decides only whether what was loaded
  // is a span, and without credit nothing moves, not even into an idle walker.
  assign advance = credit;
  assign load = at_end;

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
