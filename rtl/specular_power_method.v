// specular_power_method: cos(s)^n by the method that the configuration names.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module specular_power_method #(
    parameter METHOD        = `PHONG_POWER_METHOD,
    parameter VERSINE_BITS  = `PHONG_VERSINE_BITS,
    parameter EXPONENT_BITS = `PHONG_EXPONENT_BITS,
    parameter POWER_BITS    = `PHONG_POWER_BITS,
    parameter LATENCY       = `PHONG_SPECULAR_POWER_METHOD_LATENCY
) (
    input  wire                     clk,
    input  wire [ VERSINE_BITS-1:0] versine,   // u0.22, 1 - cos(s)
    input  wire [EXPONENT_BITS-1:0] exponent,  // u8.9, n, PHONG_EXPONENT_LATENCY after versine
    output wire [   POWER_BITS-1:0] power      // u0.18, cos(s)^n
);

  generate
    if (METHOD == `PHONG_POWER_METHOD_TABLES) begin : gen_tables
      specular_power u_specular_power (
          .clk(clk),
          .versine(versine),
          .exponent(exponent),
          .power(power)
      );
    end else if (METHOD == `PHONG_POWER_METHOD_SQUARING) begin : gen_squaring
      power_squaring u_specular_power (
          .clk(clk),
          .versine(versine),
          .exponent(exponent),
          .power(power)
      );
    end else begin : gen_schlick
      power_schlick u_specular_power (
          .clk(clk),
          .versine(versine),
          .exponent(exponent),
          .power(power)
      );
    end
  endgenerate

endmodule

`default_nettype wire
