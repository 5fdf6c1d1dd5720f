// SPDX-License-Identifier: MIT
// constant_multiplier: exact product of a word and a constant of the build, in logic.
// The constant is recoded to canonical signed digits: digits -1, 0, 1 with no two neighbours both
// other than 0. A tree of adders and subtractors sums the shifted words of the digits other than 0.
// Latency: LATENCY cycles (a parameter): one per level of the tree, the rest is a delay line.
// Throughput: one result per cycle.
// Reset: none.
`default_nettype none

module constant_multiplier #(
    parameter BITS          = 18,  // width of the word
    parameter IS_SIGNED     = 1,   // the word; 1: two's complement, 0: unsigned
    parameter CONSTANT      = 1,   // 0 or more
    parameter CONSTANT_BITS = 18,  // width of CONSTANT, at most 24
    parameter LATENCY       = 4    // at least the levels of the tree
) (
    input  wire                          clk,
    input  wire [BITS-1:0]               word,    // format as IS_SIGNED says
    output wire [BITS+CONSTANT_BITS-1:0] product  // format as IS_SIGNED says
);

  // Recoding of the constant C: 2 C = 3 C - C, bit by bit, so digit p is bit p + 1 of 3 C minus bit
  // p + 1 of C. The digit is not 0 where these bits differ, and -1 where only C has the bit.
  localparam [31:0] ONCE = CONSTANT;
  localparam [31:0] THRICE = 3 * ONCE;
  localparam [31:0] DIGITS = (ONCE ^ THRICE) >> 1;
  localparam [31:0] MINUS = (ONCE & ~THRICE) >> 1;

  // Number of digits other than 0.
  function integer count(input integer unused);
    integer p;
    begin
      count = 0;
      for (p = 0; p <= CONSTANT_BITS; p = p + 1) count = count + {31'b0, DIGITS[p]};
    end
  endfunction

  // Position of the k-th digit other than 0, counted from the top, k from 0.
  function integer place(input integer k);
    integer p, seen;
    begin
      place = 0;
      seen  = 0;
      for (p = CONSTANT_BITS; p >= 0; p = p - 1) begin
        if (DIGITS[p]) begin
          if (seen == k) place = p;
          seen = seen + 1;
        end
      end
    end
  endfunction

  localparam COUNT = count(0);                        // digits other than 0
  localparam LEVELS = COUNT > 2 ? $clog2(COUNT) : 1;  // of the tree; one cycle each
  localparam OUT_BITS = BITS + CONSTANT_BITS;
  localparam WIDE = OUT_BITS + 2;                     // width of a node

  // Node i of level l sums the 2^l digits from number i << l on, all relative to the sign of the
  // first of them. Its factor is positive and less than twice the weight of that digit.
  wire [WIDE-1:0] node[0:(2<<LEVELS)-1];  // a heap: level l starts at 2^(LEVELS-l)

  genvar l, i;
  generate
    for (i = 0; i < (1 << LEVELS); i = i + 1) begin : gen_digit
      if (i < COUNT) begin : gen_shifted
        assign node[(1<<LEVELS)+i] =
            {{WIDE - BITS{(IS_SIGNED != 0) & word[BITS-1]}}, word} << place(i);
      end else begin : gen_none
        assign node[(1<<LEVELS)+i] = {WIDE{1'b0}};
      end
    end

    for (l = 1; l <= LEVELS; l = l + 1) begin : gen_level
      for (i = 0; i < (1 << (LEVELS - l)); i = i + 1) begin : gen_node
        localparam FIRST = i << l;                      // number of the left operand's first digit
        localparam SECOND = FIRST + (1 << (l - 1));     // of the right operand's
        localparam SUM_BITS = BITS + place(FIRST) + 2;
        localparam LEFT = (2 << (LEVELS - l)) + 2 * i;  // place in the heap
        localparam HERE = (1 << (LEVELS - l)) + i;

        if (FIRST < COUNT) begin : gen_sum
          reg [SUM_BITS-1:0] sum;

          if (SECOND >= COUNT) begin : gen_copy
            always @(posedge clk) sum <= node[LEFT][SUM_BITS-1:0];
          end else if (MINUS[place(FIRST)] == MINUS[place(SECOND)]) begin : gen_plus
            always @(posedge clk) sum <= node[LEFT][SUM_BITS-1:0] + node[LEFT+1][SUM_BITS-1:0];
          end else begin : gen_minus
            always @(posedge clk) sum <= node[LEFT][SUM_BITS-1:0] - node[LEFT+1][SUM_BITS-1:0];
          end

          if (WIDE > SUM_BITS) begin : gen_extended
            assign node[HERE] = {{WIDE - SUM_BITS{sum[SUM_BITS-1]}}, sum};
          end else begin : gen_whole
            assign node[HERE] = sum[WIDE-1:0];
          end
        end else begin : gen_nothing
          assign node[HERE] = {WIDE{1'b0}};
        end
      end
    end
  endgenerate

  delay #(
      .BITS  (OUT_BITS),
      .CYCLES(LATENCY - LEVELS)
  ) u_wait (
      .clk(clk),
      .in (node[1][OUT_BITS-1:0]),
      .out(product)
  );

  assign node[0] = {WIDE{1'b0}};

  wire unused = &{1'b0, word, node[0], node[1][WIDE-1:OUT_BITS]};

endmodule

`default_nettype wire
