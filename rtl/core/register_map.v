// SPDX-License-Identifier: MIT
// register_map: decodes the write port: holds the registers, and strobes the material table.
// Write only between frames: a write changes the pixels in flight.
//
//   address                  word
//   {0, material, interval}  {step s1.16, left u1.16}: W(i) over an interval of Zn
//   {1, material, field}     a field of the material, or a register (of any material); the indices
//                            are the localparams AMBIENT_RED to CONTROL
//
// Latency: 1 cycle from a write to the strobes, 2 to the registers, 4 to `unsupported`.
// Throughput: one write per cycle.
// Reset: none; registers are undefined until written.
`default_nettype none
`include "phong_config.vh"

module register_map #(
    parameter MATERIAL_BITS     = `PHONG_MATERIAL_BITS,
    parameter INDEX_BITS        = `PHONG_WEIGHT_INDEX_BITS,  // of an interval, and of a field
    parameter COEFFICIENT_BITS  = `PHONG_COEFFICIENT_BITS,
    parameter HALF_BITS         = `PHONG_HALF_VECTOR_BITS,
    parameter EXPONENT_BITS     = `PHONG_EXPONENT_BITS,
    parameter EXPONENT_FRACTION = `PHONG_EXPONENT_FRACTION,
    parameter POWER_BITS        = `PHONG_POWER_BITS,

    // features of the build; 0: left out
    parameter SPECULAR        = `PHONG_SPECULAR,         // highlight, W(i) cos(s)^n
    parameter POWER_FUNCTION  = `PHONG_POWER_FUNCTION,   // cos(s)^n for n other than 1
    parameter POWER_BYPASS    = `PHONG_POWER_BYPASS,     // n = 1 beside other n
    parameter LOG_OCTAVES     = `PHONG_LOG_OCTAVES,      // n so small that (1/2)^n is not 0
    parameter WEIGHT_FUNCTION = `PHONG_WEIGHT_FUNCTION,  // W that depends on i
    parameter DIFFUSE         = `PHONG_DIFFUSE,          // Cp (1 - d) cos(i)
    parameter AMBIENT         = `PHONG_AMBIENT,          // Cp d
    parameter CHANNELS        = `PHONG_CHANNELS,         // 3: red, green, blue; 1: grey
    parameter TWO_SIDED       = `PHONG_TWO_SIDED,        // |Zn| in place of Zn

    parameter CHECK_WRITES    = `PHONG_CHECK_WRITES,     // 1: flag values that are not legal

    // constants of the build; 0: written at run time
    parameter CONSTANT_HALF_VECTOR = `PHONG_CONSTANT_HALF_VECTOR,    // h of all frames
    parameter CONSTANT_X           = `PHONG_CONSTANT_HALF_VECTOR_X,  // s0.17
    parameter CONSTANT_Z           = `PHONG_CONSTANT_HALF_VECTOR_Z,  // s0.17
    parameter CONSTANT_EXPONENT    = `PHONG_CONSTANT_EXPONENT,       // n of all materials
    parameter CONSTANT_WEIGHT      = `PHONG_CONSTANT_WEIGHT,         // W of all materials
    parameter CONSTANT_AMBIENT     = `PHONG_CONSTANT_AMBIENT,        // Cp d of all materials
    parameter CONSTANT_DIFFUSE     = `PHONG_CONSTANT_DIFFUSE         // Cp (1 - d) of all materials
) (
    input wire clk,

    // write port
    input wire                              write_enable,   // 1: write
    input wire [MATERIAL_BITS+INDEX_BITS:0] write_address,  // see above
    input wire [2*COEFFICIENT_BITS:0]       write_word,     // see above

    // registers
    output wire [HALF_BITS-1:0] half_x,     // s0.17, half vector, x
    output wire [HALF_BITS-1:0] half_z,     // s0.17, half vector, z; y is 0
    output wire                 two_sided,  // 1: shade |Zn|

    // strobes for the material table, with address and word
    output reg                                write_weight,    // W(i) over an interval
    output reg                                write_exponent,  // n
    output reg [2:0]                          write_ambient,   // Cp d of {blue, green, red}
    output reg [2:0]                          write_diffuse,   // Cp (1 - d) of {blue, green, red}
    output reg [MATERIAL_BITS+INDEX_BITS-1:0] table_address,   // {material, interval or field}
    output reg [2*COEFFICIENT_BITS:0]         table_word,      // write_word, one cycle later

    // one-cycle pulse: a word needs what this build leaves out, or with CHECK_WRITES is not legal
    output wire unsupported
);

  localparam [INDEX_BITS-1:0] AMBIENT_RED = `PHONG_FIELD_AMBIENT;  // u1.16, then green, blue
  localparam [INDEX_BITS-1:0] DIFFUSE_RED = `PHONG_FIELD_DIFFUSE;  // u1.16, then green, blue
  localparam [INDEX_BITS-1:0] EXPONENT = `PHONG_FIELD_EXPONENT;    // u8.9
  localparam [INDEX_BITS-1:0] HALF_X = `PHONG_FIELD_HALF_X;        // s0.17, register
  localparam [INDEX_BITS-1:0] HALF_Z = `PHONG_FIELD_HALF_Z;        // s0.17, register
  localparam [INDEX_BITS-1:0] CONTROL = `PHONG_FIELD_CONTROL;      // register, bit 0: two-sided

  wire is_weight = ~write_address[MATERIAL_BITS+INDEX_BITS];
  wire [INDEX_BITS-1:0] field = write_address[INDEX_BITS-1:0];
  wire write_field = write_enable & ~is_weight;
  reg write_half_x, write_half_z, write_control;

  integer c;
  always @(posedge clk) begin
    write_weight <= write_enable & is_weight;
    write_exponent <= write_field & (field == EXPONENT);
    write_half_x <= write_field & (field == HALF_X);
    write_half_z <= write_field & (field == HALF_Z);
    write_control <= write_field & (field == CONTROL);
    for (c = 0; c < 3; c = c + 1) begin
      write_ambient[c] <= write_field & (field == AMBIENT_RED + c[INDEX_BITS-1:0]);
      write_diffuse[c] <= write_field & (field == DIFFUSE_RED + c[INDEX_BITS-1:0]);
    end
    table_address <= write_address[MATERIAL_BITS+INDEX_BITS-1:0];
    table_word <= write_word;
  end

  // ---- registers ----
  generate
    if (CONSTANT_HALF_VECTOR) begin : gen_constant_half_vector
      assign half_x = CONSTANT_X;
      assign half_z = CONSTANT_Z;
    end else begin : gen_half_vector
      reg [HALF_BITS-1:0] x, z;

      always @(posedge clk) begin
        if (write_half_x) x <= table_word[HALF_BITS-1:0];
        if (write_half_z) z <= table_word[HALF_BITS-1:0];
      end

      assign half_x = x;
      assign half_z = z;
    end

    if (TWO_SIDED) begin : gen_two_sided
      reg two_sided_held;
      always @(posedge clk) if (write_control) two_sided_held <= table_word[0];
      assign two_sided = two_sided_held;
    end else begin : gen_one_sided
      assign two_sided = 1'b0;
    end
  endgenerate

  // ---- unsupported: words that need what is left out ----
  localparam [EXPONENT_BITS-1:0] ONE = 1 << EXPONENT_FRACTION;  // n = 1
  // The least n for which 2^-n is 0 in the word of cos(s)^n.
  localparam [EXPONENT_BITS-1:0] VANISHES = (POWER_BITS + 1) << EXPONENT_FRACTION;

  wire [COEFFICIENT_BITS-1:0] code = table_word[COEFFICIENT_BITS-1:0];
  wire [COEFFICIENT_BITS:0] step = table_word[2*COEFFICIENT_BITS:COEFFICIENT_BITS];
  wire [EXPONENT_BITS-1:0] n = table_word[EXPONENT_BITS-1:0];
  wire [HALF_BITS-1:0] half = table_word[HALF_BITS-1:0];

  generate
    if (SPECULAR && POWER_FUNCTION && POWER_BYPASS && LOG_OCTAVES && WEIGHT_FUNCTION && DIFFUSE
        && AMBIENT && CHANNELS == 3 && TWO_SIDED && !CONSTANT_HALF_VECTOR
        && !CONSTANT_EXPONENT && !CONSTANT_WEIGHT && !CONSTANT_AMBIENT
        && !CONSTANT_DIFFUSE && !CHECK_WRITES) begin : gen_everything
      assign unsupported = 1'b0;
      wire unused = &{1'b0, code, step, n, half, ONE, VANISHES};
    end else begin : gen_check
      localparam [COEFFICIENT_BITS-1:0] COEFFICIENT_ONE = 1 << `PHONG_COEFFICIENT_FRACTION;
      localparam [COEFFICIENT_BITS+1:0] END_ONE = 1 << `PHONG_COEFFICIENT_FRACTION;
      localparam [EXPONENT_BITS-1:0] MOST = `PHONG_MAX_EXPONENT << EXPONENT_FRACTION;

      // W at the right end of an interval, in two's complement.
      wire signed [COEFFICIENT_BITS+1:0] end_code = $signed({1'b0, code}) + $signed(step);

      // The flag is not timing critical. Three register stages: classify the word and its target,
      // compare with what is missing, OR.
      reg nonzero_word, nonzero_code, nonzero_step, is_one, is_small, asks_two_sided;
      reg other_x, other_z, other_n, other_w;
      reg [2:0] other_ambient, other_diffuse;
      reg to_x, to_z, to_n, to_control, to_weight;
      reg [2:0] to_ambient, to_diffuse;
      reg above_one, other_end, other_power;
      reg [12:0] missing;
      reg flagged;

      always @(posedge clk) begin
        nonzero_word <= table_word != 0;
        nonzero_code <= code != 0;
        nonzero_step <= step != 0;
        is_one <= n == ONE;
        is_small <= n < VANISHES;
        asks_two_sided <= table_word[0];
        other_x <= half != half_x;
        other_z <= half != half_z;
        other_n <= n != `PHONG_CONSTANT_EXPONENT_N;
        other_w <= code != `PHONG_CONSTANT_WEIGHT_W;
        other_ambient[0] <= code != `PHONG_CONSTANT_AMBIENT_RED;
        other_ambient[1] <= code != `PHONG_CONSTANT_AMBIENT_GREEN;
        other_ambient[2] <= code != `PHONG_CONSTANT_AMBIENT_BLUE;
        other_diffuse[0] <= code != `PHONG_CONSTANT_DIFFUSE_RED;
        other_diffuse[1] <= code != `PHONG_CONSTANT_DIFFUSE_GREEN;
        other_diffuse[2] <= code != `PHONG_CONSTANT_DIFFUSE_BLUE;
        above_one <= code > COEFFICIENT_ONE;
        other_end <= end_code > END_ONE;  // END_ONE has no sign, so also an end below 0
        other_power <= (n < ONE) | (n > MOST);
        to_x <= write_half_x;
        to_z <= write_half_z;
        to_n <= write_exponent & (SPECULAR != 0);  // without highlight n has no effect
        to_control <= write_control;
        to_weight <= write_weight;
        to_ambient <= write_ambient;
        to_diffuse <= write_diffuse;

        missing[0] <= (SPECULAR == 0) & to_weight & nonzero_word;
        missing[1] <= (WEIGHT_FUNCTION == 0) & to_weight & nonzero_step;
        missing[2] <= (POWER_FUNCTION == 0) & to_n & ~is_one;
        missing[3] <= (POWER_FUNCTION != 0) & (POWER_BYPASS == 0) & to_n & is_one;
        missing[4] <= (LOG_OCTAVES == 0) & to_n & ~is_one & is_small;
        missing[5] <= (DIFFUSE == 0) & |to_diffuse & nonzero_code;
        missing[6] <= (AMBIENT == 0) & |to_ambient & nonzero_code;
        missing[7] <= (CHANNELS < 3) & |{to_ambient[2:1], to_diffuse[2:1]};
        missing[8] <= (TWO_SIDED == 0) & to_control & asks_two_sided;
        missing[9] <= (CONSTANT_HALF_VECTOR != 0) & (to_x & other_x | to_z & other_z)
            | (CONSTANT_EXPONENT != 0) & to_n & other_n
            | (CONSTANT_WEIGHT != 0) & to_weight & other_w;
        missing[10] <= (CONSTANT_AMBIENT != 0) & |(to_ambient & other_ambient);
        missing[11] <= (CONSTANT_DIFFUSE != 0) & |(to_diffuse & other_diffuse);
        missing[12] <= (CHECK_WRITES != 0)
            & ((|to_ambient | |to_diffuse | to_weight) & above_one | to_weight & other_end
            | to_n & other_power);
        flagged <= |missing;
      end

      assign unsupported = flagged;
    end
  endgenerate

endmodule

`default_nettype wire
