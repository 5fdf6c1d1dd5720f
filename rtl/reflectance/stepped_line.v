// SPDX-License-Identifier: MIT
// stepped_line: left + step * offset - fall, a straight line from `left` to `left` + `step`, minus
// the amounts of jumps. A negative value gives 0, one beyond the word its largest code.
// Latency: LATENCY cycles from `left` (PHONG_STEPPED_LINE_LATENCY in latency.vh; 6 by default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module stepped_line #(
    parameter OFFSET_BITS = `PHONG_COSINE_BITS - `PHONG_WEIGHT_INDEX_BITS,
    parameter OUT_BITS    = `PHONG_WEIGHT_BITS,
    parameter DROP        = OFFSET_BITS + `PHONG_COEFFICIENT_FRACTION - `PHONG_WEIGHT_FRACTION,
    parameter LATENCY     = `PHONG_STEPPED_LINE_LATENCY
) (
    input wire clk,

    input wire [`PHONG_COEFFICIENT_BITS-1:0] left,    // u1.16
    input wire [`PHONG_COEFFICIENT_BITS:0]   step,    // s1.16
    input wire [OFFSET_BITS-1:0]             offset,  // unsigned, all of it fraction

    // PHONG_STEPPED_FALL_LATENCY cycles later
    input  wire [`PHONG_COEFFICIENT_BITS+1:0] fall,  // u3.16
    output wire [OUT_BITS-1:0]                value  // unsigned, DROP fraction bits less
);

  localparam COEFFICIENT_BITS = `PHONG_COEFFICIENT_BITS;
  localparam STEP_BITS = COEFFICIENT_BITS + 1;
  localparam LINE_BITS = STEP_BITS + OFFSET_BITS + 1;  // from -2 to 4
  localparam LEVEL_BITS = LINE_BITS + 2;               // from -10 to 4

  // ---- line ----
  wire [STEP_BITS+OFFSET_BITS-1:0] rise_p2;
  wire [COEFFICIENT_BITS-1:0] left_p2;
  reg [LINE_BITS-1:0] line_p3;

  multiplier #(
      .A_BITS  (STEP_BITS),
      .B_BITS  (OFFSET_BITS),
      .B_SIGNED(0)
  ) u_step (
      .clk(clk),
      .a(step),
      .b(offset),
      .product(rise_p2)
  );

  delay #(
      .BITS  (COEFFICIENT_BITS),
      .CYCLES(`PHONG_MULTIPLIER_LATENCY)
  ) u_left (
      .clk(clk),
      .in (left),
      .out(left_p2)
  );

  always @(posedge clk) begin
    line_p3 <= {2'b00, left_p2, {OFFSET_BITS{1'b0}}}
        + {rise_p2[STEP_BITS+OFFSET_BITS-1], rise_p2};
  end

  // ---- level ----
  reg [LEVEL_BITS-1:0] level_p4;

  always @(posedge clk) begin
    level_p4 <= {{2{line_p3[LINE_BITS-1]}}, line_p3} - {2'b00, fall, {OFFSET_BITS{1'b0}}};
  end

  // ---- result ----
  round_saturate #(
      .IN_BITS  (LEVEL_BITS - 1),
      .DROP     (DROP),
      .OUT_BITS (OUT_BITS),
      .IS_SIGNED(0)
  ) u_value (
      .clk(clk),
      .in (level_p4[LEVEL_BITS-2:0] & {LEVEL_BITS - 1{~level_p4[LEVEL_BITS-1]}}),
      .out(value)
  );

endmodule

`default_nettype wire
