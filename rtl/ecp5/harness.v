// SPDX-License-Identifier: MIT
// harness: phong_pipeline between two shift registers, so that three pins are enough to place and
// route it. Not part of the design.
// Every port of the pipeline has a register next to it: no pin is on a path whose timing matters,
// no input is constant and no output is unused.
// Reset: none; the reset of the pipeline is a bit of the input register.
`default_nettype none
`include "phong_config.vh"

module harness #(
    parameter WRITE_ADDRESS_BITS = `PHONG_MATERIAL_BITS + `PHONG_WEIGHT_INDEX_BITS + 1,
    parameter WRITE_WORD_BITS    = 2 * `PHONG_COEFFICIENT_BITS + 1,
    parameter SPAN_BITS          = `PHONG_SPAN_BITS,
    parameter PIXEL_BITS         = 2 * `PHONG_COORDINATE_BITS + 3 * `PHONG_COLOUR_BITS
) (
    input  wire clk,
    input  wire in,  // serial data, shifted into the input register
    output wire out  // serial data: the outputs are XORed into the output register and shifted out
);

  localparam INPUTS = 5 + WRITE_ADDRESS_BITS + WRITE_WORD_BITS + SPAN_BITS;  // 5 single bits
  localparam OUTPUTS = 6 + PIXEL_BITS;                                       // 6 single bits

  reg [INPUTS-1:0] inputs;
  reg [OUTPUTS-1:0] outputs;
  wire reset, write_enable, span_valid, span_last, pixel_ready;
  wire [WRITE_ADDRESS_BITS-1:0] write_address;
  wire [WRITE_WORD_BITS-1:0] write_word;
  wire [SPAN_BITS-1:0] span;
  wire [OUTPUTS-1:0] driven;

  assign {reset, write_enable, span_valid, span_last, pixel_ready, write_address, write_word,
          span} = inputs;

  phong_pipeline dut (
      .clk(clk),
      .reset(reset),
      .write_enable(write_enable),
      .write_address(write_address),
      .write_word(write_word),
      .s_axis_tvalid(span_valid),
      .s_axis_tready(driven[0]),
      .s_axis_tdata(span),
      .s_axis_tlast(span_last),
      .m_axis_tvalid(driven[1]),
      .m_axis_tready(pixel_ready),
      .m_axis_tdata(driven[OUTPUTS-1:6]),
      .m_axis_tlast(driven[2]),
      .illegal_span(driven[3]),
      .zero_normal(driven[4]),
      .unsupported(driven[5])
  );

  always @(posedge clk) begin
    inputs <= {inputs[INPUTS-2:0], in};
    outputs <= {outputs[OUTPUTS-2:0], 1'b0} ^ driven;
  end

  assign out = outputs[OUTPUTS-1];

endmodule

`default_nettype wire
