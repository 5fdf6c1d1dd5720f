// SPDX-License-Identifier: MIT
// equal_register_map: proof that register_map with a constant half vector and without two-sided
// shading equals the full one: after a write both have the same value in the register, or the
// pruned one has flagged a word.
`default_nettype none
`include "phong_config.vh"

module equal_register_map #(
    parameter HALF_BITS    = `PHONG_HALF_VECTOR_BITS,
    parameter X            = -12345,  // constant half vector, s0.17
    parameter Z            = 98765,
    parameter INDEX_BITS   = `PHONG_WEIGHT_INDEX_BITS,
    parameter ADDRESS_BITS = 1 + `PHONG_MATERIAL_BITS + INDEX_BITS,
    parameter WORD_BITS    = 2 * `PHONG_COEFFICIENT_BITS + 1
) (
    input wire clk,

    // write port of both maps
    input wire                    write_enable,
    input wire [ADDRESS_BITS-1:0] write_address,
    input wire [WORD_BITS-1:0]    write_word
);

  wire [HALF_BITS-1:0] full_x, full_z, x, z;
  wire full_two_sided, two_sided, full_unsupported, unsupported;

  register_map u_full (
      .clk(clk),
      .write_enable(write_enable),
      .write_address(write_address),
      .write_word(write_word),
      .half_x(full_x),
      .half_z(full_z),
      .two_sided(full_two_sided),
      .write_weight(),
      .write_exponent(),
      .write_ambient(),
      .write_diffuse(),
      .table_address(),
      .table_word(),
      .unsupported(full_unsupported)
  );

  register_map #(
      .CONSTANT_HALF_VECTOR(1),
      .CONSTANT_X(X),
      .CONSTANT_Z(Z),
      .TWO_SIDED(0)
  ) u_pruned (
      .clk(clk),
      .write_enable(write_enable),
      .write_address(write_address),
      .write_word(write_word),
      .half_x(x),
      .half_z(z),
      .two_sided(two_sided),
      .write_weight(),
      .write_exponent(),
      .write_ambient(),
      .write_diffuse(),
      .table_address(),
      .table_word(),
      .unsupported(unsupported)
  );

  // Which registers have been written, and what the full map has in them, delayed to the cycle of
  // the flag. Bits of the vectors: 0: half x, 1: half z, 2: control.
  wire f_field = write_enable & write_address[ADDRESS_BITS-1];
  wire [INDEX_BITS-1:0] f_index = write_address[INDEX_BITS-1:0];
  reg [2:0] f_now = 0, f_done = 0, f_done_p1 = 0, f_written = 0;
  reg [HALF_BITS-1:0] f_x_p1, f_z_p1, f_x, f_z;
  reg f_two_sided_p1, f_two_sided;
  reg f_flagged = 0;  // a word has been flagged

  always @(posedge clk) begin
    f_now <= {f_field & (f_index == `PHONG_FIELD_CONTROL),
              f_field & (f_index == `PHONG_FIELD_HALF_Z),
              f_field & (f_index == `PHONG_FIELD_HALF_X)};
    f_done <= f_done | f_now;
    {f_done_p1, f_x_p1, f_z_p1, f_two_sided_p1} <= {f_done, full_x, full_z, full_two_sided};
    {f_written, f_x, f_z, f_two_sided} <= {f_done_p1, f_x_p1, f_z_p1, f_two_sided_p1};
    f_flagged <= f_flagged | unsupported;
  end

  always @(*) begin
    a_full : assert (!full_unsupported);
    if (!f_flagged && !unsupported) begin
      a_x : assert (!f_written[0] || f_x == x);
      a_z : assert (!f_written[1] || f_z == z);
      a_two_sided : assert (!f_written[2] || f_two_sided == two_sided);
    end
  end

endmodule

`default_nettype wire
