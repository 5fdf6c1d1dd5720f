// span_guard: finds spans that need what this build leaves out: a step where a component never
// varies, a material, place or slope beyond the narrowed words, a normal of another size.
// With everything built in it is nothing at all.
`default_nettype none
`include "phong_config.vh"

module span_guard (
    input wire clk,
    input wire reset,

    // a span goes in
    input wire                            taken,
    input wire [`PHONG_NORMAL_BITS-1:0]   step_x,
    input wire [`PHONG_NORMAL_BITS-1:0]   step_y,
    input wire [`PHONG_NORMAL_BITS-1:0]   step_z,
    input wire [`PHONG_COORDINATE_BITS:0] length,
    input wire [`PHONG_MATERIAL_BITS-1:0] material,

    // a pixel of it leaves the interpolators
    input wire                              pixel_valid,
    input wire                              at_end,       // it is the last of its span
    input wire [`PHONG_COORDINATE_BITS-1:0] pixel_x,
    input wire [`PHONG_COORDINATE_BITS-1:0] pixel_y,
    input wire [`PHONG_NORMAL_BITS-1:0]     normal_x,
    input wire [`PHONG_NORMAL_BITS-1:0]     normal_y,
    input wire [`PHONG_NORMAL_BITS-1:0]     normal_z,

    output wire unsupported  // for one clock for each such span, after its last pixel
);

  localparam NORMAL_BITS        = `PHONG_NORMAL_BITS;
  localparam COORDINATE_BITS    = `PHONG_COORDINATE_BITS;
  localparam MATERIAL_BITS      = `PHONG_MATERIAL_BITS;
  localparam INTERPOLATE_X      = `PHONG_INTERPOLATE_X;
  localparam INTERPOLATE_Y      = `PHONG_INTERPOLATE_Y;
  localparam INTERPOLATE_Z      = `PHONG_INTERPOLATE_Z;
  localparam IDLE_STEP_BITS     = `PHONG_IDLE_STEP_BITS;
  localparam IDLE_MATERIAL_BITS = `PHONG_IDLE_MATERIAL_BITS;
  localparam IDLE_X_BITS        = `PHONG_IDLE_X_BITS;
  localparam IDLE_Y_BITS        = `PHONG_IDLE_Y_BITS;
  localparam CONSTANT_SHIFT     = `PHONG_CONSTANT_SHIFT;
  localparam SHIFT              = `PHONG_CONSTANT_SHIFT_BY;

  localparam SIGN = NORMAL_BITS - 1;

  // What a span must not have in a bit where this is 1.
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
                      pixel_valid, at_end, pixel_x, pixel_y, normal_x, normal_y, normal_z,
                      NO_MATERIAL, NO_X, NO_Y, NO_SLOPE, NO_SIZE, SIGN == SHIFT};
    end else begin : gen_guard
      // Bits that differ from the one below them, the sign of a narrower word.
      wire [NORMAL_BITS-1:0] sign_change_x = step_x ^ {step_x[SIGN-1:0], 1'b0};
      wire [NORMAL_BITS-1:0] sign_change_y = step_y ^ {step_y[SIGN-1:0], 1'b0};
      wire [NORMAL_BITS-1:0] sign_change_z = step_z ^ {step_z[SIGN-1:0], 1'b0};
      wire [NORMAL_BITS-1:0] size =
          normal_x ^ {normal_x[SIGN-1:0], 1'b0} | normal_y ^ {normal_y[SIGN-1:0], 1'b0}
          | normal_z ^ {normal_z[SIGN-1:0], 1'b0};

      // Of the span at the interpolators; then the same clock's span and pixel; then what was
      // found.
      reg many_pixels, wrong_material;
      reg [2:0] wrong_step, steep_step;
      reg wrong_span, wrong_place, wrong_size, valid, ends;
      reg wrong_before;  // a wrong pixel before, in the same span
      reg flagged;
      wire wrong_pixel = wrong_place | wrong_size;

      always @(posedge clk) begin
        if (taken) begin
          many_pixels <= length[COORDINATE_BITS:1] != 0;
          wrong_material <= |(material & NO_MATERIAL);
          wrong_step[0] <= (INTERPOLATE_X == 0) & (step_x != 0);
          wrong_step[1] <= (INTERPOLATE_Y == 0) & (step_y != 0);
          wrong_step[2] <= (INTERPOLATE_Z == 0) & (step_z != 0);
          steep_step[0] <= |(sign_change_x & NO_SLOPE);
          steep_step[1] <= |(sign_change_y & NO_SLOPE);
          steep_step[2] <= |(sign_change_z & NO_SLOPE);
        end

        wrong_span <= many_pixels & |{wrong_step, steep_step} | wrong_material;
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
