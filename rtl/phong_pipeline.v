// SPDX-License-Identifier: MIT
// phong_pipeline: shades spans: spans in, coloured pixels out (Bui Tuong Phong, "Illumination for
// Computer Generated Pictures", 1975).
// span_walker turns spans into pixels. One unit gives each pixel its colour, by the technique of
// the configuration: phong_unit; quadratic_unit; lights_unit for several lights, with light_turns
// before the walker if they take turns; or one of the techniques that Phong compares with,
// gouraud_unit (interpolated intensities) and flat_unit (one intensity per face). pixel_fifo holds
// finished pixels under back-pressure. The module holds the wiring, in data order.
// Latency: PHONG_PIXEL_LATENCY + 3 cycles from an accepted span to its first pixel (see latency.vh;
// 77 by default).
// Throughput: one pixel per cycle, also if every span has one pixel.
// Reset: synchronous; drops all spans and pixels in flight. Registers and material table keep their
// contents.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module phong_pipeline (
    input wire clk,
    input wire reset,  // synchronous

    // write port of registers and material table; write between frames only. gouraud_unit and
    // flat_unit have neither registers nor table.
    input wire                               write_enable,   // 1: write
    input wire [`PHONG_ADDRESS_BITS-1:0]     write_address,  // see register_map, light_map
    input wire [2*`PHONG_COEFFICIENT_BITS:0] write_word,     // see register_map

    // spans: {material, length, y, x, step z, y, x, start z, y, x}; start and step are s1.30;
    // length, y and x are in pixels. Several lights: see light_turns for the records of a span and
    // lights_unit for their values. Gouraud shading: blue, green, red in place of z, y, x; flat
    // shading: the same without step. For quadratic normals and quadratic_spans see `values` of
    // phong_unit and of quadratic_unit.
    input  wire                        s_axis_tvalid,
    output wire                        s_axis_tready,
    input  wire [`PHONG_SPAN_BITS-1:0] s_axis_tdata,
    input  wire                        s_axis_tlast,  // the span is the last of the frame

    // pixels: {y, x, red, green, blue}: y and x in pixels, codes from 0 to 255; m_axis_tlast: the
    // pixel is the last of the frame
    output wire                                                       m_axis_tvalid,
    input  wire                                                       m_axis_tready,
    output wire [(2*`PHONG_COORDINATE_BITS+3*`PHONG_COLOUR_BITS)-1:0] m_axis_tdata,
    output wire                                                       m_axis_tlast,

    // flags: one-cycle pulses
    output wire illegal_span,  // a span was empty, or its x or a component left its word
    output wire zero_normal,   // the normal of a pixel is the zero vector
    output wire unsupported    // a write or a span needs what this build leaves out
);

  localparam TECHNIQUE          = `PHONG_TECHNIQUE;
  localparam NORMAL_METHOD      = `PHONG_NORMAL_METHOD;
  localparam COORDINATE_BITS    = `PHONG_COORDINATE_BITS;
  localparam MATERIAL_BITS      = `PHONG_MATERIAL_BITS;
  localparam COLOUR_BITS        = `PHONG_COLOUR_BITS;
  localparam SPAN_BITS          = `PHONG_SPAN_BITS;
  localparam IDLE_MATERIAL_BITS = `PHONG_IDLE_MATERIAL_BITS;
  localparam SUMS_LIGHTS        = `PHONG_SUMS_LIGHTS;  // 1: several lights, or coloured highlights
  localparam TURNS              = `PHONG_TURNS;        // of the lights of a pixel
  localparam TURN_BITS          = `PHONG_TURN_BITS;

  // ---- spans to pixels ----
  localparam VALUES_BITS = SPAN_BITS - MATERIAL_BITS - 3 * COORDINATE_BITS - 1;

  wire [VALUES_BITS-1:0] span_values;  // start and step of what is interpolated
  wire [COORDINATE_BITS-1:0] span_x, span_y;
  wire [COORDINATE_BITS:0] span_length;
  wire [MATERIAL_BITS-1:0] span_material;

  assign {span_material, span_length, span_y, span_x, span_values} = s_axis_tdata;

  wire load, advance, overflow, credit;
  wire walker_load, walker_advance, walker_overflow, walker_credit, walker_ready, walker_last;
  wire pixel_valid, pixel_last;
  wire [COORDINATE_BITS-1:0] pixel_x, pixel_y;
  wire [MATERIAL_BITS-1:0] pixel_material;

  span_walker u_span_walker (
      .clk(clk),
      .reset(reset),
      .span_valid(s_axis_tvalid),
      .span_ready(walker_ready),
      .span_x(span_x),
      .span_y(span_y),
      .span_length(span_length),
      .span_material(span_material & ({MATERIAL_BITS{1'b1}} >> IDLE_MATERIAL_BITS)),
      .span_last(s_axis_tlast),
      .load(walker_load),
      .advance(walker_advance),
      .overflow(walker_overflow),
      .credit(walker_credit),
      .pixel_valid(pixel_valid),
      .pixel_x(pixel_x),
      .pixel_y(pixel_y),
      .pixel_material(pixel_material),
      .pixel_last(walker_last),
      .illegal_span(illegal_span)
  );

  // ---- turns of the lights of a pixel ----
  wire [TURN_BITS-1:0] last_turn, turn, next_turn;
  wire turn_valid;

  generate
    if (!SUMS_LIGHTS) begin : gen_no_turns
      assign last_turn = {TURN_BITS{1'b0}};
    end

    if (TURNS > 1) begin : gen_turns
      light_turns u_light_turns (
          .clk(clk),
          .reset(reset),
          .last_turn(last_turn),
          .record_valid(s_axis_tvalid),
          .record_ready(s_axis_tready),
          .record_last(s_axis_tlast),
          .walker_credit(walker_credit),
          .walker_ready(walker_ready),
          .walker_load(walker_load),
          .walker_overflow(walker_overflow),
          .credit(credit),
          .advance(advance),
          .load(load),
          .overflow(overflow),
          .turn(turn),
          .next_turn(next_turn),
          .turn_valid(turn_valid),
          .pixel_last(pixel_last)
      );

      wire unused = &{1'b0, walker_advance, walker_last};
    end else begin : gen_one_turn
      assign {load, advance, pixel_last} = {walker_load, walker_advance, walker_last};
      assign {walker_overflow, walker_credit} = {overflow, credit};
      assign s_axis_tready = walker_ready;
      assign {turn, next_turn} = {2 * TURN_BITS{1'b0}};
      assign turn_valid = pixel_valid;

      wire unused = &{1'b0, last_turn, turn, next_turn, turn_valid};
    end
  endgenerate

  // ---- pixels to colours ----
  wire [COLOUR_BITS-1:0] red, green, blue;

  generate
    if (TECHNIQUE == `PHONG_TECHNIQUE_PHONG
        && NORMAL_METHOD == `PHONG_NORMAL_METHOD_QUADRATIC_SPANS) begin : gen_quadratic_spans
      quadratic_unit u_quadratic_unit (
          .clk(clk),
          .write_enable(write_enable),
          .write_address(write_address),
          .write_word(write_word),
          .values(span_values),
          .load(load),
          .advance(advance),
          .pixel_valid(pixel_valid),
          .pixel_material(pixel_material),
          .red(red),
          .green(green),
          .blue(blue),
          .overflow(overflow),
          .zero_normal(zero_normal),
          .unsupported(unsupported)
      );
    end else if (SUMS_LIGHTS) begin : gen_lights
      lights_unit u_lights_unit (
          .clk(clk),
          .reset(reset),
          .write_enable(write_enable),
          .write_address(write_address),
          .write_word(write_word),
          .last_turn(last_turn),
          .values(span_values),
          .taken(s_axis_tvalid & walker_ready),
          .length(span_length),
          .material(span_material),
          .load(load),
          .advance(advance),
          .turn(turn),
          .next_turn(next_turn),
          .turn_valid(turn_valid),
          .pixel_valid(pixel_valid),
          .pixel_ends(walker_load),
          .pixel_x(pixel_x),
          .pixel_y(pixel_y),
          .pixel_material(pixel_material),
          .red(red),
          .green(green),
          .blue(blue),
          .overflow(overflow),
          .zero_normal(zero_normal),
          .unsupported(unsupported)
      );
    end else if (TECHNIQUE == `PHONG_TECHNIQUE_PHONG) begin : gen_phong
      phong_unit u_phong_unit (
          .clk(clk),
          .reset(reset),
          .write_enable(write_enable),
          .write_address(write_address),
          .write_word(write_word),
          .taken(s_axis_tvalid & s_axis_tready),
          .values(span_values),
          .length(span_length),
          .material(span_material),
          .load(load),
          .advance(advance),
          .pixel_valid(pixel_valid),
          .pixel_x(pixel_x),
          .pixel_y(pixel_y),
          .pixel_material(pixel_material),
          .red(red),
          .green(green),
          .blue(blue),
          .overflow(overflow),
          .zero_normal(zero_normal),
          .unsupported(unsupported)
      );
    end else if (TECHNIQUE == `PHONG_TECHNIQUE_GOURAUD) begin : gen_gouraud
      assign zero_normal = 1'b0;  // there are no normals
      assign unsupported = write_enable;  // there is no register and no table

      gouraud_unit u_gouraud_unit (
          .clk(clk),
          .load(load),
          .advance(advance),
          .values(span_values),
          .red(red),
          .green(green),
          .blue(blue),
          .overflow(overflow)
      );
    end else begin : gen_flat
      assign overflow = 1'b0;  // nothing is interpolated
      assign zero_normal = 1'b0;
      assign unsupported = write_enable;

      flat_unit u_flat_unit (
          .clk(clk),
          .load(load),
          .advance(advance),
          .values(span_values),
          .red(red),
          .green(green),
          .blue(blue)
      );
    end
  endgenerate

  // Gouraud and flat shading have no registers and no materials.
  wire unused = &{1'b0, write_address, write_word, pixel_material};

  // ---- pixels out ----
  pixel_fifo u_pixel_fifo (
      .clk(clk),
      .reset(reset),
      .credit(credit),
      .pixel_valid(pixel_valid),
      .pixel_x(pixel_x),
      .pixel_y(pixel_y),
      .pixel_last(pixel_last),
      .red(red),
      .green(green),
      .blue(blue),
      .out_valid(m_axis_tvalid),
      .out_ready(m_axis_tready),
      .out_data(m_axis_tdata),
      .out_last(m_axis_tlast)
  );

endmodule

`default_nettype wire
