// SPDX-License-Identifier: MIT
// span_guard: flags spans that need what a pruned build leaves out:
// a step or a bend of a component that the build holds constant over a span; a material, a place or
// a step beyond the narrowed words; a normal of another size than the constant shift is made for.
// In a full build the module contains no logic.
// Latency: 2 cycles from the last pixel of a span to `unsupported`.
// Throughput: one pixel per cycle.
// Reset: synchronous; drops the flags of the spans and pixels in flight.
`default_nettype none
`include "phong_config.vh"

module span_guard (
    input wire clk,
    input wire reset,  // synchronous

    // span, in the cycle in which it is accepted
    input wire                            taken,     // the span is accepted
    input wire [`PHONG_NORMAL_BITS-1:0]   step_x,    // s1.30, per pixel
    input wire [`PHONG_NORMAL_BITS-1:0]   step_y,    // s1.30, per pixel
    input wire [`PHONG_NORMAL_BITS-1:0]   step_z,    // s1.30, per pixel
    input wire [`PHONG_NORMAL_BITS+`PHONG_BEND_FRACTION_BITS-1:0] bend_x,  // s1.42, of the step
    input wire [`PHONG_NORMAL_BITS+`PHONG_BEND_FRACTION_BITS-1:0] bend_y,  // s1.42, of the step
    input wire [`PHONG_NORMAL_BITS+`PHONG_BEND_FRACTION_BITS-1:0] bend_z,  // s1.42, of the step
    input wire [`PHONG_COORDINATE_BITS:0] length,    // pixels
    input wire [`PHONG_MATERIAL_BITS-1:0] material,  // index

    // current pixel
    input wire                              pixel_valid,  // the pixel leaves the interpolators
    input wire                              at_end,       // the pixel is the last of its span
    input wire [`PHONG_COORDINATE_BITS-1:0] pixel_x,      // pixels
    input wire [`PHONG_COORDINATE_BITS-1:0] pixel_y,      // pixels
    input wire [`PHONG_NORMAL_BITS-1:0]     normal_x,     // s1.30
    input wire [`PHONG_NORMAL_BITS-1:0]     normal_y,     // s1.30
    input wire [`PHONG_NORMAL_BITS-1:0]     normal_z,     // s1.30

    output wire unsupported  // one-cycle pulse per span that needs what the build leaves out
);

  localparam NORMAL_BITS        = `PHONG_NORMAL_BITS;
  localparam COORDINATE_BITS    = `PHONG_COORDINATE_BITS;
  localparam MATERIAL_BITS      = `PHONG_MATERIAL_BITS;
  localparam INTERPOLATE_X      = `PHONG_INTERPOLATE_X;       // 0: constant over a span
  localparam INTERPOLATE_Y      = `PHONG_INTERPOLATE_Y;
  localparam INTERPOLATE_Z      = `PHONG_INTERPOLATE_Z;
  localparam IDLE_STEP_BITS     = `PHONG_IDLE_STEP_BITS;      // top step bits that repeat the sign
  localparam IDLE_MATERIAL_BITS = `PHONG_IDLE_MATERIAL_BITS;  // top bits that are always 0
  localparam IDLE_X_BITS        = `PHONG_IDLE_X_BITS;
  localparam IDLE_Y_BITS        = `PHONG_IDLE_Y_BITS;
  localparam CONSTANT_SHIFT     = `PHONG_CONSTANT_SHIFT;      // 1: SHIFT is that of all normals
  localparam SHIFT              = `PHONG_CONSTANT_SHIFT_BY;

  localparam SIGN = NORMAL_BITS - 1;

  // Masks of the bits that a span of this build leaves 0: of material, x, y, and of the sign
  // changes of steps and normals (see below).
  localparam [MATERIAL_BITS-1:0] NO_MATERIAL =
      ~({MATERIAL_BITS{1'b1}} >> IDLE_MATERIAL_BITS);
  localparam [COORDINATE_BITS-1:0] NO_X = ~({COORDINATE_BITS{1'b1}} >> IDLE_X_BITS);
  localparam [COORDINATE_BITS-1:0] NO_Y = ~({COORDINATE_BITS{1'b1}} >> IDLE_Y_BITS);
  localparam [NORMAL_BITS-1:0] NO_SLOPE = ~({NORMAL_BITS{1'b1}} >> IDLE_STEP_BITS);
  localparam [NORMAL_BITS-1:0] NO_SIZE = CONSTANT_SHIFT ? ~({NORMAL_BITS{1'b1}} >> SHIFT) : 0;

  generate
    if (INTERPOLATE_X && INTERPOLATE_Y && INTERPOLATE_Z && IDLE_STEP_BITS == 0
        && IDLE_MATERIAL_BITS == 0 && IDLE_X_BITS == 0 && IDLE_Y_BITS == 0
        && !CONSTANT_SHIFT) begin : gen_everything
      assign unsupported = 1'b0;

      wire unused = &{1'b0, clk, reset, taken, step_x, step_y, step_z, length, material,
                      bend_x, bend_y, bend_z,
                      pixel_valid, at_end, pixel_x, pixel_y, normal_x, normal_y, normal_z,
                      NO_MATERIAL, NO_X, NO_Y, NO_SLOPE, NO_SIZE, SIGN == SHIFT};
    end else begin : gen_guard
      // Sign changes: a bit is 1 where the bit of the word differs from the bit below. The top k
      // bits of a word repeat the sign of a word k bits narrower if their sign changes are all 0.
      wire [NORMAL_BITS-1:0] sign_change_x = step_x ^ {step_x[SIGN-1:0], 1'b0};
      wire [NORMAL_BITS-1:0] sign_change_y = step_y ^ {step_y[SIGN-1:0], 1'b0};
      wire [NORMAL_BITS-1:0] sign_change_z = step_z ^ {step_z[SIGN-1:0], 1'b0};
      wire [NORMAL_BITS-1:0] size =
          normal_x ^ {normal_x[SIGN-1:0], 1'b0} | normal_y ^ {normal_y[SIGN-1:0], 1'b0}
          | normal_z ^ {normal_z[SIGN-1:0], 1'b0};

      // Three register stages: checks of the accepted span, checks of the current pixel and its
      // span, the flag.
      reg many_pixels, wrong_material;
      reg [2:0] wrong_step, wrong_bend, steep_step;
      reg wrong_span, wrong_place, wrong_size, valid, ends;
      reg wrong_before;  // an earlier pixel of the same span is wrong
      reg flagged;
      wire wrong_pixel = wrong_place | wrong_size;

      always @(posedge clk) begin
        if (taken) begin
          many_pixels <= length[COORDINATE_BITS:1] != 0;
          wrong_material <= |(material & NO_MATERIAL);
          wrong_step[0] <= (INTERPOLATE_X == 0) & (step_x != 0);
          wrong_step[1] <= (INTERPOLATE_Y == 0) & (step_y != 0);
          wrong_step[2] <= (INTERPOLATE_Z == 0) & (step_z != 0);
          wrong_bend[0] <= (INTERPOLATE_X == 0) & (bend_x != 0);
          wrong_bend[1] <= (INTERPOLATE_Y == 0) & (bend_y != 0);
          wrong_bend[2] <= (INTERPOLATE_Z == 0) & (bend_z != 0);
          steep_step[0] <= |(sign_change_x & NO_SLOPE);
          steep_step[1] <= |(sign_change_y & NO_SLOPE);
          steep_step[2] <= |(sign_change_z & NO_SLOPE);
        end

        wrong_span <= many_pixels & |{wrong_step, wrong_bend, steep_step} | wrong_material;
        wrong_place <= |(pixel_x & NO_X) | |(pixel_y & NO_Y);
        wrong_size <= (CONSTANT_SHIFT != 0) & (|(size & NO_SIZE) | ~size[SIGN-SHIFT]);
        valid <= ~reset & pixel_valid;
        ends <= ~reset & pixel_valid & at_end;

        wrong_before <= ~reset & ~ends & (wrong_before | wrong_pixel & valid);
        flagged <= ends & (wrong_span | wrong_pixel | wrong_before);
      end

      assign unsupported = flagged;
    end
  endgenerate

endmodule

`default_nettype wire
