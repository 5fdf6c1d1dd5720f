// Latency of every module, in clocks from input to output, as sums that explain themselves.
// A module's own LATENCY parameter refers to its line here, because Verilog-2005 gives a parent no
// other way to read it; every module's testbench asserts it.
`ifndef PHONG_LATENCY_VH
`define PHONG_LATENCY_VH

`define PHONG_MULTIPLIER_LATENCY 2         // operand register, product register
`define PHONG_NARROW_MULTIPLIER_LATENCY 4  // 8 rows, three levels of an adder tree
`define PHONG_ROM_LATENCY 2                // array register, output register
`define PHONG_RAM_LATENCY 2                // array register, output register
`define PHONG_SMALL_RAM_LATENCY 1          // output register
`define PHONG_LEADING_ZEROS_LATENCY 2      // groups of four, first group
`define PHONG_LEFT_SHIFTER_LATENCY 2       // multiples of four, remainder
`define PHONG_ROUND_SATURATE_LATENCY 2     // round, saturate

`define PHONG_INVERSE_SQRT_LATENCY \
  ( 1                                /* lookup: align, address */ \
  + `PHONG_ROM_LATENCY \
  + `PHONG_MULTIPLIER_LATENCY        /* refine: slope * offset */ \
  + 1                                /* refine: subtract */ \
  + `PHONG_ROUND_SATURATE_LATENCY )

`define PHONG_ALIGN_LATENCY \
  ( 1                                /* significant bits of three components */ \
  + `PHONG_LEADING_ZEROS_LATENCY \
  + `PHONG_LEFT_SHIFTER_LATENCY \
  + `PHONG_ROUND_SATURATE_LATENCY )

// From a normal to zero_normal.
`define PHONG_ZERO_NORMAL_LATENCY \
  ( 1                                /* significant bits of three components */ \
  + `PHONG_LEADING_ZEROS_LATENCY \
  + 1 )

`define PHONG_NORMALIZER_LATENCY \
  ( `PHONG_ALIGN_LATENCY \
  + `PHONG_MULTIPLIER_LATENCY        /* squares */ \
  + 2                                /* sum of squares */ \
  + 1                                /* operand of the root */ \
  + `PHONG_INVERSE_SQRT_LATENCY \
  + `PHONG_MULTIPLIER_LATENCY        /* scale */ \
  + 1                                /* scale: double */ \
  + `PHONG_ROUND_SATURATE_LATENCY )

`define PHONG_REFLECTION_LATENCY \
  ( `PHONG_MULTIPLIER_LATENCY        /* across: products with h */ \
  + 2                                /* across: fetch, subtract */ \
  + `PHONG_ROUND_SATURATE_LATENCY \
  + `PHONG_MULTIPLIER_LATENCY        /* versine: squares */ \
  + 2                                /* versine: fetch, sum */ \
  + `PHONG_ROUND_SATURATE_LATENCY )

`define PHONG_LOG_LATENCY \
  ( `PHONG_LEADING_ZEROS_LATENCY     /* leading ones */ \
  + `PHONG_LEFT_SHIFTER_LATENCY \
  + `PHONG_ROM_LATENCY               /* log lookup */ \
  + `PHONG_MULTIPLIER_LATENCY        /* log refine: slope * offset */ \
  + 1                                /* log refine: add */ \
  + `PHONG_LEADING_ZEROS_LATENCY     /* log normalize */ \
  + `PHONG_LEFT_SHIFTER_LATENCY )

`define PHONG_SPECULAR_POWER_LATENCY \
  ( `PHONG_LOG_LATENCY \
  + `PHONG_MULTIPLIER_LATENCY        /* times exponent */ \
  + 3                                /* times exponent: shift twice, saturate */ \
  + `PHONG_ROM_LATENCY               /* exp lookup */ \
  + `PHONG_NARROW_MULTIPLIER_LATENCY /* exp refine: slope * offset */ \
  + 1                                /* exp refine: subtract */ \
  + 2                                /* exp shift: twice */ \
  + `PHONG_ROUND_SATURATE_LATENCY    /* exp shift: round */ \
  + 1 )                              /* bypass */

`define PHONG_SPECULAR_WEIGHT_LATENCY \
  ( `PHONG_RAM_LATENCY               /* lookup */ \
  + `PHONG_MULTIPLIER_LATENCY        /* interpolate: step * offset */ \
  + 1                                /* interpolate: add */ \
  + 1 )                              /* interpolate: round */

`define PHONG_COLOUR_CHANNEL_LATENCY \
  ( `PHONG_MULTIPLIER_LATENCY        /* intensity: products */ \
  + 2                                /* intensity: ambient + diffuse, + specular */ \
  + 1                                /* intensity: clamp, cut */ \
  + 2 )                              /* code: times 255, round */

`define PHONG_SHADING_UNIT_LATENCY \
  ( `PHONG_REFLECTION_LATENCY \
  + `PHONG_SPECULAR_POWER_LATENCY \
  + `PHONG_COLOUR_CHANNEL_LATENCY )  /* W * power runs beside its products */

// From a pixel that leaves the interpolators to its colour.
`define PHONG_PIXEL_LATENCY (`PHONG_NORMALIZER_LATENCY + `PHONG_SHADING_UNIT_LATENCY)

`endif
