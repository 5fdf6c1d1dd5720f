// SPDX-License-Identifier: MIT
// reflectance_map: decodes what the write port holds for curves of cos(s) and for jumps, beside
// register_map.
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
    parameter CURVES        = `PHONG_HAS_CURVES          // 0: the top bit of the address is plain
) (
    input wire clk,

    // write port
    input wire                    write_enable,   // 1: write
    input wire [ADDRESS_BITS-1:0] write_address,  // see above

    output wire plain_enable,  // the write is for register_map and light_map

    // strobes for the tables
    output reg                                  write_curve,         // a line of a curve
    output reg [MATERIAL_BITS+SEGMENT_BITS-1:0] write_line,          // its address
    output reg [2*`PHONG_MAX_JUMPS-1:0]         write_curve_jumps,   // see `jumps`
    output reg [2*`PHONG_MAX_JUMPS-1:0]         write_weight_jumps
);

  localparam [INDEX_BITS-1:0] WEIGHT_JUMP = `PHONG_FIELD_WEIGHT_JUMP;
  localparam [INDEX_BITS-1:0] CURVE_JUMP = `PHONG_FIELD_CURVE_JUMP;
  localparam WORDS = 2 * `PHONG_MAX_JUMPS;  // of the jumps of one material
  localparam LINE_BITS = MATERIAL_BITS + SEGMENT_BITS;

  wire to_curve = (CURVES != 0) & write_address[ADDRESS_BITS-1];
  wire [LINE_BITS+ADDRESS_BITS-1:0] padded = {{LINE_BITS{1'b0}}, write_address};
  wire [INDEX_BITS-1:0] field = write_address[INDEX_BITS-1:0];
  wire write_field = plain_enable & write_address[MATERIAL_BITS+INDEX_BITS];

  assign plain_enable = write_enable & ~to_curve;

  integer k;
  always @(posedge clk) begin
    write_curve <= write_enable & to_curve;
    write_line <= padded[LINE_BITS-1:0];
    for (k = 0; k < WORDS; k = k + 1) begin
      write_curve_jumps[k] <= write_field & (field == CURVE_JUMP + k[INDEX_BITS-1:0]);
      write_weight_jumps[k] <= write_field & (field == WEIGHT_JUMP + k[INDEX_BITS-1:0]);
    end
  end

  wire unused = &{1'b0, padded};

endmodule

`default_nettype wire
