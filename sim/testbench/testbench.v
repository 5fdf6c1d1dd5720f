// SPDX-License-Identifier: MIT
// testbench: plain Verilog testbench of phong_pipeline. It writes the registers, streams a frame of
// spans, of TURNS records each, and compares every pixel with the expected one, three times:
//   1. without pauses: latency and rate are checked, too;
//   2. with random pauses of both streams;
//   3. with other pauses, after a run that a reset breaks off.
// It prints `PASS n pixels`, or `FAIL` with the first difference; after a FAIL the simulator ends
// with $stop, which Verilator and `vvp -N` turn into an exit code other than 0.
// `phong75 export` fills in the numbers of a configuration and writes the three files.
`default_nettype none

module testbench #(
    parameter SPANS_FILE  = "sim/spans.hex",   // {last, record}
    parameter WRITES_FILE = "sim/writes.hex",  // {address, word}
    parameter PIXELS_FILE = "sim/pixels.hex",  // {last, pixel}
    parameter FINISH      = 1                  // 0: the parent reads done and failed
);

  localparam SPAN_BITS       = 233;
  localparam ADDRESS_BITS    = 10;
  localparam WORD_BITS       = 35;
  localparam COORDINATE_BITS = 12;
  localparam COLOUR_BITS     = 8;
  localparam TURNS           = 1;  // records of a span, and cycles of a pixel
  localparam LATENCY         = 77;  // cycles from the first span taken to the first pixel offered
  localparam RECORDS         = 635;  // records of all spans of the frame
  localparam WRITES          = 276;
  localparam PIXELS          = 872;
  localparam ZERO_NORMALS    = 0;  // pixels that the pipeline reports as zero vectors

  localparam PIXEL_BITS = 2 * COORDINATE_BITS + 3 * COLOUR_BITS;
  localparam PATIENCE   = 10000;  // cycles without a pixel after which the run is given up
  localparam QUIET      = 300;    // cycles after the frame in which no pixel may come
  localparam LAST_WRITE = WRITES > 0 ? WRITES - 1 : 0;  // the file has one word at least

  // ---- stimulus and expected pixels ----
  reg [SPAN_BITS:0] spans[0:RECORDS-1];
  reg [ADDRESS_BITS+WORD_BITS-1:0] writes[0:LAST_WRITE];
  reg [PIXEL_BITS:0] pixels[0:PIXELS-1];

  // ---- pipeline ----
  reg clk, reset;
  reg write_enable;
  reg [ADDRESS_BITS-1:0] write_address;
  reg [WORD_BITS-1:0] write_word;
  reg span_valid, span_last;
  reg [SPAN_BITS-1:0] span;
  reg pixel_ready;
  wire span_ready, pixel_valid, pixel_last;
  wire [PIXEL_BITS-1:0] pixel;
  wire illegal_span, zero_normal, unsupported;

  phong_pipeline dut (
      .clk(clk),
      .reset(reset),
      .write_enable(write_enable),
      .write_address(write_address),
      .write_word(write_word),
      .s_axis_tvalid(span_valid),
      .s_axis_tready(span_ready),
      .s_axis_tdata(span),
      .s_axis_tlast(span_last),
      .m_axis_tvalid(pixel_valid),
      .m_axis_tready(pixel_ready),
      .m_axis_tdata(pixel),
      .m_axis_tlast(pixel_last),
      .illegal_span(illegal_span),
      .zero_normal(zero_normal),
      .unsupported(unsupported)
  );

  initial clk = 1'b0;
  always #5 clk = ~clk;

  // ---- control, set at falling edges; everything else changes at rising edges ----
  reg running;         // spans are offered, pixels are taken
  reg comparing;       // 0: pixels are dropped
  reg [7:0] idle;      // of 256: a cycle in which no new span is offered
  reg [7:0] stall;     // of 256: a cycle in which no pixel is taken
  reg done, failed;

  integer next_span;   // number of the next record to be offered
  integer next_pixel;  // number of the next pixel to come
  integer cycles;      // cycles since the first span was taken
  integer first_at;    // value of `cycles` at the first pixel offered
  integer last_at;     // value of `cycles` at the last pixel taken
  integer zeros;       // zero normals reported
  integer waited;      // cycles since a pixel was taken
  integer total;       // pixels compared in all runs
  integer k;
  reg started;         // a span was taken
  reg offered;         // a pixel waited in the last cycle
  reg [PIXEL_BITS:0] held;  // that pixel
  reg [31:0] random;

  // Galois LFSR, x^32 + x^22 + x^2 + x + 1.
  function [31:0] next_random(input [31:0] r);
    next_random = {1'b0, r[31:1]} ^ (r[0] ? 32'h80200003 : 32'h0);
  endfunction

  wire take = pixel_valid & pixel_ready;
  wire [PIXEL_BITS:0] expected = pixels[next_pixel<PIXELS?next_pixel : 0];

  // Report the first failure only; later ones follow from it.
  task automatic fail;
    begin
      failed = 1'b1;
      done = 1'b1;
      if (FINISH != 0) begin
        $stop;
        $finish;
      end
    end
  endtask

  always @(posedge clk) begin
    random <= next_random(random);

    if (reset | ~running) begin
      span_valid <= 1'b0;
      pixel_ready <= 1'b0;
      next_span <= 0;
      next_pixel <= 0;
      cycles <= 0;
      first_at <= 0;
      last_at <= 0;
      zeros <= 0;
      waited <= 0;
      started <= 1'b0;
      offered <= 1'b0;
    end else begin
      // Spans in: once offered, a span stays until it is taken.
      if (~span_valid | span_ready) begin
        span_valid <= next_span < RECORDS && random[15:8] >= idle;
        if (next_span < RECORDS && random[15:8] >= idle) begin
          {span_last, span} <= spans[next_span];
          next_span <= next_span + 1;
        end
      end
      pixel_ready <= random[7:0] >= stall;

      // Cycles are counted from the first span taken.
      started <= started | (span_valid & span_ready);
      if (started) cycles <= cycles + 1;
      if (pixel_valid & (first_at == 0)) first_at <= cycles + 1;
      if (take) last_at <= cycles + 1;
      if (zero_normal) zeros <= zeros + 1;
      waited <= take ? 0 : waited + 1;

      // Pixels out.
      offered <= pixel_valid & ~pixel_ready;
      held <= {pixel_last, pixel};
      if (take) next_pixel <= next_pixel + 1;
    end
  end

  always @(posedge clk) begin
    if (running & comparing & ~reset & ~done) begin
      if (take & (next_pixel >= PIXELS)) begin
        $display("FAIL a pixel after the last one of the frame");
        fail;
      end else if (take & ({pixel_last, pixel} !== expected)) begin
        $display("FAIL pixel %0d of %0d: (x %0d, y %0d) red %0d green %0d blue %0d last %b;",
                 next_pixel, PIXELS, pixel[3*COLOUR_BITS+:COORDINATE_BITS],
                 pixel[3*COLOUR_BITS+COORDINATE_BITS+:COORDINATE_BITS],
                 pixel[2*COLOUR_BITS+:COLOUR_BITS], pixel[COLOUR_BITS+:COLOUR_BITS],
                 pixel[0+:COLOUR_BITS], pixel_last,
                 " expected (x %0d, y %0d) red %0d green %0d blue %0d last %b",
                 expected[3*COLOUR_BITS+:COORDINATE_BITS],
                 expected[3*COLOUR_BITS+COORDINATE_BITS+:COORDINATE_BITS],
                 expected[2*COLOUR_BITS+:COLOUR_BITS], expected[COLOUR_BITS+:COLOUR_BITS],
                 expected[0+:COLOUR_BITS], expected[PIXEL_BITS]);
        fail;
      end else if (offered & (~pixel_valid | ({pixel_last, pixel} !== held))) begin
        $display("FAIL pixel %0d changed while it waited to be taken", next_pixel);
        fail;
      end else if (illegal_span !== 1'b0) begin
        $display("FAIL illegal_span, before pixel %0d", next_pixel);
        fail;
      end else if (zero_normal === 1'bx | zeros > ZERO_NORMALS) begin
        $display("FAIL zero_normal more than %0d times, before pixel %0d", ZERO_NORMALS,
                 next_pixel);
        fail;
      end else if (waited >= PATIENCE) begin
        $display("FAIL no pixel came in %0d cycles; %0d of %0d did", PATIENCE, next_pixel, PIXELS);
        fail;
      end
    end
    if (~reset & ~done & (write_enable | running) & (unsupported !== 1'b0)) begin
      $display("FAIL unsupported");
      fail;
    end
  end

  // ---- the sequence of the test ----
  task automatic pulse_reset(input integer length);
    begin
      reset = 1'b1;
      repeat (length) @(negedge clk);
      reset = 1'b0;
    end
  endtask

  task automatic write_registers;
    begin
      for (k = 0; k < WRITES; k = k + 1) begin
        @(negedge clk) write_enable = 1'b1;
        {write_address, write_word} = writes[k];
      end
      @(negedge clk) write_enable = 1'b0;
      repeat (4) @(negedge clk);
    end
  endtask

  // The whole frame; idle_chance, stall_chance: of 256.
  task automatic run(input [7:0] idle_chance, input [7:0] stall_chance);
    begin
      @(negedge clk) running = 1'b1;
      comparing = 1'b1;
      idle = idle_chance;
      stall = stall_chance;
      while (~done & (next_pixel < PIXELS)) @(negedge clk);
      stall = 8'd0;
      repeat (QUIET) @(negedge clk);
      if (~done & (zeros != ZERO_NORMALS)) begin
        $display("FAIL zero_normal %0d times, expected %0d", zeros, ZERO_NORMALS);
        fail;
      end
      if (~done & (idle_chance == 0) & (stall_chance == 0)) begin
        if (first_at != LATENCY) begin
          $display("FAIL the first pixel came after %0d cycles, expected %0d", first_at, LATENCY);
          fail;
        end else if (last_at != LATENCY + TURNS * (PIXELS - 1)) begin
          $display("FAIL %0d pixels took %0d cycles, expected %0d", PIXELS, last_at,
                   LATENCY + TURNS * (PIXELS - 1));
          fail;
        end
      end
      total = total + next_pixel;
      running = 1'b0;
      @(negedge clk);
    end
  endtask

  // A frame that stops with pixels on their way.
  task automatic break_off;
    begin
      @(negedge clk) running = 1'b1;
      comparing = 1'b0;
      idle = 8'd0;
      stall = 8'd200;
      repeat (LATENCY + 150 * TURNS) @(negedge clk);
      running = 1'b0;
      pulse_reset(1);
    end
  endtask

  initial begin
    $readmemh(SPANS_FILE, spans);
    $readmemh(WRITES_FILE, writes);
    $readmemh(PIXELS_FILE, pixels);
    random = 32'd1975;
    {reset, write_enable, running, comparing, done, failed} = 6'b0;
    idle = 8'd0;
    stall = 8'd0;
    total = 0;
    @(negedge clk) pulse_reset(8);
    write_registers;
    run(8'd0, 8'd0);
    run(8'd64, 8'd128);
    break_off;
    run(8'd160, 8'd64);
    if (~failed) $display("PASS %0d pixels", total);
    done = 1'b1;
    if (FINISH != 0) $finish;
  end

endmodule

`default_nettype wire
