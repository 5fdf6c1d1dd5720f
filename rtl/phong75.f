// SPDX-License-Identifier: MIT
// The design, in the order of the data. Paths are relative to this file: read it with `-F`.
// phong_config.vh in include/ is the default configuration; `phong75 export` writes any other.
+incdir+.
+incdir+include

phong_pipeline.v

// the paper's pipeline, from a span to a pixel
core/span_walker.v
core/phong_unit.v
core/register_map.v
core/linear_interpolator.v
core/normalizer.v
core/inverse_sqrt.v
core/inverse_sqrt_linear.v
core/shading_unit.v
core/reflection.v
core/half_vector_cross.v
core/versine_of_cross.v
core/specular_cosine.v
core/specular_factors.v
core/specular_power.v
core/specular_power_tables.v
core/specular_weight.v
core/colour_channel.v
core/pixel_fifo.v

// several lights
lights/light_turns.v
lights/lights_unit.v
lights/light_map.v
lights/context_interpolator.v
lights/light_align.v
lights/light_attenuation.v
lights/span_word.v
lights/turn_hold.v
lights/held_root.v
lights/light_scale.v
lights/light_highlight.v
lights/light_terms.v
lights/light_sum.v

// curves of cos(s) by table, and jumps
reflectance/reflectance_map.v
reflectance/reflectance_table.v
reflectance/stepped_weight.v
reflectance/stepped_line.v
reflectance/jumps.v

// quadratic normals; and what Phong's paper compares with: Gouraud's and flat shading
techniques/second_difference_interpolator.v
techniques/gouraud_unit.v
techniques/flat_unit.v
techniques/intensity_code.v

// other ways to the same result, for studies
methods/unnormalized.v
methods/inverse_sqrt_quadratic.v
methods/inverse_sqrt_iterated.v
methods/newton_step.v
methods/quadratic_unit.v
methods/quadratic_interpolator.v
methods/quadratic_normalizer.v
methods/specular_power_squaring.v
methods/specular_power_schlick.v

// parts of builds that leave something out
pruning/span_guard.v
pruning/normal_hold.v
pruning/constant_multiplier.v

// arithmetic and memories
primitives/delay.v
primitives/leading_zeros.v
primitives/left_shifter.v
primitives/round_saturate.v
primitives/multiplier.v
primitives/narrow_multiplier.v
primitives/slope_multiplier.v
primitives/rom.v
primitives/ram.v
primitives/small_ram.v
primitives/lut_ram.v
