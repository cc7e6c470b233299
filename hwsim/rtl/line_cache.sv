// A direct-mapped cache of lines whose check words were verified. Lines and tags are in memories
// that are read with a cycle of delay; what is read in the cycle of a write is the old content.
module line_cache #(
    parameter int LINES = 256  // a power of two, at least 2
) (
    input logic clk,
    input logic reset,

    input device::line_address_t look_address,
    output logic hit,                   // a cycle later
    output device::line_t line,

    input logic fill,
    input device::line_address_t fill_address,
    input device::line_t fill_line,

    // A line of the memory was written: its copy is dropped. Its tag is read in one cycle and
    // compared in the next. Fills use the same port of the tags: if one of the caches of the element
    // is filled, whatever is in the place of the written line is dropped.
    input logic forget,
    input device::line_address_t forgotten,
    input logic any_fill
);
  localparam int INDEX_BITS = $clog2(LINES);
  localparam int TAG_BITS = 26 - INDEX_BITS;
  typedef logic [INDEX_BITS-1:0] index_t;
  typedef logic [TAG_BITS-1:0] tag_t;

  function automatic index_t index_of(input device::line_address_t address);
    index_of = address[INDEX_BITS-1:0];
  endfunction
  function automatic tag_t tag_of(input device::line_address_t address);
    tag_of = address[25:INDEX_BITS];
  endfunction

  device::line_t lines[LINES];
  tag_t tags[LINES];
  logic [LINES-1:0] valid;

  tag_t read_tag, looked_tag, snooped_tag, forgotten_tag;
  index_t snooped_index;
  logic is_valid, is_snooped;
  always_ff @(posedge clk) begin
    line <= lines[index_of(look_address)];
    read_tag <= tags[index_of(look_address)];
    is_valid <= valid[index_of(look_address)];
    looked_tag <= tag_of(look_address);

    snooped_tag <= tags[index_of(forgotten)];
    is_snooped <= forget & ~any_fill & valid[index_of(forgotten)];
    forgotten_tag <= tag_of(forgotten);
    snooped_index <= index_of(forgotten);

    if (fill) begin
      lines[index_of(fill_address)] <= fill_line;
      tags[index_of(fill_address)] <= tag_of(fill_address);
      valid[index_of(fill_address)] <= 1'b1;
    end
    if (is_snooped && snooped_tag == forgotten_tag) valid[snooped_index] <= 1'b0;
    if (forget && any_fill) valid[index_of(forgotten)] <= 1'b0;
    if (reset) begin
      valid <= '0;
      is_snooped <= 1'b0;
    end
  end
  assign hit = is_valid && read_tag == looked_tag;
endmodule
