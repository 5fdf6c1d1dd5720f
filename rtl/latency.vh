// SPDX-License-Identifier: MIT
// Latency of every module, in cycles from input to output: one sum per module, with a comment per
// term. "name: step" names the section of the module, which is also the function of its twin, and
// the step in it.
// LATENCY of a module refers to its macro here, because Verilog-2005 gives a parent no other way to
// read it. The testbench of every module asserts its LATENCY.
`ifndef PHONG_LATENCY_VH
`define PHONG_LATENCY_VH
`include "phong_config.vh"

`define PHONG_MULTIPLIER_LATENCY 2         // operand register, product register
`define PHONG_NARROW_MULTIPLIER_LATENCY 4  // 8 rows, three levels of the adder tree
`define PHONG_ROM_LATENCY 2                // array register, output register
`define PHONG_RAM_LATENCY 2                // array register, output register
`define PHONG_SMALL_RAM_LATENCY 1          // output register
`define PHONG_LEADING_ZEROS_LATENCY 2      // groups of four, first group
`define PHONG_LEFT_SHIFTER_LATENCY 2       // multiples of four, remainder
`define PHONG_ROUND_SATURATE_LATENCY 2     // round, saturate

`define PHONG_INVERSE_SQRT_LINEAR_LATENCY \
  ( 1                                /* lookup: align, address */ \
  + `PHONG_ROM_LATENCY \
  + `PHONG_MULTIPLIER_LATENCY        /* refine: slope * offset */ \
  + 1                                /* refine: subtract */ \
  + `PHONG_ROUND_SATURATE_LATENCY )

// Other methods for 1/sqrt.
`define PHONG_INVERSE_SQRT_QUADRATIC_LATENCY \
  ( 1                                /* lookup: align, address */ \
  + `PHONG_ROM_LATENCY \
  + `PHONG_MULTIPLIER_LATENCY        /* bend: curve * offset */ \
  + 1                                /* bend: subtract */ \
  + `PHONG_MULTIPLIER_LATENCY        /* refine: slope * offset */ \
  + 1                                /* refine: subtract */ \
  + `PHONG_ROUND_SATURATE_LATENCY )

`define PHONG_NEWTON_STEP_LATENCY \
  ( `PHONG_MULTIPLIER_LATENCY        /* error: square */ \
  + `PHONG_ROUND_SATURATE_LATENCY \
  + `PHONG_MULTIPLIER_LATENCY        /* error: times x */ \
  + 1                                /* error: from 1 */ \
  + `PHONG_MULTIPLIER_LATENCY        /* better: times y */ \
  + 1                                /* better: add */ \
  + `PHONG_ROUND_SATURATE_LATENCY )

`define PHONG_INVERSE_SQRT_START_LATENCY \
  ( 1                                /* start: address; fast inverse: align */ \
  + `PHONG_ROM_LATENCY )             /* fast inverse: subtract, shift */

`define PHONG_INVERSE_SQRT_ITERATED_LATENCY \
  ( `PHONG_INVERSE_SQRT_START_LATENCY \
  + `PHONG_ROOT_NEWTON_STEPS * `PHONG_NEWTON_STEP_LATENCY )

`define PHONG_INVERSE_SQRT_LATENCY \
  ( `PHONG_ROOT_METHOD == `PHONG_ROOT_METHOD_LINES ? `PHONG_INVERSE_SQRT_LINEAR_LATENCY : \
    `PHONG_ROOT_METHOD == `PHONG_ROOT_METHOD_QUADRATIC ? `PHONG_INVERSE_SQRT_QUADRATIC_LATENCY : \
    `PHONG_INVERSE_SQRT_ITERATED_LATENCY )

