// SPDX-License-Identifier: MIT
// equal_pixel_fifo: proof that the pixel_fifo of a pruned build (one channel, narrow places) equals
// the full one at every port in every cycle, for grey pixels in a small picture.
`default_nettype none

module equal_pixel_fifo #(
    parameter LATENCY = 3
) (
    input wire clk,
    input wire reset,

    // inputs of both FIFOs
    input wire       pixel_valid,
    input wire       pixel_x,  // 0 or 1
    input wire       pixel_y,  // 0 or 1
    input wire       pixel_last,
    input wire [1:0] grey,     // code of red, green and blue
    input wire       out_ready
);

  wire full_credit, full_valid, full_last, credit, valid, last;
  wire [11:0] full_data, data;

  pixel_fifo #(
      .COORDINATE_BITS(3),
      .COLOUR_BITS(2),
      .LATENCY(LATENCY)
  ) u_full (
      .clk(clk),
      .reset(reset),
      .credit(full_credit),
      .pixel_valid(pixel_valid),
      .pixel_x({2'b00, pixel_x}),
      .pixel_y({2'b00, pixel_y}),
      .pixel_last(pixel_last),
      .red(grey),
      .green(grey),
      .blue(grey),
      .out_valid(full_valid),
      .out_ready(out_ready),
      .out_data(full_data),
      .out_last(full_last)
  );

  pixel_fifo #(
      .COORDINATE_BITS(3),
      .COLOUR_BITS(2),
      .CHANNELS(1),
      .IDLE_X_BITS(2),
      .IDLE_Y_BITS(1),
      .LATENCY(LATENCY)
  ) u_pruned (
      .clk(clk),
      .reset(reset),
      .credit(credit),
      .pixel_valid(pixel_valid),
      .pixel_x({2'b00, pixel_x}),
      .pixel_y({2'b00, pixel_y}),
      .pixel_last(pixel_last),
      .red(grey),
      .green(grey),
      .blue(grey),
      .out_valid(valid),
      .out_ready(out_ready),
      .out_data(data),
      .out_last(last)
  );

  reg f_past = 1'b0;  // not the first cycle, in which reset is assumed
  always @(posedge clk) f_past <= 1'b1;

  always @(*) begin
    if (!f_past) assume (reset);
    assume (!pixel_valid || full_credit);
    if (f_past) begin
      a_flow : assert (credit == full_credit && valid == full_valid);
      a_pixel : assert (!valid || (data == full_data && last == full_last));
    end
  end

endmodule

`default_nettype wire
