// SPDX-License-Identifier: MIT
// pipeline_bench: testbench top level with phong_pipeline and its latency. The ports are those of
// phong_pipeline.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module pipeline_bench #(
    parameter ADDRESS_BITS = `PHONG_ADDRESS_BITS,
    parameter WORD_BITS    = 2 * `PHONG_COEFFICIENT_BITS + 1,
    parameter SPAN_BITS    = `PHONG_SPAN_BITS,
    parameter PIXEL_BITS   = 2 * `PHONG_COORDINATE_BITS + 3 * `PHONG_COLOUR_BITS
) (
    input  wire                    clk,
    input  wire                    reset,
    input  wire                    write_enable,
    input  wire [ADDRESS_BITS-1:0] write_address,
    input  wire [WORD_BITS-1:0]    write_word,
    input  wire                    s_axis_tvalid,
    output wire                    s_axis_tready,
    input  wire [SPAN_BITS-1:0]    s_axis_tdata,
    input  wire                    s_axis_tlast,
    output wire                    m_axis_tvalid,
    input  wire                    m_axis_tready,
    output wire [PIXEL_BITS-1:0]   m_axis_tdata,
    output wire                    m_axis_tlast,
    output wire                    illegal_span,
    output wire                    zero_normal,
    output wire                    unsupported,
    output wire [31:0]             pixel_latency  // cycles, PHONG_PIXEL_LATENCY
);

  assign pixel_latency = `PHONG_PIXEL_LATENCY;

  phong_pipeline dut (
      .clk(clk),
      .reset(reset),
      .write_enable(write_enable),
      .write_address(write_address),
      .write_word(write_word),
      .s_axis_tvalid(s_axis_tvalid),
      .s_axis_tready(s_axis_tready),
      .s_axis_tdata(s_axis_tdata),
      .s_axis_tlast(s_axis_tlast),
      .m_axis_tvalid(m_axis_tvalid),
      .m_axis_tready(m_axis_tready),
      .m_axis_tdata(m_axis_tdata),
      .m_axis_tlast(m_axis_tlast),
      .illegal_span(illegal_span),
      .zero_normal(zero_normal),
      .unsupported(unsupported)
  );

endmodule

`default_nettype wire
