// SPDX-License-Identifier: MIT
// inverse_sqrt_iterated: 1/sqrt(x), x in [1, 4), from a start value by Newton's iteration.
// The start value is one of two:
//   table: a constant per segment of [1, 2) and of [2, 4);
//   fast inverse: the fast inverse square root with the constant 0x5f3759df. Exponent and fraction
//     of x, read as one number, are log2(x) within 0.09. The constant minus half of that number,
//     read back the same way, is 1/sqrt(x) within 3.5 %. The operand's own bits are used, extended
//     to the fraction of a float32; the result is the float32 result to the bit, cut to the word.
// The leading bit is implied: an operand in [0, 1) stands for 1 + x.
// Latency: LATENCY cycles (PHONG_INVERSE_SQRT_ITERATED_LATENCY in latency.vh; 3 by default, that is
// without a Newton step).
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module inverse_sqrt_iterated (
    input  wire                                clk,
    input  wire [`PHONG_ROOT_OPERAND_BITS-1:0] operand,  // u2.20, x
    output wire [`PHONG_ROOT_BITS-1:0]         root      // u0.18, 1/sqrt(x), in (0.48, 1]
);

  localparam OPERAND_BITS = `PHONG_ROOT_OPERAND_BITS;
  localparam INDEX_BITS   = `PHONG_START_INDEX_BITS;   // 2^INDEX_BITS segments per octave
  localparam ROOT_BITS    = `PHONG_ROOT_BITS;
  localparam FAST_INVERSE = `PHONG_ROOT_METHOD == `PHONG_ROOT_METHOD_FAST_INVERSE;
  localparam STEPS        = `PHONG_ROOT_NEWTON_STEPS;  // 0 or more
  localparam LATENCY      = `PHONG_INVERSE_SQRT_ITERATED_LATENCY;

  // ---- start ----
  wire high = operand[OPERAND_BITS-1];  // x >= 2

  wire [ROOT_BITS-1:0] x_p3;      // u2.16, x with its leading bit
  wire [ROOT_BITS-1:0] start_p3;  // u0.18, start value

  delay #(
      .BITS  (ROOT_BITS),
      .CYCLES(`PHONG_INVERSE_SQRT_START_LATENCY)
  ) u_x (
      .clk(clk),
      .in ({high, operand[OPERAND_BITS-2] | ~high,
            operand[OPERAND_BITS-3-:ROOT_BITS-2]}),
      .out(x_p3)
  );

  generate
    if (FAST_INVERSE) begin : gen_fast_inverse
      localparam FRACTION = 23;  // fraction bits of a float32
      // 0x5f3759df without the exponent biases of x (halved) and of the result.
      localparam [FRACTION:0] CONSTANT = 24'hf759df;  // 0x5f3759df - 127 * 2^22 - 125 * 2^23

      reg [FRACTION:0] log_p1;          // exponent (one bit) and fraction of x
      reg [FRACTION:0] half_p2;         // the same of the estimate; exponent 1: in [1/2, 1)
      reg [ROOT_BITS-1:0] estimate_p3;  // u0.18

      always @(posedge clk) begin
        log_p1 <= {high, high ? operand[OPERAND_BITS-2:0] : {operand[OPERAND_BITS-3:0], 1'b0},
                   {FRACTION + 1 - OPERAND_BITS{1'b0}}};
        half_p2 <= CONSTANT - {1'b0, log_p1[FRACTION:1]};
        estimate_p3 <= half_p2[FRACTION] ? {1'b1, half_p2[FRACTION-1-:ROOT_BITS-1]}
                                         : {2'b01, half_p2[FRACTION-1-:ROOT_BITS-2]};
      end

      wire unused = &{1'b0, log_p1[0], half_p2[FRACTION-ROOT_BITS:0]};

      assign start_p3 = estimate_p3;
    end else begin : gen_table
      reg [INDEX_BITS:0] address_p1;  // {octave, segment}

      always @(posedge clk) begin
        address_p1 <= {high, high ? operand[OPERAND_BITS-2-:INDEX_BITS]
                                  : operand[OPERAND_BITS-3-:INDEX_BITS]};
      end

      rom #(
          .ADDRESS_BITS(INDEX_BITS + 1),
          .WORD_BITS(ROOT_BITS),
          .CONTENTS(`PHONG_INVERSE_SQRT_START_TABLE)
      ) u_start (
          .clk(clk),
          .address(address_p1),
          .word(start_p3)
      );
    end
  endgenerate

  // ---- steps ----
  wire [ROOT_BITS-1:0] x[0:STEPS];  // u2.16, x beside each estimate
  wire [ROOT_BITS-1:0] y[0:STEPS];  // u0.18, estimate after so many steps

  assign x[0] = x_p3;
  assign y[0] = start_p3;
  assign root = y[STEPS];

  genvar s;
  generate
    for (s = 0; s < STEPS; s = s + 1) begin : gen_step
      newton_step #(
          .BITS(ROOT_BITS)
      ) u_step (
          .clk(clk),
          .x(x[s]),
          .y(y[s]),
          .x_out(x[s+1]),
          .better(y[s+1])
      );
    end
  endgenerate

  wire unused_x = &{1'b0, x[STEPS]};

  generate
    if (OPERAND_BITS > ROOT_BITS) begin : gen_unused
      wire unused_operand = &{1'b0, operand[OPERAND_BITS-ROOT_BITS-1:0]};
    end
  endgenerate

endmodule

`default_nettype wire
