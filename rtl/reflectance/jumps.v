// SPDX-License-Identifier: MIT
// jumps: the sum of the amounts of the jumps whose side an operand is on.
// A material has JUMPS jumps. A jump applies at and above its threshold, or below it.
// Latency: LATENCY cycles from `material` (PHONG_JUMPS_LATENCY in latency.vh; 4 by default).
// Throughput: one result per cycle.
// Reset: none; the tables are undefined until written.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module jumps #(
    parameter JUMPS         = 1,  // 1 to PHONG_MAX_JUMPS
    parameter OPERAND_BITS  = `PHONG_COSINE_BITS,
    parameter MATERIAL_BITS = `PHONG_MATERIAL_BITS,
    parameter AMOUNT_BITS   = `PHONG_COEFFICIENT_BITS,
    parameter LATENCY       = `PHONG_JUMPS_LATENCY
) (
    input wire clk,

    // write port: for each jump {amount, threshold}; the word is {above, threshold}, or an amount
    // in u1.16
    input wire [2*`PHONG_MAX_JUMPS-1:0] write_enable,
    input wire [MATERIAL_BITS-1:0]      write_address,  // material
    input wire [OPERAND_BITS:0]         write_word,

    // a pixel: its material comes PHONG_SMALL_RAM_LATENCY cycles before its operand
    input  wire [MATERIAL_BITS-1:0] material,  // index
    input  wire [OPERAND_BITS-1:0]  operand,   // any unsigned format
    output reg  [AMOUNT_BITS+1:0]   sum        // u3.16, LATENCY cycles after `material`
);

  localparam MOST = `PHONG_MAX_JUMPS;  // 4

  // ---- select: the amount where the jump applies, else 0 ----
  wire [MOST*AMOUNT_BITS-1:0] applied_p2;

  genvar k;
  generate
    for (k = 0; k < MOST; k = k + 1) begin : gen_jump
      if (k < JUMPS) begin : gen_there
        wire above;
        wire [OPERAND_BITS-1:0] threshold;
        wire [AMOUNT_BITS-1:0] amount;
        reg [AMOUNT_BITS-1:0] applied;

        small_ram #(
            .ADDRESS_BITS(MATERIAL_BITS),
            .WORD_BITS(OPERAND_BITS + 1)
        ) u_threshold (
            .clk(clk),
            .write_enable(write_enable[2*k]),
            .write_address(write_address),
            .write_word(write_word),
            .address(material),
            .word({above, threshold})
        );

        small_ram #(
            .ADDRESS_BITS(MATERIAL_BITS),
            .WORD_BITS(AMOUNT_BITS)
        ) u_amount (
            .clk(clk),
            .write_enable(write_enable[2*k+1]),
            .write_address(write_address),
            .write_word(write_word[AMOUNT_BITS-1:0]),
            .address(material),
            .word(amount)
        );

        always @(posedge clk) begin
          applied <= amount & {AMOUNT_BITS{(operand >= threshold) == above}};
        end

        assign applied_p2[k*AMOUNT_BITS+:AMOUNT_BITS] = applied;
      end else begin : gen_none
        assign applied_p2[k*AMOUNT_BITS+:AMOUNT_BITS] = {AMOUNT_BITS{1'b0}};
      end
    end
  endgenerate

  // ---- sum ----
  reg [AMOUNT_BITS:0] low_p3;
  reg [AMOUNT_BITS:0] high_p3;

  always @(posedge clk) begin
    low_p3 <= {1'b0, applied_p2[0+:AMOUNT_BITS]} + {1'b0, applied_p2[AMOUNT_BITS+:AMOUNT_BITS]};
    high_p3 <= {1'b0, applied_p2[2*AMOUNT_BITS+:AMOUNT_BITS]}
        + {1'b0, applied_p2[3*AMOUNT_BITS+:AMOUNT_BITS]};
    sum <= {1'b0, low_p3} + {1'b0, high_p3};
  end

  wire unused = &{1'b0, write_enable};

endmodule

`default_nettype wire
