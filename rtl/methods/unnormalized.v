// unnormalized: what stands in place of the normalizer where the interpolated vector itself is
// shaded, as if it were a unit normal: rounded to the words of one.
// One normal a clock; latency below.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module unnormalized (
    input  wire                          clk,
    input  wire                          two_sided,  // 1: shade |Zn|
    input  wire [`PHONG_NORMAL_BITS-1:0] x,          // s1.30, normal, light frame
    input  wire [`PHONG_NORMAL_BITS-1:0] y,
    input  wire [`PHONG_NORMAL_BITS-1:0] z,
    output wire [`PHONG_UNIT_BITS-1:0]   unit_x,     // s0.17, the same
    output wire [`PHONG_UNIT_BITS-1:0]   unit_y,
    output wire [`PHONG_UNIT_BITS-1:0]   unit_z,
    output wire [`PHONG_COSINE_BITS-1:0] cosine,     // u0.18, |Zn|
    output wire                          lit         // Zn > 0 (two-sided: Zn not 0), exact
);

  localparam NORMAL_BITS     = `PHONG_NORMAL_BITS;
  localparam NORMAL_FRACTION = `PHONG_NORMAL_FRACTION;
  localparam UNIT_BITS       = `PHONG_UNIT_BITS;
  localparam UNIT_FRACTION   = `PHONG_UNIT_FRACTION;
  localparam COSINE_BITS     = `PHONG_COSINE_BITS;
  localparam COSINE_FRACTION = `PHONG_COSINE_FRACTION;
  localparam LATENCY         = `PHONG_UNNORMALIZED_LATENCY;

  reg lit_p1;

  always @(posedge clk) lit_p1 <= (z != 0) & (two_sided | ~z[NORMAL_BITS-1]);

  delay #(
      .BITS  (1),
      .CYCLES(LATENCY - 1)
  ) u_lit (
      .clk(clk),
      .in (lit_p1),
      .out(lit)
  );

  reg [3*NORMAL_BITS-1:0] xyz_p1;
  reg [  NORMAL_BITS-1:0] magnitude_p1;
  wire [3*UNIT_BITS-1:0] unit;

  always @(posedge clk) begin
    xyz_p1 <= {z, y, x};
    magnitude_p1 <= (z ^ {NORMAL_BITS{z[NORMAL_BITS-1]}})
        + {{NORMAL_BITS - 1{1'b0}}, z[NORMAL_BITS-1]};
  end

  genvar c;
  generate
    for (c = 0; c < 3; c = c + 1) begin : gen_component
      round_saturate #(
          .IN_BITS (NORMAL_BITS),
          .DROP    (NORMAL_FRACTION - UNIT_FRACTION),
          .OUT_BITS(UNIT_BITS)
      ) u_unit (
          .clk(clk),
          .in (xyz_p1[c*NORMAL_BITS+:NORMAL_BITS]),
          .out(unit[c*UNIT_BITS+:UNIT_BITS])
      );
    end
  endgenerate

  assign {unit_z, unit_y, unit_x} = unit;

  round_saturate #(
      .IN_BITS  (NORMAL_BITS),
      .DROP     (NORMAL_FRACTION - COSINE_FRACTION),
      .OUT_BITS (COSINE_BITS),
      .IS_SIGNED(0)
  ) u_cosine (
      .clk(clk),
      .in (magnitude_p1),
      .out(cosine)
  );

endmodule

`default_nettype wire
