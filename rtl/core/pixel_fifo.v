// SPDX-License-Identifier: MIT
// pixel_fifo: FIFO at the end of the pipeline. It holds finished pixels under back-pressure, so
// that no stall reaches the datapath.
// A pixel that leaves the interpolators gets a slot. Its place in the picture is written at once,
// its colour LATENCY cycles later, so only a valid bit travels beside the datapath. Credits count
// the free slots; there are enough slots for full throughput.
// Latency: LATENCY cycles from place to colour (PHONG_PIXEL_LATENCY in latency.vh; 74 by default),
// then 2 cycles to the output.
// Throughput: one pixel per cycle.
// Reset: synchronous; drops all pixels. The contents of the slots are not reset.
`default_nettype none
`include "phong_config.vh"
`include "latency.vh"

module pixel_fifo #(
    parameter COORDINATE_BITS = `PHONG_COORDINATE_BITS,
    parameter COLOUR_BITS     = `PHONG_COLOUR_BITS,
    parameter CHANNELS        = `PHONG_CHANNELS,     // 3: red, green, blue; 1: grey
    parameter IDLE_X_BITS     = `PHONG_IDLE_X_BITS,  // top bits of x that are always 0
    parameter IDLE_Y_BITS     = `PHONG_IDLE_Y_BITS,  // the same of y
    parameter LATENCY         = `PHONG_PIXEL_LATENCY
) (
    input wire clk,
    input wire reset,  // synchronous

    // a pixel leaves the interpolators
    output reg                        credit,       // 1: a pixel may leave in this cycle
    input  wire                       pixel_valid,  // 1: a pixel leaves; only with credit
    input  wire [COORDINATE_BITS-1:0] pixel_x,      // pixels
    input  wire [COORDINATE_BITS-1:0] pixel_y,      // pixels
    input  wire                       pixel_last,   // the pixel is the last of the frame

    // its colour, LATENCY cycles later
    input wire [COLOUR_BITS-1:0] red,    // code, 0 to 255
    input wire [COLOUR_BITS-1:0] green,  // code, 0 to 255
    input wire [COLOUR_BITS-1:0] blue,   // code, 0 to 255

    // finished pixels, in order; taken in a cycle in which out_valid and out_ready are 1
    output reg                                        out_valid,
    input  wire                                       out_ready,
    output wire [2*COORDINATE_BITS+3*COLOUR_BITS-1:0] out_data,  // {y, x, red, green, blue}
    output wire                                       out_last   // last pixel of the frame
);

  // Slots for full throughput: a slot is occupied for LATENCY cycles, plus 1 to write the colour, 1
  // to read the slot and 1 to return the credit. One more, since the credit of the last free slot
  // may come late (see below).
  localparam SLOTS_NEEDED = LATENCY + 4;
  localparam BANK = 16;                                        // words of a small RAM
  localparam BANKS = (SLOTS_NEEDED + BANK - 1) / BANK;
  localparam SLOTS = BANK * BANKS;
  localparam SLOT_BITS = 4 + (BANKS > 1 ? $clog2(BANKS) : 1);  // {bank, word in it}
  localparam [SLOT_BITS-1:0] LAST_SLOT = SLOTS[SLOT_BITS-1:0] - 1'b1;
  localparam COUNT_BITS = $clog2(SLOTS + 1);
  localparam [COUNT_BITS-1:0] ALL = SLOTS;                     // every slot is free

  reg [SLOT_BITS-1:0] place_slot;   // of the next pixel that enters
  reg [SLOT_BITS-1:0] colour_slot;  // of the next colour
  reg [SLOT_BITS-1:0] read_slot;    // of the next pixel to the output
  reg [COUNT_BITS-1:0] credits;     // free slots
  reg [COUNT_BITS-1:0] filled;      // slots with a colour, not yet read
  reg some;                         // filled is not 0

  // ---- the valid bits of the pipeline ----
  reg [LATENCY-1:0] in_flight;
  wire colour_valid = in_flight[LATENCY-1];

  always @(posedge clk) begin
    if (reset) in_flight <= {LATENCY{1'b0}};
    else in_flight <= {in_flight[LATENCY-2:0], pixel_valid};
  end

  // ---- slots ----
  // `pop` starts the longest paths, so `some` and `credit` are computed one cycle ahead, from bits
  // of the counts and not from the sums. While one slot is free, `credit` waits for the next pop;
  // that way it does not depend on the pixel that enters now.
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

  // ---- banks of slots, in logic cells, because a block RAM would be nearly empty ----
  // Each bank reads into its own register; the bank is selected behind these registers.
  localparam X_BITS = COORDINATE_BITS - IDLE_X_BITS;
  localparam Y_BITS = COORDINATE_BITS - IDLE_Y_BITS;
  localparam PLACE_BITS = 1 + Y_BITS + X_BITS;  // {last, y, x}
  localparam PIXEL_BITS = PLACE_BITS + CHANNELS * COLOUR_BITS;

  wire [3*COLOUR_BITS-1:0] rgb = {red, green, blue};  // one channel: blue is stored
  wire unused = &{1'b0, rgb};
  wire [PIXEL_BITS-1:0] chosen[0:BANKS];              // [b]: from banks 0 to b - 1

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
      localparam [SLOT_BITS-1:0] FIRST = BANK * b;  // first slot of the bank

      (* ram_style = "distributed" *)
      reg [PLACE_BITS-1:0] places[0:BANK-1];
      (* ram_style = "distributed" *)
      reg [CHANNELS*COLOUR_BITS-1:0] colours[0:BANK-1];
      reg [PIXEL_BITS-1:0] pixel;
      reg here;  // the pixel at the output is in this bank

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
