// SPDX-License-Identifier: MIT
// control_bench: testbench top level with span_walker and pixel_fifo side by side, in sizes small
// enough for exhaustive tests.
// There are two FIFOs: `fit` has exactly the slots that its latency needs; the latency of `over` is
// one cycle longer, so that it needs one more bank.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module control_bench #(
    parameter COORDINATE_BITS = 4,
    parameter MATERIAL_BITS   = 2,
    parameter COLOUR_BITS     = 3,
    parameter LATENCY_FIT     = 12,  // cycles from place to colour: 16 slots
    parameter LATENCY_OVER    = 13,  // 32 slots
    parameter PIXEL_BITS      = 2 * COORDINATE_BITS + 3 * COLOUR_BITS
) (
    input wire clk,
    input wire reset,

    // ports of span_walker
    input  wire                       span_valid,
    output wire                       span_ready,
    input  wire [COORDINATE_BITS-1:0] span_x,
    input  wire [COORDINATE_BITS-1:0] span_y,
    input  wire [COORDINATE_BITS:0]   span_length,
    input  wire [MATERIAL_BITS-1:0]   span_material,
    input  wire                       span_last,
    output wire                       load,
    output wire                       advance,
    input  wire                       overflow,
    input  wire                       credit,
    output wire                       pixel_valid,
    output wire [COORDINATE_BITS-1:0] pixel_x,
    output wire [COORDINATE_BITS-1:0] pixel_y,
    output wire [MATERIAL_BITS-1:0]   pixel_material,
    output wire                       pixel_last,
    output wire                       illegal_span,

    // ports of both FIFOs: pixel_x, pixel_y, pixel_last
    input wire [COORDINATE_BITS-1:0] place_x,
    input wire [COORDINATE_BITS-1:0] place_y,
    input wire                       place_last,

    // ports of the FIFO `fit`, and its LATENCY
    output wire [31:0]            fit_latency,
    output wire                   fit_credit,
    input  wire                   fit_pixel_valid,
    input  wire [COLOUR_BITS-1:0] fit_red,
    input  wire [COLOUR_BITS-1:0] fit_green,
    input  wire [COLOUR_BITS-1:0] fit_blue,
    output wire                   fit_out_valid,
    input  wire                   fit_out_ready,
    output wire [PIXEL_BITS-1:0]  fit_out_data,
    output wire                   fit_out_last,

    // ports of the FIFO `over`, and its LATENCY
    output wire [31:0]            over_latency,
    output wire                   over_credit,
    input  wire                   over_pixel_valid,
    input  wire [COLOUR_BITS-1:0] over_red,
    input  wire [COLOUR_BITS-1:0] over_green,
    input  wire [COLOUR_BITS-1:0] over_blue,
    output wire                   over_out_valid,
    input  wire                   over_out_ready,
    output wire [PIXEL_BITS-1:0]  over_out_data,
    output wire                   over_out_last
);

  assign fit_latency  = LATENCY_FIT;
  assign over_latency = LATENCY_OVER;

  span_walker #(
      .COORDINATE_BITS(COORDINATE_BITS),
      .MATERIAL_BITS(MATERIAL_BITS)
  ) walker (
      .clk(clk),
      .reset(reset),
      .span_valid(span_valid),
      .span_ready(span_ready),
      .span_x(span_x),
      .span_y(span_y),
      .span_length(span_length),
      .span_material(span_material),
      .span_last(span_last),
      .load(load),
      .advance(advance),
      .overflow(overflow),
      .credit(credit),
      .pixel_valid(pixel_valid),
      .pixel_x(pixel_x),
      .pixel_y(pixel_y),
      .pixel_material(pixel_material),
      .pixel_last(pixel_last),
      .illegal_span(illegal_span)
  );

  pixel_fifo #(
      .COORDINATE_BITS(COORDINATE_BITS),
      .COLOUR_BITS(COLOUR_BITS),
      .LATENCY(LATENCY_FIT)
  ) fit (
      .clk(clk),
      .reset(reset),
      .credit(fit_credit),
      .pixel_valid(fit_pixel_valid),
      .pixel_x(place_x),
      .pixel_y(place_y),
      .pixel_last(place_last),
      .red(fit_red),
      .green(fit_green),
      .blue(fit_blue),
      .out_valid(fit_out_valid),
      .out_ready(fit_out_ready),
      .out_data(fit_out_data),
      .out_last(fit_out_last)
  );

  pixel_fifo #(
      .COORDINATE_BITS(COORDINATE_BITS),
      .COLOUR_BITS(COLOUR_BITS),
      .LATENCY(LATENCY_OVER)
  ) over (
      .clk(clk),
      .reset(reset),
      .credit(over_credit),
      .pixel_valid(over_pixel_valid),
      .pixel_x(place_x),
      .pixel_y(place_y),
      .pixel_last(place_last),
      .red(over_red),
      .green(over_green),
      .blue(over_blue),
      .out_valid(over_out_valid),
      .out_ready(over_out_ready),
      .out_data(over_out_data),
      .out_last(over_out_last)
  );

endmodule

`default_nettype wire
