// SPDX-License-Identifier: MIT
// newton_step: one step of Newton's iteration for 1/sqrt(x) from an estimate y,
//   e = 1 - x y^2, y' = y + y e / 2.
// The relative error of y' is 3/2 of the square of that of y. Only the small e is rounded to few
// bits, so that y loses none.
// Latency: LATENCY cycles (PHONG_NEWTON_STEP_LATENCY in latency.vh; 12 by default).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module newton_step #(
    parameter BITS    = `PHONG_ROOT_BITS,  // width of x and y
    parameter LATENCY = `PHONG_NEWTON_STEP_LATENCY
) (
    input  wire            clk,
    input  wire [BITS-1:0] x,      // u2.16, in [1, 4)
    input  wire [BITS-1:0] y,      // u0.18, within 11 % of 1/sqrt(x)
    output wire [BITS-1:0] x_out,  // u2.16, x of the result
    output wire [BITS-1:0] better  // u0.18, the better estimate y'
);

  localparam PRODUCT_BITS = 2 * BITS;
  localparam ERROR_FRACTION = BITS + 1;                       // of e; |e| < 1/4
  localparam ERROR_DROP = PRODUCT_BITS - 2 - ERROR_FRACTION;  // fraction bits of x y^2 cut off

  // Cycles from the input to y^2 and to e.
  localparam SQUARE_AT = `PHONG_MULTIPLIER_LATENCY + `PHONG_ROUND_SATURATE_LATENCY;
  localparam ERROR_AT = SQUARE_AT + `PHONG_MULTIPLIER_LATENCY + 1;

  // ---- error: 1 - x y^2 ----
  wire [PRODUCT_BITS-1:0] square_p2;
  wire [BITS-1:0] square_p4;            // u0.18, y^2
  wire [BITS-1:0] x_p4;
  wire [PRODUCT_BITS-1:0] near_one_p6;  // u2.34, x y^2
  reg [BITS-1:0] error_p7;              // e: two's complement, ERROR_FRACTION fraction bits

  multiplier #(
      .A_BITS  (BITS),
      .B_BITS  (BITS),
      .A_SIGNED(0),
      .B_SIGNED(0)
  ) u_square (
      .clk(clk),
      .a(y),
      .b(y),
      .product(square_p2)
  );

  round_saturate #(
      .IN_BITS  (PRODUCT_BITS),
      .DROP     (BITS),
      .OUT_BITS (BITS),
      .IS_SIGNED(0)
  ) u_square_round (
      .clk(clk),
      .in (square_p2),
      .out(square_p4)
  );

  delay #(
      .BITS  (BITS),
      .CYCLES(SQUARE_AT)
  ) u_x (
      .clk(clk),
      .in (x),
      .out(x_p4)
  );

  multiplier #(
      .A_BITS  (BITS),
      .B_BITS  (BITS),
      .A_SIGNED(0),
      .B_SIGNED(0)
  ) u_near_one (
      .clk(clk),
      .a(x_p4),
      .b(square_p4),
      .product(near_one_p6)
  );

  // e = 1 - p, p = x y^2. The 1 is above the kept bits, where e is therefore -p. ~p stands for -p;
  // it is at most one unit of e too small.
  always @(posedge clk) error_p7 <= ~near_one_p6[ERROR_DROP+:BITS];

  wire unused = &{1'b0, near_one_p6[PRODUCT_BITS-1:ERROR_DROP+BITS], near_one_p6[ERROR_DROP-1:0]};

  // ---- better: y + y e / 2 ----
  localparam BETTER_FRACTION = BITS + ERROR_FRACTION + 1;  // of the exact sum

  wire [BITS-1:0] y_p7;
  wire [BITS-1:0] y_p9;
  wire [PRODUCT_BITS-1:0] change_p9;  // y e, exact
  reg [BETTER_FRACTION:0] sum_p10;

  delay #(
      .BITS  (BITS),
      .CYCLES(ERROR_AT)
  ) u_y (
      .clk(clk),
      .in (y),
      .out(y_p7)
  );

  multiplier #(
      .A_BITS  (BITS),
      .B_BITS  (BITS),
      .A_SIGNED(0)
  ) u_change (
      .clk(clk),
      .a(y_p7),
      .b(error_p7),
      .product(change_p9)
  );

  delay #(
      .BITS  (BITS),
      .CYCLES(`PHONG_MULTIPLIER_LATENCY)
  ) u_y_wait (
      .clk(clk),
      .in (y_p7),
      .out(y_p9)
  );

  always @(posedge clk) begin
    sum_p10 <= {1'b0, y_p9, {ERROR_FRACTION + 1{1'b0}}}
        + {{BETTER_FRACTION + 1 - PRODUCT_BITS{change_p9[PRODUCT_BITS-1]}}, change_p9};
  end

  round_saturate #(
      .IN_BITS  (BETTER_FRACTION + 1),
      .DROP     (ERROR_FRACTION + 1),
      .OUT_BITS (BITS),
      .IS_SIGNED(0)
  ) u_better (
      .clk(clk),
      .in (sum_p10),
      .out(better)
  );

  delay #(
      .BITS  (BITS),
      .CYCLES(LATENCY - SQUARE_AT)
  ) u_x_out (
      .clk(clk),
      .in (x_p4),
      .out(x_out)
  );

endmodule

`default_nettype wire
