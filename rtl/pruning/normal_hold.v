// normal_hold: keeps the last normal while pixels are turned away from the light, or there are
// none: what comes after stands still, and toggles nothing.
// Latency 1, one normal a clock.
`default_nettype none
`include "phong_config.vh"

module normal_hold (
    input  wire                          clk,
    input  wire                          two_sided,   // 1: no pixel is turned away
    input  wire                          valid,       // there is a pixel
    input  wire [`PHONG_NORMAL_BITS-1:0] x,           // s1.30, its normal
    input  wire [`PHONG_NORMAL_BITS-1:0] y,
    input  wire [`PHONG_NORMAL_BITS-1:0] z,
    output reg                           held_valid,
    output reg                           shown,       // it may be lit: its normal is the one below
    output reg  [`PHONG_NORMAL_BITS-1:0] held_x,
    output reg  [`PHONG_NORMAL_BITS-1:0] held_y,
    output reg  [`PHONG_NORMAL_BITS-1:0] held_z
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
