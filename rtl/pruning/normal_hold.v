// SPDX-License-Identifier: MIT
// normal_hold: holds the last normal while the current pixel is turned away from the light or no
// pixel is there, so that the datapath behind it does not toggle.
// Latency: 1 cycle; a build with this module counts it in PHONG_NORMAL_LATENCY.
// Throughput: one normal per cycle.
// Reset: none.
`default_nettype none
`include "phong_config.vh"

module normal_hold (
    input wire clk,
    input wire two_sided,  // register, held for a frame; 1: no pixel is turned away

    // current pixel
    input wire                          valid,  // the pixel is there
    input wire [`PHONG_NORMAL_BITS-1:0] x,      // s1.30, normal, light frame, x
    input wire [`PHONG_NORMAL_BITS-1:0] y,      // s1.30, y
    input wire [`PHONG_NORMAL_BITS-1:0] z,      // s1.30, z: toward the light

    // the same pixel, one cycle later
    output reg                          held_valid,  // the pixel is there
    output reg                          shown,       // 1: held_x, y, z are its normal; 0: unlit
    output reg [`PHONG_NORMAL_BITS-1:0] held_x,      // s1.30, held normal, x
    output reg [`PHONG_NORMAL_BITS-1:0] held_y,      // s1.30, y
    output reg [`PHONG_NORMAL_BITS-1:0] held_z       // s1.30, z
);

  localparam NORMAL_BITS = `PHONG_NORMAL_BITS;

  wire may_be_lit = two_sided | ~z[NORMAL_BITS-1];

  always @(posedge clk) begin
    held_valid <= valid;
    shown <= may_be_lit;
    if (valid & may_be_lit) begin
      held_x <= x;
      held_y <= y;
      held_z <= z;
    end
  end

endmodule

`default_nettype wire
