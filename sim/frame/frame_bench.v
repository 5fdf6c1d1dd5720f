// SPDX-License-Identifier: MIT
// frame_bench: testbench top level that runs whole frames through phong_pipeline.
// Spans come from a file and pixels go to a file, so that no cycle involves Python. cocotb writes
// the registers, starts a job and reads the counters.
`default_nettype none
`include "phong_config.vh"

module frame_bench #(
    parameter ADDRESS_BITS = `PHONG_ADDRESS_BITS,
    parameter WORD_BITS    = 2 * `PHONG_COEFFICIENT_BITS + 1,
    parameter SPAN_BITS    = `PHONG_SPAN_BITS,
    parameter PIXEL_BITS   = 2 * `PHONG_COORDINATE_BITS + 3 * `PHONG_COLOUR_BITS,
    parameter RECORD_BITS  = `PHONG_RECORD_BITS
) (
    input wire clk,
    input wire reset,

    // register writes
    input wire                    write_enable,
    input wire [ADDRESS_BITS-1:0] write_address,
    input wire [WORD_BITS-1:0]    write_word,

    // a job: spans from the file <job>.spans, pixels to the file <job>.pixels
    input wire        start,
    input wire [31:0] job,           // number of the job
    input wire [31:0] skip,          // bytes of <job>.spans before the first record
    input wire [31:0] spans,         // records in the file
    input wire [31:0] pixels,        // pixels to wait for
    input wire [31:0] stop_after,    // cycles after which the job is broken off; 0: never
    input wire [7:0]  idle_chance,   // of 256: no span is offered in a cycle
    input wire [7:0]  stall_chance,  // of 256: no pixel is taken in a cycle
    input wire [31:0] seed,          // of idle and stall cycles

    // state and counters of the job
    output reg        running,
    output reg        complete,       // all pixels came
    output reg [31:0] cycles,         // from the first span accepted to the last pixel taken
    output reg [31:0] latency,        // cycles from the first span accepted to the first pixel
    output reg [31:0] stall_cycles,   // of `cycles`, after the first pixel: no pixel was taken
    output reg [31:0] pixel_count,    // pixels taken
    output reg [31:0] illegal_spans,  // pulses of illegal_span
    output reg [31:0] unsupported,    // pulses of unsupported, of all jobs and writes so far
    output reg [31:0] zero_normals,   // pixels whose normal was the zero vector
    output reg [31:0] extra_pixels    // pixels after the last one
);

  localparam PATIENCE = 100000;  // cycles without a pixel after which a job is given up

  reg s_valid, s_last;
  wire s_ready;
  reg [SPAN_BITS-1:0] s_data;
  wire m_valid, m_last;
  wire [PIXEL_BITS-1:0] m_data;
  reg m_ready;
  wire illegal_span, zero_normal, unsupported_now;

  phong_pipeline dut (
      .clk(clk),
      .reset(reset),
      .write_enable(write_enable),
      .write_address(write_address),
      .write_word(write_word),
      .s_axis_tvalid(s_valid),
      .s_axis_tready(s_ready),
      .s_axis_tdata(s_data),
      .s_axis_tlast(s_last),
      .m_axis_tvalid(m_valid),
      .m_axis_tready(m_ready),
      .m_axis_tdata(m_data),
      .m_axis_tlast(m_last),
      .illegal_span(illegal_span),
      .zero_normal(zero_normal),
      .unsupported(unsupported_now)
  );

  reg [255:0] name;
  integer in_file, out_file, got;
  reg [RECORD_BITS-1:0] record;
  reg [31:0] spans_read, clocks, waited;
  reg accepted;  // a span of this job has been accepted
  reg [31:0] random;

  initial begin
    running = 0;
    unsupported = 0;
    s_valid = 0;
    m_ready = 0;
  end

  // Galois LFSR of the polynomial x^32 + x^22 + x^2 + x + 1.
  function [31:0] next_random(input [31:0] r);
    next_random = {1'b0, r[31:1]} ^ (r[0] ? 32'h80200003 : 32'h0);
  endfunction

  wire take = m_valid & m_ready;
  wire [31:0] pixel_count_next = pixel_count + {31'b0, take};

  always @(posedge clk) begin
    unsupported <= unsupported + {31'b0, unsupported_now};
    random <= next_random(random);
    m_ready <= running & (stall_chance == 0 | random[7:0] >= stall_chance);

    if (reset) begin
      running <= 0;
      s_valid <= 0;
    end else if (!running & start) begin
      $sformat(name, "%0d.spans", job);
      in_file = $fopen(name, "rb");
      got = $fseek(in_file, skip, 0);
      $sformat(name, "%0d.pixels", job);
      out_file = $fopen(name, "wb");
      spans_read <= 0;
      s_valid <= 0;
      random <= seed | 1;
      running <= 1;
      complete <= 0;
      accepted <= 0;
      clocks <= 0;
      cycles <= 0;
      latency <= 0;
      stall_cycles <= 0;
      pixel_count <= 0;
      waited <= 0;
      illegal_spans <= 0;
      zero_normals <= 0;
      extra_pixels <= 0;
    end else if (running) begin
      // ---- spans in ----
      if (!s_valid | s_ready) begin
        if (spans_read < spans & (idle_chance == 0 | random[15:8] >= idle_chance)) begin
          got = $fread(record, in_file);
          s_valid <= 1;
          s_data <= record[SPAN_BITS-1:0];
          s_last <= record[SPAN_BITS];
          spans_read <= spans_read + 1;
        end else s_valid <= 0;
      end

      // ---- pixels out: {last, y, x, red, green, blue} in two 32-bit words ----
      if (take) begin
        $fwrite(out_file, "%u", {{63 - PIXEL_BITS{1'b0}}, m_last, m_data});
        pixel_count <= pixel_count_next;
      end

      // ---- counters ----
      clocks <= clocks + 1;
      accepted <= accepted | (s_valid & s_ready);
      if (accepted) begin
        cycles <= cycles + 1;
        if (latency == 0 & m_valid) latency <= cycles + 1;
        if (pixel_count != 0 & !take) stall_cycles <= stall_cycles + 1;
      end
      illegal_spans <= illegal_spans + {31'b0, illegal_span};
      zero_normals <= zero_normals + {31'b0, zero_normal};

      waited <= take ? 0 : waited + 1;
      if (pixel_count_next == pixels | waited == PATIENCE
          | (stop_after != 0 & clocks == stop_after)) begin
        complete <= pixel_count_next == pixels;
        running <= 0;
        s_valid <= 0;
        $fclose(in_file);
        $fclose(out_file);
      end
    end else if (m_valid) extra_pixels <= extra_pixels + 1;
  end

endmodule

`default_nettype wire
