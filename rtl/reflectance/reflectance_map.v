// SPDX-License-Identifier: MIT
// reflectance_map: decodes what the write port holds for curves of cos(s) and for jumps, beside
// register_map. A build without curves and jumps has no such words: all writes go on.
//
//   address                        word
//   {1, zeros, material, line}     {step s1.16, left u1.16}: a line of a curve (builds with curves)
//   {..., 1, material, 16 + 2 k}   jump k of W(i): {above, threshold u0.18}
//   {..., 1, material, 17 + 2 k}   jump k of W(i): amount, u1.16
//   {..., 1, material, 24 + 2 k}   jump k of the curve: {above, threshold u0.22}
//   {..., 1, material, 25 + 2 k}   jump k of the curve: amount, u1.16
//
// Latency: 0 cycles to `plain_enable`, 1 to the strobes, as in register_map.
// Throughput: one write per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"

module reflectance_map #(
    parameter ADDRESS_BITS  = `PHONG_ADDRESS_BITS,
    parameter MATERIAL_BITS = `PHONG_MATERIAL_BITS,
    parameter INDEX_BITS    = `PHONG_WEIGHT_INDEX_BITS,  // of a field
    parameter SEGMENT_BITS  = `PHONG_SEGMENT_BITS,       // of a line of a curve
    parameter CURVES        = `PHONG_HAS_CURVES,         // 0: the top bit of the address is plain
    parameter REFLECTANCE   = `PHONG_HAS_CURVES || `PHONG_WEIGHT_JUMPS > 0  // 1: such words
) (
    input wire clk,

    // write port
    input wire                    write_enable,   // 1: write
    input wire [ADDRESS_BITS-1:0] write_address,  // see above

    output wire plain_enable,  // the write is for register_map and light_map

    // strobes for the tables
    output wire                                 write_curve,         // a line of a curve
    output wire [MATERIAL_BITS+SEGMENT_BITS-1:0] write_line,          // its address
    output wire [2*`PHONG_MAX_JUMPS-1:0]         write_curve_jumps,   // see `jumps`
    output wire [2*`PHONG_MAX_JUMPS-1:0]         write_weight_jumps
);

  localparam [INDEX_BITS-1:0] WEIGHT_JUMP = `PHONG_FIELD_WEIGHT_JUMP;
  localparam [INDEX_BITS-1:0] CURVE_JUMP = `PHONG_FIELD_CURVE_JUMP;
  localparam WORDS = 2 * `PHONG_MAX_JUMPS;  // of the jumps of one material
  localparam LINE_BITS = MATERIAL_BITS + SEGMENT_BITS;

  generate
    if (REFLECTANCE) begin : gen_reflectance
      reg curve;
      reg [LINE_BITS-1:0] line;
      reg [WORDS-1:0] curve_jumps, weight_jumps;

      wire to_curve = (CURVES != 0) & write_address[ADDRESS_BITS-1];
      wire [LINE_BITS+ADDRESS_BITS-1:0] padded = {{LINE_BITS{1'b0}}, write_address};
      wire [INDEX_BITS-1:0] field = write_address[INDEX_BITS-1:0];
      wire write_field = plain_enable & write_address[MATERIAL_BITS+INDEX_BITS];

      integer k;
      always @(posedge clk) begin
        curve <= write_enable & to_curve;
        line <= padded[LINE_BITS-1:0];
        for (k = 0; k < WORDS; k = k + 1) begin
          curve_jumps[k] <= write_field & (field == CURVE_JUMP + k[INDEX_BITS-1:0]);
          weight_jumps[k] <= write_field & (field == WEIGHT_JUMP + k[INDEX_BITS-1:0]);
        end
      end

      assign plain_enable = write_enable & ~to_curve;
      assign write_curve = curve;
      assign write_line = line;
      assign write_curve_jumps = curve_jumps;
      assign write_weight_jumps = weight_jumps;

      wire unused = &{1'b0, padded};
    end else begin : gen_no_reflectance
      assign plain_enable = write_enable;
      assign write_curve = 1'b0;
      assign write_line = {LINE_BITS{1'b0}};
      assign write_curve_jumps = {WORDS{1'b0}};
      assign write_weight_jumps = {WORDS{1'b0}};

      wire unused = &{1'b0, clk, write_address};
    end
  endgenerate

endmodule

`default_nettype wire