`define PHONG_ALIGN_LATENCY \
  ( (`PHONG_CONSTANT_SHIFT ? 0 : 1 + `PHONG_LEADING_ZEROS_LATENCY + `PHONG_LEFT_SHIFTER_LATENCY) \
                                     /* significant bits of three components; shift */ \
  + `PHONG_ROUND_SATURATE_LATENCY )

// From an interpolated normal to zero_normal.
`define PHONG_ZERO_NORMAL_LATENCY \
  ( 1                                /* significant bits of three components */ \
  + `PHONG_LEADING_ZEROS_LATENCY \
  + 1 )

`define PHONG_NORMALIZER_LATENCY \
  ( `PHONG_ALIGN_LATENCY \
  + `PHONG_MULTIPLIER_LATENCY        /* squares */ \
  + 2                                /* sum_of_squares */ \
  + 1                                /* root_operand */ \
  + `PHONG_INVERSE_SQRT_LATENCY \
  + `PHONG_MULTIPLIER_LATENCY        /* scale */ \
  + 1                                /* scale: double */ \
  + `PHONG_ROUND_SATURATE_LATENCY )

`define PHONG_UNNORMALIZED_LATENCY \
  ( 1                                /* |Zn| */ \
  + `PHONG_ROUND_SATURATE_LATENCY )

`define PHONG_QUADRATIC_NORMALIZER_LATENCY \
  ( 1                                /* clamp */ \
  + `PHONG_LEADING_ZEROS_LATENCY     /* shifts */ \
  + `PHONG_LEFT_SHIFTER_LATENCY      /* align; C takes longer, but is needed later */ \
  + `PHONG_INVERSE_SQRT_LATENCY \
  + `PHONG_MULTIPLIER_LATENCY        /* versine: square of the root */ \
  + `PHONG_ROUND_SATURATE_LATENCY \
  + `PHONG_MULTIPLIER_LATENCY        /* versine: product */ \
  + 2                                /* versine: shift twice */ \
  + `PHONG_ROUND_SATURATE_LATENCY )

// From the interpolators to shading_unit.
`define PHONG_NORMAL_LATENCY \
  ( `PHONG_NORMAL_METHOD == `PHONG_NORMAL_METHOD_QUADRATIC_SPANS ? \
        `PHONG_QUADRATIC_NORMALIZER_LATENCY : \
    `PHONG_HOLD_UNLIT \
  + (`PHONG_NORMAL_METHOD == `PHONG_NORMAL_METHOD_NONE ? `PHONG_UNNORMALIZED_LATENCY : \
    `PHONG_NORMALIZER_LATENCY) )

`define PHONG_HALF_VECTOR_CROSS_LATENCY \
  ( (`PHONG_CONSTANT_HALF_VECTOR ? `PHONG_CONSTANT_HALF_VECTOR_LEVELS \
                                 : `PHONG_MULTIPLIER_LATENCY + 1) \
                                     /* products with h; a register behind the DSP blocks */ \
  + 1                                /* subtract */ \
  + `PHONG_ROUND_SATURATE_LATENCY )

`define PHONG_VERSINE_OF_CROSS_LATENCY \
  ( `PHONG_MULTIPLIER_LATENCY        /* squares */ \
  + 2                                /* a register behind the DSP blocks; sum */ \
  + `PHONG_ROUND_SATURATE_LATENCY )

`define PHONG_REFLECTION_LATENCY \
  (`PHONG_HALF_VECTOR_CROSS_LATENCY + `PHONG_VERSINE_OF_CROSS_LATENCY)

// From the input of shading_unit to 1 - cos(s).
`define PHONG_HIGHLIGHT_LATENCY \
  ( `PHONG_NORMAL_METHOD == `PHONG_NORMAL_METHOD_DOT_FIRST ? `PHONG_VERSINE_OF_CROSS_LATENCY : \
    `PHONG_NORMAL_METHOD == `PHONG_NORMAL_METHOD_QUADRATIC_SPANS ? 0 : `PHONG_REFLECTION_LATENCY )

`define PHONG_LOG_LATENCY \
  ( (`PHONG_LOG_OCTAVES ? `PHONG_LEADING_ZEROS_LATENCY + `PHONG_LEFT_SHIFTER_LATENCY : 0) \
                                     /* leading_ones */ \
  + `PHONG_ROM_LATENCY               /* log_lookup */ \
  + `PHONG_MULTIPLIER_LATENCY        /* log_refine: slope * offset */ \
  + 1                                /* log_refine: add */ \
  + `PHONG_LEADING_ZEROS_LATENCY     /* log_normalize */ \
  + `PHONG_LEFT_SHIFTER_LATENCY )

`define PHONG_SPECULAR_COSINE_LATENCY \
  ( 1                                /* 1 - versine */ \
  + `PHONG_ROUND_SATURATE_LATENCY )

