// SPDX-License-Identifier: MIT
// lights_unit: Phong shading with several lights, or with lights at a place,
//   I = e + ka Ia + sum over lights of (ka La + f (kd Ld (N.L) + ks Ls W(i) cos(s)^n)),
// for red, green and blue. The factor f falls with the distance from the light, or is 1. UNITS
// lights are shaded side by side, the others in further turns of the pixel through the same units.
// 1/|N| is that of the first light's normal, so that any number of units gives the same bits. Half
// vectors are registers, or come with the spans: those of lights at a place.
// The module holds the wiring, in data order.
// Latency: that of a pixel in latency.vh, from the last turn of a pixel to its colour.
// Throughput: one turn per cycle.
// Reset: synchronous; of the flags only.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module lights_unit #(
    parameter UNITS       = `PHONG_UNITS,
    parameter TURN_BITS   = `PHONG_TURN_BITS,
    parameter NORMAL_BITS = `PHONG_NORMAL_BITS,
    parameter VALUES_BITS = `PHONG_SPAN_BITS - `PHONG_MATERIAL_BITS - 3 * `PHONG_COORDINATE_BITS - 1
) (
    input wire clk,
    input wire reset,  // synchronous

    // write port of registers and tables; write between frames only
    input wire                               write_enable,   // 1: write
    input wire [`PHONG_ADDRESS_BITS-1:0]     write_address,  // see register_map and light_map
    input wire [2*`PHONG_COEFFICIENT_BITS:0] write_word,     // see register_map and light_map

    output wire [TURN_BITS-1:0] last_turn,  // register, held for a frame: turns of a pixel minus 1

    // offered record: {step z, y, x, start z, y, x}, s1.30 each, of every unit, the first unit in
    // the lowest bits, each in the frame of its light; above them, if the build has them, {hz, hx}
    // (s0.17) of every unit, then {step, start} of the distance (s1.29) of every unit
    input wire [VALUES_BITS-1:0]          values,
    input wire                            taken,     // it is accepted as the first of a span
    input wire [`PHONG_COORDINATE_BITS:0] length,    // pixels
    input wire [`PHONG_MATERIAL_BITS-1:0] material,  // index

    // control from span_walker or light_turns; `load` acts only together with `advance`
    input wire                 load,     // 1: the next turn starts from `values`
    input wire                 advance,  // 1: move to the next turn
    input wire [TURN_BITS-1:0] turn,     // number of the current turn
    input wire [TURN_BITS-1:0] next_turn,

    // current turn, and current pixel
    input wire                              turn_valid,      // the turn leaves the interpolators
    input wire                              pixel_valid,     // the pixel leaves, in its last turn
    input wire                              pixel_ends,      // the pixel is the last of its span
    input wire [`PHONG_COORDINATE_BITS-1:0] pixel_x,         // pixels
    input wire [`PHONG_COORDINATE_BITS-1:0] pixel_y,         // pixels
    input wire [`PHONG_MATERIAL_BITS-1:0]   pixel_material,  // index

    // colour of a pixel
    output wire [`PHONG_COLOUR_BITS-1:0] red,    // code, 0 to 255
    output wire [`PHONG_COLOUR_BITS-1:0] green,  // code, 0 to 255
    output wire [`PHONG_COLOUR_BITS-1:0] blue,   // code, 0 to 255

    // flags
    output wire overflow,     // a component has left its word since the first pixel of the span
    output wire zero_normal,  // one-cycle pulse: the first light's normal is the zero vector
    output wire unsupported   // one-cycle pulse: a write or a span needs what this build leaves out
);

  localparam MATERIAL_BITS    = `PHONG_MATERIAL_BITS;
  localparam COEFFICIENT_BITS = `PHONG_COEFFICIENT_BITS;
  localparam INDEX_BITS       = `PHONG_WEIGHT_INDEX_BITS;
  localparam EXPONENT_BITS    = `PHONG_EXPONENT_BITS;
  localparam HALF_BITS        = `PHONG_HALF_VECTOR_BITS;
  localparam MANTISSA_BITS    = `PHONG_MANTISSA_BITS;
  localparam ROOT_BITS        = `PHONG_ROOT_BITS;
  localparam UNIT_BITS        = `PHONG_UNIT_BITS;
  localparam COSINE_BITS      = `PHONG_COSINE_BITS;
  localparam COLOUR_BITS      = `PHONG_COLOUR_BITS;
  localparam CHANNELS         = `PHONG_CHANNELS;        // 3: red, green, blue; 1: grey
  localparam SPECULAR         = `PHONG_SPECULAR;        // 0: no highlight
  localparam POWER_FUNCTION   = `PHONG_POWER_FUNCTION;  // 0: n is always 1
  localparam SEGMENT_BITS     = `PHONG_SEGMENT_BITS;
  localparam HAS_CURVES       = `PHONG_HAS_CURVES;      // 1: any curve in place of cos(s)^n
  localparam SPAN_HALF_VECTOR = `PHONG_SPAN_HALF_VECTOR;  // 1: spans bring hx and hz
  localparam ATTENUATION      = `PHONG_ATTENUATION;       // 0: f is 1
  localparam HIGHLIGHT_COLOUR = `PHONG_HIGHLIGHT_COLOUR;  // 0: every highlight is white
  localparam ROUNDED_BITS     = `PHONG_HIGHLIGHT_BITS;
  localparam DEPTH_BITS       = `PHONG_DEPTH_BITS;
  localparam PRODUCT_BITS     = `PHONG_WEIGHT_BITS + `PHONG_POWER_BITS;
  localparam FOUND_BITS       = `PHONG_ROUNDS_HIGHLIGHT ? ROUNDED_BITS : PRODUCT_BITS;
  localparam HIGHLIGHT_BITS   = HIGHLIGHT_COLOUR ? ROUNDED_BITS : PRODUCT_BITS;

  // A rounded highlight that stays white is padded to the format of the whole product.
  localparam WHITE_SHIFT = PRODUCT_BITS - `PHONG_WEIGHT_FRACTION - `PHONG_POWER_FRACTION
                         - (ROUNDED_BITS - `PHONG_HIGHLIGHT_FRACTION);

  // Where the half vectors and the distances of a record start.
  localparam HALF_FROM  = 6 * UNITS * NORMAL_BITS;
  localparam DEPTH_FROM = HALF_FROM + (SPAN_HALF_VECTOR ? 2 * UNITS * HALF_BITS : 0);

  localparam ADDRESS_BITS = MATERIAL_BITS + INDEX_BITS;
  localparam SHIFT_BITS   = $clog2(NORMAL_BITS);
  localparam BEND_BITS    = NORMAL_BITS + `PHONG_BEND_FRACTION_BITS;
  localparam TERM_BITS    = `PHONG_WEIGHT_FRACTION + `PHONG_POWER_FRACTION + 2;

  // Cycles from the interpolators to the hold of the first light's shift and to the unit normals.
  localparam HOLD_AT   = 1 + `PHONG_LEADING_ZEROS_LATENCY;
  localparam NORMAL_AT = `PHONG_LIGHT_NORMAL_LATENCY;

  // Cycles from the unit normals to n and to the products of the colours.
  localparam EXPONENT_AT = `PHONG_HIGHLIGHT_LATENCY + `PHONG_EXPONENT_LATENCY;
  localparam COLOUR_AT   = `PHONG_LIGHT_COLOUR_LATENCY;
  localparam TABLE_AT    = COLOUR_AT - `PHONG_LIGHT_TABLE_LATENCY;
  localparam COSINE_AT   = COLOUR_AT - (ATTENUATION ? `PHONG_LIGHT_ATTENUATION_LATENCY : 0);

  // ---- registers ----
  wire two_sided;
  wire write_weight, write_exponent, write_half_x, write_half_z, write_factor;
  wire [2:0] write_ambient, write_diffuse, write_highlight;
  wire [UNITS-1:0] to_unit;
  wire [TURN_BITS-1:0] to_turn;
  wire [ADDRESS_BITS-1:0] table_address;
  wire [2*COEFFICIENT_BITS:0] table_word;
  wire unsupported_write, unsupported_light, unsupported_span;
  wire [2*HALF_BITS-1:0] unused_half;  // register_map holds one; here each light has its own

  wire plain_enable, write_curve;
  wire [MATERIAL_BITS+SEGMENT_BITS-1:0] write_line;
  wire [2*`PHONG_MAX_JUMPS-1:0] write_curve_jumps, write_weight_jumps;

  reflectance_map u_reflectance_map (
      .clk(clk),
      .write_enable(write_enable),
      .write_address(write_address),
      .plain_enable(plain_enable),
      .write_curve(write_curve),
      .write_line(write_line),
      .write_curve_jumps(write_curve_jumps),
      .write_weight_jumps(write_weight_jumps)
  );

  register_map u_register_map (
      .clk(clk),
      .write_enable(plain_enable),
      .write_address(write_address[ADDRESS_BITS:0]),
      .write_word(write_word),
      .half_x(unused_half[HALF_BITS-1:0]),
      .half_z(unused_half[2*HALF_BITS-1:HALF_BITS]),
      .two_sided(two_sided),
      .write_weight(write_weight),
      .write_exponent(write_exponent),
      .write_ambient(write_ambient),
      .write_diffuse(write_diffuse),
      .table_address(table_address),
      .table_word(table_word),
      .unsupported(unsupported_write)
  );

  light_map u_light_map (
      .clk(clk),
      .write_enable(plain_enable),
      .write_address(write_address[`PHONG_LIGHT_BITS+ADDRESS_BITS:0]),
      .write_word(write_word),
      .last_turn(last_turn),
      .write_half_x(write_half_x),
      .write_half_z(write_half_z),
      .write_highlight(write_highlight),
      .write_factor(write_factor),
      .to_unit(to_unit),
      .to_turn(to_turn),
      .unsupported(unsupported_light)
  );

  wire [MATERIAL_BITS-1:0] to_material = table_address[INDEX_BITS+:MATERIAL_BITS];
  wire [COEFFICIENT_BITS-1:0] code = table_word[COEFFICIENT_BITS-1:0];

  assign unsupported = unsupported_write | unsupported_light | unsupported_span;

  // ---- spans: every component is interpolated, so that steps and normals are not looked at ----
  span_guard u_span_guard (
      .clk(clk),
      .reset(reset),
      .taken(taken),
      .step_x({NORMAL_BITS{1'b0}}),
      .step_y({NORMAL_BITS{1'b0}}),
      .step_z({NORMAL_BITS{1'b0}}),
      .bend_x({BEND_BITS{1'b0}}),
      .bend_y({BEND_BITS{1'b0}}),
      .bend_z({BEND_BITS{1'b0}}),
      .length(length),
      .material(material),
      .pixel_valid(pixel_valid),
      .at_end(pixel_ends),
      .pixel_x(pixel_x),
      .pixel_y(pixel_y),
      .normal_x({NORMAL_BITS{1'b0}}),
      .normal_y({NORMAL_BITS{1'b0}}),
      .normal_z({NORMAL_BITS{1'b0}}),
      .unsupported(unsupported_span)
  );

  // ---- what a turn carries beside its normals ----
  wire [TURN_BITS-1:0] turn_half, turn_table;
  wire [MATERIAL_BITS-1:0] material_normal, material_exponent, material_table, material_sum;
  wire first_hold, first_align, first_sum;

  wire first = turn_valid & (turn == 0);

  delay #(
      .BITS  (1),
      .CYCLES(HOLD_AT)
  ) u_first_hold (
      .clk(clk),
      .in (first),
      .out(first_hold)
  );

  delay #(
      .BITS  (1),
      .CYCLES(`PHONG_LIGHT_ALIGN_LATENCY - HOLD_AT)
  ) u_first_align (
      .clk(clk),
      .in (first_hold),
      .out(first_align)
  );

  delay #(
      .BITS  (1),
      .CYCLES(NORMAL_AT - `PHONG_LIGHT_ALIGN_LATENCY + COLOUR_AT + `PHONG_LIGHT_TERMS_LATENCY)
  ) u_first_sum (
      .clk(clk),
      .in (first_align),
      .out(first_sum)
  );

  delay #(
      .BITS  (TURN_BITS),
      .CYCLES(NORMAL_AT - `PHONG_SMALL_RAM_LATENCY)
  ) u_turn_half (
      .clk(clk),
      .in (turn),
      .out(turn_half)
  );

  delay #(
      .BITS  (TURN_BITS),
      .CYCLES(`PHONG_SMALL_RAM_LATENCY + TABLE_AT)
  ) u_turn_table (
      .clk(clk),
      .in (turn_half),
      .out(turn_table)
  );

  delay #(
      .BITS  (MATERIAL_BITS),
      .CYCLES(NORMAL_AT)
  ) u_material_normal (
      .clk(clk),
      .in (pixel_material),
      .out(material_normal)
  );

  delay #(
      .BITS  (MATERIAL_BITS),
      .CYCLES(TABLE_AT)
  ) u_material_table (
      .clk(clk),
      .in (material_normal),
      .out(material_table)
  );

  delay #(
      .BITS  (MATERIAL_BITS),
      .CYCLES(COLOUR_AT - TABLE_AT + `PHONG_LIGHT_TERMS_LATENCY)
  ) u_material_sum (
      .clk(clk),
      .in (material_table),
      .out(material_sum)
  );

  // ---- the first light's shift, whether its normal is zero, and 1/|N| ----
  wire [UNITS*SHIFT_BITS-1:0] own_shifts;
  wire [UNITS-1:0] zeros;
  wire [SHIFT_BITS-1:0] first_shift;
  wire first_zero;
  wire [3*MANTISSA_BITS-1:0] first_mantissas;
  wire [ROOT_BITS-1:0] root;
  wire below_one;

  turn_hold #(
      .BITS(SHIFT_BITS + 1)
  ) u_first_shift (
      .clk(clk),
      .first(first_hold),
      .in({zeros[0], own_shifts[SHIFT_BITS-1:0]}),
      .out({first_zero, first_shift})
  );

  held_root u_held_root (
      .clk(clk),
      .first(first_align),
      .mantissas(first_mantissas),
      .root(root),
      .below_one(below_one)
  );

  reg [HOLD_AT-1:0] in_flight;  // first turns of the last cycles
  reg zero_flag;

  always @(posedge clk) begin
    if (reset) in_flight <= {HOLD_AT{1'b0}};
    else in_flight <= {in_flight[HOLD_AT-2:0], first};
    zero_flag <= ~reset & in_flight[HOLD_AT-1] & zeros[0];
  end

  assign zero_normal = zero_flag;

  // ---- n ----
  wire [EXPONENT_BITS-1:0] exponent;

  generate
    if (SPECULAR && POWER_FUNCTION && !HAS_CURVES) begin : gen_exponent
      delay #(
          .BITS  (MATERIAL_BITS),
          .CYCLES(EXPONENT_AT - `PHONG_SMALL_RAM_LATENCY)
      ) u_material_exponent (
          .clk(clk),
          .in (material_normal),
          .out(material_exponent)
      );

      small_ram #(
          .ADDRESS_BITS(MATERIAL_BITS),
          .WORD_BITS(EXPONENT_BITS)
      ) u_exponent_table (
          .clk(clk),
          .write_enable(write_exponent),
          .write_address(to_material),
          .write_word(table_word[EXPONENT_BITS-1:0]),
          .address(material_exponent),
          .word(exponent)
      );
    end else begin : gen_no_exponent
      assign material_exponent = {MATERIAL_BITS{1'b0}};
      assign exponent = {EXPONENT_BITS{1'b0}};

      wire unused = &{1'b0, write_exponent, material_exponent, exponent};
    end
  endgenerate

  // ---- the lights of a turn, side by side ----
  wire [UNITS-1:0] overflows;
  wire [UNITS*CHANNELS*TERM_BITS-1:0] terms;  // of each unit, red in the lowest bits

  assign overflow = |overflows;

  genvar u, c;
  generate
    for (u = 0; u < UNITS; u = u + 1) begin : gen_unit
      wire [3*NORMAL_BITS-1:0] normal;
      wire [2:0] overflow_here;
      wire [3*MANTISSA_BITS-1:0] mantissas;
      wire less, lit, lit_normal, lit_colour;
      wire [UNIT_BITS-1:0] unit_x, unit_y, unit_z;
      wire [COSINE_BITS-1:0] cosine, cosine_late, cosine_colour;
      wire [FOUND_BITS-1:0] highlight_found;
      wire [HIGHLIGHT_BITS-1:0] highlight;
      wire depth_overflow;

      for (c = 0; c < 3; c = c + 1) begin : gen_component
        context_interpolator u_interpolator (
            .clk(clk),
            .single(last_turn == 0),
            .advance(advance),
            .load(load),
            .valid(turn_valid),
            .turn(turn),
            .next_turn(next_turn),
            .start(values[(6*u+c)*NORMAL_BITS+:NORMAL_BITS]),
            .step(values[(6*u+3+c)*NORMAL_BITS+:NORMAL_BITS]),
            .value(normal[c*NORMAL_BITS+:NORMAL_BITS]),
            .overflow(overflow_here[c])
        );
      end

      assign overflows[u] = |overflow_here | depth_overflow;

      light_align u_light_align (
          .clk(clk),
          .two_sided(two_sided),
          .valid(turn_valid),
          .x(normal[NORMAL_BITS-1:0]),
          .y(normal[NORMAL_BITS+:NORMAL_BITS]),
          .z(normal[2*NORMAL_BITS+:NORMAL_BITS]),
          .own_shift(own_shifts[u*SHIFT_BITS+:SHIFT_BITS]),
          .zero(zeros[u]),
          .first_shift(first_shift),
          .first_zero(first_zero),
          .mantissas(mantissas),
          .less(less),
          .lit(lit)
      );

      if (u == 0) begin : gen_first
        assign first_mantissas = mantissas;
      end

      light_scale u_light_scale (
          .clk(clk),
          .mantissas(mantissas),
          .less(less),
          .root(root),
          .below_one(below_one),
          .unit_x(unit_x),
          .unit_y(unit_y),
          .unit_z(unit_z),
          .cosine(cosine)
      );

      delay #(
          .BITS  (1),
          .CYCLES(NORMAL_AT - `PHONG_LIGHT_ALIGN_LATENCY)
      ) u_lit_normal (
          .clk(clk),
          .in (lit),
          .out(lit_normal)
      );

      delay #(
          .BITS  (1),
          .CYCLES(COLOUR_AT)
      ) u_lit_colour (
          .clk(clk),
          .in (lit_normal),
          .out(lit_colour)
      );

      delay #(
          .BITS  (COSINE_BITS),
          .CYCLES(COSINE_AT)
      ) u_cosine_late (
          .clk(clk),
          .in (cosine),
          .out(cosine_late)
      );

      if (SPECULAR) begin : gen_highlight
        wire [HALF_BITS-1:0] half_x, half_z;

        if (SPAN_HALF_VECTOR) begin : gen_span
          wire [2*HALF_BITS-1:0] half_now;

          span_word #(
              .BITS(2 * HALF_BITS)
          ) u_half (
              .clk(clk),
              .single(last_turn == 0),
              .advance(advance),
              .load(load),
              .valid(turn_valid),
              .turn(turn),
              .next_turn(next_turn),
              .offered(values[HALF_FROM+2*u*HALF_BITS+:2*HALF_BITS]),
              .word(half_now)
          );

          delay #(
              .BITS  (2 * HALF_BITS),
              .CYCLES(NORMAL_AT)
          ) u_half_normal (
              .clk(clk),
              .in (half_now),
              .out({half_z, half_x})
          );

          wire unused = &{1'b0, write_half_x, write_half_z};
        end else begin : gen_registers
          small_ram #(
              .ADDRESS_BITS(TURN_BITS),
              .WORD_BITS(HALF_BITS)
          ) u_half_x (
              .clk(clk),
              .write_enable(write_half_x & to_unit[u]),
              .write_address(to_turn),
              .write_word(table_word[HALF_BITS-1:0]),
              .address(turn_half),
              .word(half_x)
          );

          small_ram #(
              .ADDRESS_BITS(TURN_BITS),
              .WORD_BITS(HALF_BITS)
          ) u_half_z (
              .clk(clk),
              .write_enable(write_half_z & to_unit[u]),
              .write_address(to_turn),
              .write_word(table_word[HALF_BITS-1:0]),
              .address(turn_half),
              .word(half_z)
          );
        end

        light_highlight u_light_highlight (
            .clk(clk),
            .write_weight(write_weight),
            .write_curve(write_curve),
            .write_line(write_line),
            .write_curve_jumps(write_curve_jumps),
            .write_weight_jumps(write_weight_jumps),
            .write_address(table_address),
            .write_word(table_word),
            .half_x(half_x),
            .half_z(half_z),
            .unit_x(unit_x),
            .unit_y(unit_y),
            .unit_z(unit_z),
            .cosine(cosine),
            .material(material_normal),
            .exponent(exponent),
            .highlight(highlight_found)
        );
      end else begin : gen_no_highlight
        assign highlight_found = {FOUND_BITS{1'b0}};

        wire unused = &{1'b0, unit_x, unit_y, unit_z, write_half_x, write_half_z, write_weight};
      end

      if (ATTENUATION) begin : gen_attenuation
        wire [DEPTH_BITS-1:0] depth;
        wire [ROUNDED_BITS-1:0] scaled;

        context_interpolator #(
            .NORMAL_BITS(DEPTH_BITS)
        ) u_interpolator (
            .clk(clk),
            .single(last_turn == 0),
            .advance(advance),
            .load(load),
            .valid(turn_valid),
            .turn(turn),
            .next_turn(next_turn),
            .start(values[DEPTH_FROM+2*u*DEPTH_BITS+:DEPTH_BITS]),
            .step(values[DEPTH_FROM+(2*u+1)*DEPTH_BITS+:DEPTH_BITS]),
            .value(depth),
            .overflow(depth_overflow)
        );

        // Fields 16 to 31 of each material hold 16 intervals of the factor: see light_map.
        localparam FIELD_BITS = $clog2(16);
        wire [INDEX_BITS-1:0] to_factor = {
          table_address[INDEX_BITS+:INDEX_BITS-FIELD_BITS], table_address[FIELD_BITS-1:0]
        };

        light_attenuation u_light_attenuation (
            .clk(clk),
            .write_enable(write_factor & to_unit[u]),
            .write_address({to_turn, to_factor}),
            .write_word(table_word),
            .depth(depth),
            .turn(turn),
            .cosine(cosine_late),
            .highlight(highlight_found),
            .scaled_cosine(cosine_colour),
            .scaled_highlight(scaled)
        );

        if (HIGHLIGHT_COLOUR) begin : gen_coloured
          assign highlight = scaled;
        end else begin : gen_white
          delay #(
              .BITS  (HIGHLIGHT_BITS),
              .CYCLES(`PHONG_MULTIPLIER_LATENCY)
          ) u_highlight (
              .clk(clk),
              .in ({scaled, {PRODUCT_BITS - ROUNDED_BITS{1'b0}}} >> WHITE_SHIFT),
              .out(highlight)
          );
        end
      end else begin : gen_no_attenuation
        assign depth_overflow = 1'b0;
        assign cosine_colour = cosine_late;
        assign highlight = highlight_found;

        wire unused = &{1'b0, write_factor};
      end

      light_terms u_light_terms (
          .clk(clk),
          .write_diffuse(write_diffuse & {3{to_unit[u]}}),
          .write_highlight(write_highlight & {3{to_unit[u]}}),
          .write_address({to_turn, to_material}),
          .write_word(code),
          .place_early({turn_table, material_table}),
          .cosine(cosine_colour),
          .lit(lit_colour),
          .highlight(highlight),
          .terms(terms[u*CHANNELS*TERM_BITS+:CHANNELS*TERM_BITS])
      );
    end
  endgenerate

  // ---- red, green, blue ----
  wire [CHANNELS*COLOUR_BITS-1:0] colour;

  generate
    for (c = 0; c < CHANNELS; c = c + 1) begin : gen_channel
      wire [UNITS*TERM_BITS-1:0] its_terms;

      for (u = 0; u < UNITS; u = u + 1) begin : gen_term
        assign its_terms[u*TERM_BITS+:TERM_BITS] = terms[(u*CHANNELS+c)*TERM_BITS+:TERM_BITS];
      end

      light_sum u_light_sum (
          .clk(clk),
          .write_ambient(write_ambient[c]),
          .write_address(to_material),
          .write_word(code),
          .terms(its_terms),
          .first(first_sum),
          .material(material_sum),
          .colour(colour[c*COLOUR_BITS+:COLOUR_BITS])
      );
    end
  endgenerate

  assign {blue, green, red} = {3 / CHANNELS{colour}};

  wire unused = &{1'b0, unused_half, own_shifts, zeros, next_turn, table_word};

endmodule

`default_nettype wire
