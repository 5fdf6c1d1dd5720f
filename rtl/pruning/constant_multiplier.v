// constant_multiplier: exact product of a word and a constant of the build, in logic: a tree of
// additions and subtractions of the shifted word, one for each digit of the constant that is not 0
// in canonical signed form (-1, 0, 1, never two digits side by side).
// Latency below: one clock a level of the tree, which has as few as the digits allow; what is left
// of LATENCY is waiting. One result a clock.
`default_nettype none

module constant_multiplier #(
    parameter BITS          = 18,
    parameter IS_SIGNED     = 1,   // the word; 1: two's complement, 0: unsigned
    parameter CONSTANT      = 1,   // 0 or more
    parameter CONSTANT_BITS = 18,  // at most 24
    parameter LATENCY       = 4    // as many as levels, or more
) (
    input  wire                          clk,
    input  wire [              BITS-1:0] word,
    output wire [BITS+CONSTANT_BITS-1:0] product
);

  // Adding twice a number to itself carries where ones are side by side: what differs are digits.
  localparam [31:0] ONCE = CONSTANT;
  localparam [31:0] THRICE = 3 * ONCE;
  localparam [31:0] DIGITS = (ONCE ^ THRICE) >> 1;
  localparam [31:0] MINUS = (ONCE & ~THRICE) >> 1;

  // How many digits there are, and the place of the k-th from the top.
  function integer count(input integer unused);
    integer p;
    begin
      count = 0;
      for (p = 0; p <= CONSTANT_BITS; p = p + 1) count = count + {31'b0, DIGITS[p]};
    end
  endfunction

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

  localparam COUNT = count(0);
  localparam LEVELS = COUNT > 2 ? $clog2(COUNT) : 1;
  localparam OUT_BITS = BITS + CONSTANT_BITS;
  localparam WIDE = OUT_BITS + 2;

  // Node i of level l is the sum over digits i << l and the 2^l - 1 after it, with the sign of the
  // first: its factor is positive, and below twice the first digit.
  wire [WIDE-1:0] node[0:(2<<LEVELS)-1];  // heap: level l starts at 2^(LEVELS-l)

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
        localparam FIRST = i << l;
        localparam SECOND = FIRST + (1 << (l - 1));
        localparam SUM_BITS = BITS + place(FIRST) + 2;
        localparam LEFT = (2 << (LEVELS - l)) + 2 * i;
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