`define PHONG_TIMES_EXPONENT_LATENCY \
  ( `PHONG_CONSTANT_EXPONENT ? `PHONG_CONSTANT_EXPONENT_LEVELS : `PHONG_MULTIPLIER_LATENCY )

`define PHONG_SPECULAR_POWER_TABLES_LATENCY \
  ( `PHONG_LOG_LATENCY \
  + `PHONG_TIMES_EXPONENT_LATENCY \
  + 3                                /* times_exponent: shift twice, saturate */ \
  + `PHONG_ROM_LATENCY               /* exp_lookup */ \
  + `PHONG_NARROW_MULTIPLIER_LATENCY /* exp_refine: slope * offset */ \
  + 1                                /* exp_refine: subtract */ \
  + 2                                /* exp_shift: shift twice */ \
  + `PHONG_ROUND_SATURATE_LATENCY    /* exp_shift: round */ \
  + `PHONG_POWER_BYPASS )            /* bypass */

// Other methods for cos(s)^n.
`define PHONG_SQUARING_STAGE_LATENCY \
  ( `PHONG_MULTIPLIER_LATENCY        /* products */ \
  + `PHONG_ROUND_SATURATE_LATENCY \
  + 1 )                              /* select */

`define PHONG_SPECULAR_POWER_SQUARING_LATENCY \
  ( `PHONG_SPECULAR_COSINE_LATENCY \
  + (`PHONG_EXPONENT_BITS - `PHONG_EXPONENT_FRACTION - 1) * `PHONG_SQUARING_STAGE_LATENCY \
  + 1 )                              /* last: select */

`define PHONG_SPECULAR_POWER_SCHLICK_LATENCY \
  ( `PHONG_ROUND_SATURATE_LATENCY    /* denominator: versine */ \
  + `PHONG_MULTIPLIER_LATENCY        /* denominator: times n - 1 */ \
  + 1                                /* denominator: plus 1 */ \
  + `PHONG_LEADING_ZEROS_LATENCY     /* normalize */ \
  + `PHONG_LEFT_SHIFTER_LATENCY \
  + `PHONG_ROM_LATENCY               /* reciprocal: lookup */ \
  + `PHONG_MULTIPLIER_LATENCY        /* reciprocal: slope * offset */ \
  + 1                                /* reciprocal: subtract */ \
  + `PHONG_ROUND_SATURATE_LATENCY \
  + `PHONG_MULTIPLIER_LATENCY        /* quotient: product */ \
  + 2                                /* quotient: shift twice */ \
  + `PHONG_ROUND_SATURATE_LATENCY )

// Reflectance by table.
`define PHONG_JUMPS_LATENCY \
  ( `PHONG_SMALL_RAM_LATENCY \
  + 1                                /* select */ \
  + 2 )                              /* sum */

// From a line to the amounts of its jumps.
`define PHONG_STEPPED_FALL_LATENCY \
  ( `PHONG_MULTIPLIER_LATENCY        /* line: step * offset */ \
  + 1 )                              /* line: add */

`define PHONG_STEPPED_LINE_LATENCY \
  ( `PHONG_STEPPED_FALL_LATENCY \
  + 1                                /* level: subtract */ \
  + `PHONG_ROUND_SATURATE_LATENCY )  /* result */

// From `versine` to its material.
`define PHONG_CURVE_OCTAVE_LATENCY \
  (`PHONG_LEADING_ZEROS_LATENCY + `PHONG_LEFT_SHIFTER_LATENCY)

`define PHONG_REFLECTANCE_TABLE_LATENCY \
  ( `PHONG_CURVE_OCTAVE_LATENCY \
  + `PHONG_RAM_LATENCY               /* lookup */ \
  + 1                                /* lookup: select the block */ \
  + `PHONG_STEPPED_LINE_LATENCY )

`define PHONG_STEPPED_WEIGHT_LATENCY \
  (`PHONG_RAM_LATENCY + `PHONG_STEPPED_LINE_LATENCY)

`define PHONG_SPECULAR_POWER_LATENCY \
  ( `PHONG_POWER_METHOD == `PHONG_POWER_METHOD_TABLES ? `PHONG_SPECULAR_POWER_TABLES_LATENCY : \
    `PHONG_POWER_METHOD == `PHONG_POWER_METHOD_SQUARING ? `PHONG_SPECULAR_POWER_SQUARING_LATENCY : \
    `PHONG_POWER_METHOD == `PHONG_POWER_METHOD_CURVE ? `PHONG_REFLECTANCE_TABLE_LATENCY : \
    `PHONG_SPECULAR_POWER_SCHLICK_LATENCY )

// From `versine` to its `exponent`.
`define PHONG_EXPONENT_LATENCY \
  ( `PHONG_POWER_METHOD == `PHONG_POWER_METHOD_TABLES ? `PHONG_LOG_LATENCY : \
    `PHONG_POWER_METHOD == `PHONG_POWER_METHOD_SQUARING ? `PHONG_SPECULAR_COSINE_LATENCY - 1 : \
    `PHONG_POWER_METHOD == `PHONG_POWER_METHOD_CURVE ? \
        `PHONG_CURVE_OCTAVE_LATENCY + `PHONG_SMALL_RAM_LATENCY : 0 )

`define PHONG_SPECULAR_WEIGHT_LATENCY \
  ( `PHONG_RAM_LATENCY               /* lookup */ \
  + `PHONG_MULTIPLIER_LATENCY        /* interpolate: step * offset */ \
  + 1                                /* interpolate: add */ \
  + 1 )                              /* interpolate: round */

// Of W(i): one word of a material, or a table, with or without jumps.
`define PHONG_WEIGHT_LATENCY \
  ( !`PHONG_WEIGHT_FUNCTION ? `PHONG_SMALL_RAM_LATENCY : \
    `PHONG_WEIGHT_JUMPS > 0 ? `PHONG_STEPPED_WEIGHT_LATENCY : `PHONG_SPECULAR_WEIGHT_LATENCY )

`define PHONG_WEIGHT_PRODUCT_LATENCY \
  ( `PHONG_CONSTANT_WEIGHT ? `PHONG_CONSTANT_WEIGHT_LEVELS : `PHONG_MULTIPLIER_LATENCY )

`define PHONG_DIFFUSE_PRODUCT_LATENCY \
  ( `PHONG_CONSTANT_DIFFUSE ? `PHONG_CONSTANT_DIFFUSE_LEVELS : `PHONG_MULTIPLIER_LATENCY )

// Of the slower product, if there are two.
`define PHONG_PRODUCTS_LATENCY \
  ( `PHONG_SPECULAR \
    & (!`PHONG_DIFFUSE | (`PHONG_WEIGHT_PRODUCT_LATENCY > `PHONG_DIFFUSE_PRODUCT_LATENCY)) \
    ? `PHONG_WEIGHT_PRODUCT_LATENCY : `PHONG_DIFFUSE_PRODUCT_LATENCY )

`define PHONG_COLOUR_CHANNEL_LATENCY \
  ( `PHONG_PRODUCTS_LATENCY          /* intensity: products */ \
  + (`PHONG_AMBIENT & `PHONG_DIFFUSE & `PHONG_SPECULAR ? 2 : 1) \
                                     /* intensity: ambient + diffuse, + specular */ \
  + 1                                /* intensity: clamp, cut */ \
  + 2 )                              /* code: times 255, round */

`define PHONG_POWER_LATENCY \
  ( `PHONG_POWER_FUNCTION ? `PHONG_SPECULAR_POWER_LATENCY : `PHONG_SPECULAR_COSINE_LATENCY )

// From the unit normal to the products of eq. (3).
`define PHONG_SPECULAR_LATENCY \
  ( `PHONG_SPECULAR ? `PHONG_HIGHLIGHT_LATENCY + `PHONG_POWER_LATENCY \
                    : `PHONG_SMALL_RAM_LATENCY )

`define PHONG_SHADING_UNIT_LATENCY \
  ( `PHONG_SPECULAR_LATENCY \
  + `PHONG_COLOUR_CHANNEL_LATENCY )  /* W * power runs beside the products in it */

// Several lights: from an interpolated normal to its mantissas.
`define PHONG_LIGHT_ALIGN_LATENCY \
  ( 1                                /* leading_zeros: significant bits of three components */ \
  + `PHONG_LEADING_ZEROS_LATENCY \
  + 1                                /* hold the first light's shift */ \
  + 1                                /* shift: that of the first light, or less */ \
  + `PHONG_LEFT_SHIFTER_LATENCY      /* align */ \
  + `PHONG_ROUND_SATURATE_LATENCY )

`define PHONG_HELD_ROOT_LATENCY \
  ( `PHONG_MULTIPLIER_LATENCY        /* squares */ \
  + 2                                /* sum_of_squares */ \
  + 1                                /* root_operand */ \
  + `PHONG_INVERSE_SQRT_LATENCY \
  + 1 )                              /* hold */

`define PHONG_LIGHT_SCALE_LATENCY \
  ( `PHONG_MULTIPLIER_LATENCY        /* scale */ \
  + 1                                /* scale: double */ \
  + `PHONG_ROUND_SATURATE_LATENCY )

// From the interpolators to the unit normals.
`define PHONG_LIGHT_NORMAL_LATENCY \
  (`PHONG_LIGHT_ALIGN_LATENCY + `PHONG_HELD_ROOT_LATENCY + `PHONG_LIGHT_SCALE_LATENCY)

// From the unit normal to W(i) cos(s)^n.
`define PHONG_LIGHT_HIGHLIGHT_LATENCY \
  ( `PHONG_HIGHLIGHT_LATENCY + `PHONG_POWER_LATENCY \
  + `PHONG_MULTIPLIER_LATENCY        /* W times the power */ \
  + (`PHONG_ROUNDS_HIGHLIGHT ? `PHONG_ROUND_SATURATE_LATENCY : 0) )

// From N.L and W(i) cos(s)^n to both times the factor of the distance.
`define PHONG_LIGHT_ATTENUATION_LATENCY \
  ( `PHONG_MULTIPLIER_LATENCY        /* scale: products */ \
  + `PHONG_ROUND_SATURATE_LATENCY )

`define PHONG_LIGHT_TABLE_LATENCY \
  ( `PHONG_TURNS > 1 ? `PHONG_RAM_LATENCY : `PHONG_SMALL_RAM_LATENCY )

// From the unit normal to the products with the colours. A white highlight has none and arrives
// with the diffuse product; if it is rounded, it waits for that product.
`define PHONG_LIGHT_COLOUR_LATENCY \
  ( (!`PHONG_SPECULAR ? `PHONG_LIGHT_TABLE_LATENCY : \
     `PHONG_LIGHT_HIGHLIGHT_LATENCY \
     - (`PHONG_ROUNDS_HIGHLIGHT ? 0 : `PHONG_MULTIPLIER_LATENCY)) \
  + (`PHONG_ATTENUATION ? `PHONG_LIGHT_ATTENUATION_LATENCY : 0) )

`define PHONG_LIGHT_TERMS_LATENCY \
  ( `PHONG_MULTIPLIER_LATENCY        /* products with the colours */ \
  + 1 )                              /* diffuse + specular */

`define PHONG_LIGHT_SUM_LATENCY \
  ( (`PHONG_UNITS > 4 ? 3 : `PHONG_UNITS > 2 ? 2 : `PHONG_UNITS - 1) \
                                     /* tree */ \
  + 2                                /* accumulate: look-up of the ambient part; add */ \
  + 1                                /* clamp, cut */ \
  + 2 )                              /* code: times 255, round */

`define PHONG_INTENSITY_CODE_LATENCY \
  ( 1                                /* clamp, cut */ \
  + 2 )                              /* code: times 255, round */

// From a pixel of span_walker (several lights: its last turn) to its colour.
`define PHONG_PIXEL_LATENCY \
  ( `PHONG_SUMS_LIGHTS \
  ? `PHONG_LIGHT_NORMAL_LATENCY + `PHONG_LIGHT_COLOUR_LATENCY + `PHONG_LIGHT_TERMS_LATENCY \
    + `PHONG_LIGHT_SUM_LATENCY \
  : `PHONG_TECHNIQUE == `PHONG_TECHNIQUE_PHONG \
  ? `PHONG_NORMAL_LATENCY + `PHONG_SHADING_UNIT_LATENCY \
  : `PHONG_INTENSITY_CODE_LATENCY )  /* Gouraud, flat */

`endif
