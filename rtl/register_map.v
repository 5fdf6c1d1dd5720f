// register_map: the write port: registers, and strobes for the material table.
// Write only between frames: what is written changes the pixels in flight.
// Latency 1 to the strobes, 2 to the registers.
`default_nettype none
`include "phong_config.vh"

module register_map #(
    parameter MATERIAL_BITS    = `PHONG_MATERIAL_BITS,
    parameter INDEX_BITS       = `PHONG_WEIGHT_INDEX_BITS,
    parameter COEFFICIENT_BITS = `PHONG_COEFFICIENT_BITS,
    parameter HALF_BITS        = `PHONG_HALF_VECTOR_BITS
) (
    input wire clk,

    // address {0, material, interval}: word {step s1.16, left u1.16} of W(i)
    // address {1, material, field}: fields below
    input wire                                write_enable,
    input wire [MATERIAL_BITS+INDEX_BITS:0] write_address,
    input wire [      2*COEFFICIENT_BITS:0] write_word,

    // registers
    output reg [HALF_BITS-1:0] half_x,  // s0.17
    output reg [HALF_BITS-1:0] half_z,
    output reg                 two_sided,

    // material table
    output reg                                write_weight,
    output reg                                write_exponent,
    output reg [                         2:0] write_ambient,  // blue, green, red
    output reg [                         2:0] write_diffuse,
    output reg [MATERIAL_BITS+INDEX_BITS-1:0] table_address,
    output reg [        2*COEFFICIENT_BITS:0] table_word
);

  localparam [INDEX_BITS-1:0] AMBIENT_RED = `PHONG_FIELD_AMBIENT;
  localparam [INDEX_BITS-1:0] DIFFUSE_RED = `PHONG_FIELD_DIFFUSE;
  localparam [INDEX_BITS-1:0] EXPONENT = `PHONG_FIELD_EXPONENT;
  localparam [INDEX_BITS-1:0] HALF_X = `PHONG_FIELD_HALF_X;  // of any material
  localparam [INDEX_BITS-1:0] HALF_Z = `PHONG_FIELD_HALF_Z;
  localparam [INDEX_BITS-1:0] CONTROL = `PHONG_FIELD_CONTROL;  // bit 0: two-sided

  wire is_weight = ~write_address[MATERIAL_BITS+INDEX_BITS];
  wire [INDEX_BITS-1:0] field = write_address[INDEX_BITS-1:0];
  wire write_field = write_enable & ~is_weight;

  reg write_half_x, write_half_z, write_control;

  integer c;
  always @(posedge clk) begin
    write_half_x <= write_field & (field == HALF_X);
    write_half_z <= write_field & (field == HALF_Z);
    write_control <= write_field & (field == CONTROL);
    if (write_half_x) half_x <= table_word[HALF_BITS-1:0];
    if (write_half_z) half_z <= table_word[HALF_BITS-1:0];
    if (write_control) two_sided <= table_word[0];
    write_weight <= write_enable & is_weight;
    write_exponent <= write_field & (field == EXPONENT);
    for (c = 0; c < 3; c = c + 1) begin
      write_ambient[c] <= write_field & (field == AMBIENT_RED + c[INDEX_BITS-1:0]);
      write_diffuse[c] <= write_field & (field == DIFFUSE_RED + c[INDEX_BITS-1:0]);
    end
    table_address <= write_address[MATERIAL_BITS+INDEX_BITS-1:0];
    table_word <= write_word;
  end

endmodule

`default_nettype wire
