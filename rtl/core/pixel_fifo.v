// pixel_fifo: takes the pixels at the end and the back-pressure, so that nothing between needs a
// stall. A pixel that leaves the interpolators owns a slot: its place on the screen is written at
// once, its colour LATENCY clocks later, so only one valid bit travels with it. Credits are free
// slots; there are enough for one pixel a clock.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module pixel_fifo #(
    parameter COORDINATE_BITS = `PHONG_COORDINATE_BITS,
    parameter COLOUR_BITS     = `PHONG_COLOUR_BITS,
    parameter CHANNELS        = `PHONG_CHANNELS,
    parameter IDLE_X_BITS     = `PHONG_IDLE_X_BITS,  // top bits that are always 0
    parameter IDLE_Y_BITS     = `PHONG_IDLE_Y_BITS,
    parameter LATENCY         = `PHONG_PIXEL_LATENCY
) (
    input wire clk,
    input wire reset,  // synchronous; drops all pixels

    // a pixel leaves the interpolators
    output reg                        credit,
    input  wire                       pixel_valid,  // only with credit
    input  wire [COORDINATE_BITS-1:0] pixel_x,
    input  wire [COORDINATE_BITS-1:0] pixel_y,
    input  wire                       pixel_last,

    // its colour, LATENCY clocks later
    input wire [COLOUR_BITS-1:0] red,
    input wire [COLOUR_BITS-1:0] green,
    input wire [COLOUR_BITS-1:0] blue,

    output reg                                        out_valid,
    input  wire                                       out_ready,
    output wire [2*COORDINATE_BITS+3*COLOUR_BITS-1:0] out_data,   // {y, x, red, green, blue}
    output wire                                       out_last
);

  // A slot is taken for LATENCY clocks, and for 1 to be written, 1 to be read, 1 for its credit;
  // the
  // last free one may be given away late.
  localparam SLOTS_NEEDED = LATENCY + 4;
  localparam BANK = 16;  // small RAMs come in sixteens
  localparam BANKS = (SLOTS_NEEDED + BANK - 1) / BANK;
  localparam SLOTS = BANK * BANKS;
  localparam SLOT_BITS = 4 + (BANKS > 1 ? $clog2(BANKS) : 1);
  localparam [SLOT_BITS-1:0] LAST_SLOT = SLOTS[SLOT_BITS-1:0] - 1'b1;
  localparam COUNT_BITS = $clog2(SLOTS + 1);
  localparam [COUNT_BITS-1:0] ALL = SLOTS;

  reg [SLOT_BITS-1:0] place_slot;
  reg [SLOT_BITS-1:0] colour_slot;
  reg [SLOT_BITS-1:0] read_slot;
  reg [COUNT_BITS-1:0] credits;  // free slots
  reg [COUNT_BITS-1:0] filled;  // slots with a colour
  reg some;  // filled is not 0

  // ---- the valid bits of the pipeline ----
  reg [LATENCY-1:0] in_flight;
  wire colour_valid = in_flight[LATENCY-1];

  always @(posedge clk) begin
    if (reset) in_flight <= {LATENCY{1'b0}};
    else in_flight <= {in_flight[LATENCY-2:0], pixel_valid};
  end

  // ---- slots ----
  // `some` and `credit` look one clock ahead from bits of the counts, not from their sums: `pop`
  // is the start of the longest paths. `credit` waits with the last slot, so that it need not
  // look at the pixel that it lets go now.
  wire pop = some & (~out_valid | out_ready);
  wire more_credits = |credits[COUNT_BITS-1:1];
  wire more_filled = |filled[COUNT_BITS-1:1];

  always @(posedge clk) begin
    if (reset) begin
      place_slot <= 0;
      colour_slot <= 0;
      read_slot <= 0;
      credits <= ALL;
      credit <= 1'b0;
      filled <= 0;
      some <= 1'b0;
      out_valid <= 1'b0;
    end else begin
      if (pixel_valid) place_slot <= place_slot == LAST_SLOT ? 0 : place_slot + 1'b1;
      if (colour_valid) colour_slot <= colour_slot == LAST_SLOT ? 0 : colour_slot + 1'b1;
      if (pop) read_slot <= read_slot == LAST_SLOT ? 0 : read_slot + 1'b1;
      if (pop ^ pixel_valid) credits <= credits + {{COUNT_BITS - 1{pixel_valid}}, 1'b1};
      credit <= pop | more_credits;
      if (pop ^ colour_valid) filled <= filled + {{COUNT_BITS - 1{~colour_valid}}, 1'b1};
      some <= colour_valid | more_filled | (filled[0] & ~pop);
      out_valid <= pop | (out_valid & ~out_ready);
    end
  end

  // ---- banks of slots, in logic cells: block RAM would be nearly empty ----
  // Each reads into a register of its own; choosing between them comes after the registers.
  localparam X_BITS = COORDINATE_BITS - IDLE_X_BITS;
  localparam Y_BITS = COORDINATE_BITS - IDLE_Y_BITS;
  localparam PLACE_BITS = 1 + Y_BITS + X_BITS;
  localparam PIXEL_BITS = PLACE_BITS + CHANNELS * COLOUR_BITS;

  wire [3*COLOUR_BITS-1:0] rgb = {red, green, blue};  // one channel: all of them blue
  wire unused = &{1'b0, rgb};
  wire [PIXEL_BITS-1:0] chosen[0:BANKS];

  assign chosen[0] = {PIXEL_BITS{1'b0}};
  assign out_last = chosen[BANKS][PIXEL_BITS-1];
  assign out_data[2*COORDINATE_BITS+3*COLOUR_BITS-1-:COORDINATE_BITS] =
      {{IDLE_Y_BITS{1'b0}}, chosen[BANKS][PIXEL_BITS-2-:Y_BITS]};
  assign out_data[COORDINATE_BITS+3*COLOUR_BITS-1-:COORDINATE_BITS] =
      {{IDLE_X_BITS{1'b0}}, chosen[BANKS][CHANNELS*COLOUR_BITS+:X_BITS]};
  assign out_data[3*COLOUR_BITS-1:0] = {3 / CHANNELS{chosen[BANKS][CHANNELS*COLOUR_BITS-1:0]}};

  genvar b;
  generate
    for (b = 0; b < BANKS; b = b + 1) begin : gen_bank
      localparam [SLOT_BITS-1:0] FIRST = BANK * b;

      (* ram_style = "distributed" *)
      reg [PLACE_BITS-1:0] places[0:BANK-1];
      (* ram_style = "distributed" *)
      reg [CHANNELS*COLOUR_BITS-1:0] colours[0:BANK-1];
      reg [PIXEL_BITS-1:0] pixel;
      reg here;  // the pixel at the output is from this bank

      always @(posedge clk) begin
        if (pixel_valid & (place_slot[SLOT_BITS-1:4] == FIRST[SLOT_BITS-1:4])) begin
          places[place_slot[3:0]] <= {pixel_last, pixel_y[Y_BITS-1:0], pixel_x[X_BITS-1:0]};
        end
        if (colour_valid & (colour_slot[SLOT_BITS-1:4] == FIRST[SLOT_BITS-1:4])) begin
          colours[colour_slot[3:0]] <= rgb[CHANNELS*COLOUR_BITS-1:0];
        end
        if (pop) begin
          pixel <= {places[read_slot[3:0]], colours[read_slot[3:0]]};
          here <= read_slot[SLOT_BITS-1:4] == FIRST[SLOT_BITS-1:4];
        end
      end

      assign chosen[b+1] = chosen[b] | (pixel & {PIXEL_BITS{here}});
    end
  endgenerate

endmodule

`default_nettype wire
