// Compares a line with its check word, four words in each of four stages.
module check_unit #(
    parameter int TAG_BITS = 8
) (
    input logic clk,
    input logic flush,

    input logic in_valid,
    input logic [TAG_BITS-1:0] in_tag,  // whose line it is
    input logic [31:0] in_address,
    input logic [511:0] in_line,

    output logic out_valid,
    output logic [TAG_BITS-1:0] tag,
    output logic [31:0] address,
    output device::line_t line,
    output logic is_intact
);
  localparam int STAGES = 4;

  // CRC-32, reversed: the lowest bit comes first. The first 32 bits meet the bits of the check word of what
  // came before, so a bit of the result is the parity of some bits of both: a tree, not a chain of 128 steps.
  function automatic logic [4095:0] parity_masks();
    logic [31:0] effect;  // of bit i on the result
    effect = 32'hEDB8_8320;
    for (int i = 127; i >= 0; i--) begin
      for (int k = 0; k < 32; k++) parity_masks[128*k+i] = effect[k];
      effect = {1'b0, effect[31:1]} ^ (effect[0] ? 32'hEDB8_8320 : 32'd0);
    end
  endfunction
  localparam logic [4095:0] PARITY_MASKS = parity_masks();

  function automatic logic [31:0] checked_on(input logic [31:0] check, input logic [127:0] bits);
    for (int k = 0; k < 32; k++) checked_on[k] = ^(PARITY_MASKS[128*k+:128] & (bits ^ {96'd0, check}));
  endfunction

  logic [STAGES:1] valid;
  logic [TAG_BITS-1:0] tags[1:STAGES];
  logic [31:0] addresses[1:STAGES];
  logic [511:0] lines[1:STAGES];
  logic [31:0] check[1:STAGES-1];
  always_ff @(posedge clk) begin
    valid <= flush ? '0 : {valid[STAGES-1:1], in_valid};
    tags[1] <= in_tag;
    addresses[1] <= in_address;
    lines[1] <= in_line;
    for (int i = 2; i <= STAGES; i++) begin
      tags[i] <= tags[i-1];
      addresses[i] <= addresses[i-1];
      lines[i] <= lines[i-1];
    end
    // The address and words 0 to 2, 3 to 6, 7 to 10, 11 to 14.
    check[1] <= checked_on('1, {in_line[95:0], in_address});
    check[2] <= checked_on(check[1], lines[1][223:96]);
    check[3] <= checked_on(check[2], lines[2][351:224]);
    is_intact <= lines[3][511:480] == ~checked_on(check[3], lines[3][479:352]);
  end
  assign out_valid = valid[STAGES];
  assign tag = tags[STAGES];
  assign address = addresses[STAGES];
  assign line = lines[STAGES][479:0];
endmodule
