// The whole device: registers, ring unit, permit unit, elements, and the ports to both memories.
module coprocessor #(
    parameter int ELEMENTS = 8,           // at most 64
    parameter int THREADS = 4,            // of each, 2 to 16
    parameter int STACK_DEPTH = 64,       // at most 64
    parameter int NODE_LINES = 256,       // of the caches: powers of two
    parameter int RECORD_LINES = 256,
    parameter int FIFO_DEPTH = 32,
    parameter int MEMORY_QUEUE = 64,
    parameter int WRITE_QUEUE = 16,
    parameter int HOST_QUEUE = 16
) (
    input logic clk,

    // What the board decides.
    input logic [26:0] memory_lines,
    input logic [31:0] search_limit,  // cycles of a search
    input logic [31:0] memory_limit,  // cycles in which a memory may do nothing though it should

    // The bus of registers: a write takes effect at the coming edge.
    input logic bus_write,
    input logic bus_read,
    input logic [11:0] bus_address,
    input logic [31:0] bus_data,
    output logic [31:0] bus_answer,
    output logic irq,

    // The memory
    output logic memory_reads,
    output logic memory_writes,
    output logic [25:0] memory_address,
    output logic [511:0] memory_write_line,
    input logic memory_is_ready,
    input logic memory_arrives,
    input logic [511:0] memory_line,

    // The memory of the host
    output logic host_read,
    output logic [57:0] host_from,  // line
    input logic host_is_ready,
    input logic host_arrives,
    input logic [511:0] host_line,
    input logic host_is_missing
);
  localparam int WRITE_BITS = $clog2(WRITE_QUEUE + 1);

  logic reset, clear, restart, enable, host_is_silent;
  logic [63:0] cycle;
  logic [57:0] ring_base;
  logic [4:0] ring_log2_size;
  logic [31:0] ring_tail, ring_head;
  logic ring_is_idle, ring_is_stalled, memory_is_stalled;
  logic [63:0] lines_read, lines_written, host_lines;

  logic [5:0] first_element, start_element, release_element;
  logic [3:0] first_thread, start_thread, release_thread;
  logic start, release_valid, flush;
  device::query_t query;
  device::answer_t answer, found;
  logic [12:0] fifo_used, dispatched;
  logic [31:0] next_sequence, permit_sequence, retired, stop_sequence, stop_line, found_sequence;
  logic [3:0] stop;  // device::stop_t
  logic [63:0] missed, longest, least_slack;
  logic has_permitted, has_measured;
  device::search_totals_t totals;
  logic [ELEMENTS*THREADS-1:0] done, occupied;
  logic [ELEMENTS*device::ELEMENT_COUNTS_BITS-1:0] element_counts;

  register_file #(.ELEMENTS(ELEMENTS), .THREADS(THREADS), .FIFO_DEPTH(FIFO_DEPTH)) register_file (
      .clk, .bus_write, .bus_read, .bus_address, .bus_data, .bus_answer, .irq,
      .reset, .clear, .restart, .enable, .cycle, .host_is_silent,
      .ring_base, .ring_log2_size, .ring_tail,
      .memory_lines, .ring_head, .ring_is_idle, .fifo_used, .dispatched, .next_sequence,
      .permit_sequence, .retired, .stop, .stop_sequence, .stop_line, .found, .found_sequence,
      .has_permitted, .has_measured, .has_stopped(flush),
      .missed, .longest, .least_slack, .totals, .element_counts,
      .lines_read, .lines_written, .host_lines);

  // --- Orders

  logic entry_valid, fault_valid, fault_has_sequence, has_copied, has_room;
  device::entry_t entry;
  logic [3:0] fault;
  logic [31:0] fault_sequence, fault_line;
  device::line_address_t copied_to;
  logic [511:0] copied;
  logic [WRITE_BITS-1:0] write_room;
  assign has_room = 13'(FIFO_DEPTH) - fifo_used > 13'(entry_valid);
  ring_unit #(.QUEUE_DEPTH(HOST_QUEUE), .WRITE_BITS(WRITE_BITS)) ring_unit (
      .clk, .reset, .flush, .clear(clear && stop != device::NO_STOP),
      .is_stopped(stop != device::NO_STOP && !clear), .restart,
      .cycle, .base(ring_base), .log2_size(ring_log2_size), .tail(ring_tail),
      .memory_lines, .memory_limit, .has_room, .memory_room(write_room),
      .read(host_read), .read_from(host_from), .is_ready(host_is_ready),
      .arrives(host_arrives), .arriving_line(host_line), .is_missing(host_is_missing),
      .entry_valid, .entry, .fault_valid, .fault, .fault_has_sequence, .fault_sequence, .fault_line,
      .has_copied, .copied_to, .copied,
      .head(ring_head), .is_idle(ring_is_idle), .is_stalled(ring_is_stalled), .reads_done(host_lines));

  permit_unit #(.ELEMENTS(ELEMENTS), .THREADS(THREADS), .FIFO_DEPTH(FIFO_DEPTH)) permit_unit (
      .clk, .reset, .enable, .clear,
      .cycle, .host_is_silent, .memory_is_stalled(memory_is_stalled || ring_is_stalled), .lines_written,
      .entry_valid, .entry, .fault_valid, .fault, .fault_has_sequence, .fault_sequence, .fault_line,
      .done, .first_element, .first_thread, .answer,
      .start, .start_element, .start_thread, .query,
      .release_valid, .release_element, .release_thread, .flush,
      .fifo_used, .next_sequence, .dispatched, .permit_sequence, .retired,
      .stop, .stop_sequence, .stop_line, .found, .found_sequence,
      .missed, .longest, .least_slack, .has_permitted, .has_measured, .totals, .occupied);

  // --- The memory takes the requests of the elements in turn.

  logic accepts, request, response, response_is_intact, has_written;
  logic [5:0] next_request, request_element, response_element;
  logic [3:0] request_thread, response_thread;
  device::line_address_t request_address, response_address, written;
  device::line_t response_line;
  logic [ELEMENTS-1:0] requests;
  logic [4*ELEMENTS-1:0] request_threads;
  logic [26*ELEMENTS-1:0] request_addresses;
  always_comb begin
    request = 1'b0;
    request_element = '0;
    for (int i = ELEMENTS - 1; i >= 0; i--) begin
      logic [6:0] number;
      number = {1'b0, next_request} + 7'(i);
      if (number >= 7'(ELEMENTS)) number = number - 7'(ELEMENTS);
      for (int e = 0; e < ELEMENTS; e++)
        if (number == 7'(e) && requests[e] && accepts) begin
          request = 1'b1;
          request_element = 6'(e);
        end
    end
    request_thread = '0;
    request_address = '0;
    for (int e = 0; e < ELEMENTS; e++)
      if (request_element == 6'(e)) begin
        request_thread = request_threads[4*e+:4];
        request_address = request_addresses[26*e+:26];
      end
  end
  always_ff @(posedge clk) begin
    if (request) next_request <= request_element == 6'(ELEMENTS - 1) ? '0 : request_element + 6'd1;
    if (reset) next_request <= '0;
  end

  memory_unit #(.QUEUE_DEPTH(MEMORY_QUEUE), .WRITE_QUEUE_DEPTH(WRITE_QUEUE), .WRITE_BITS(WRITE_BITS))
      memory_unit (
      .clk, .reset, .flush, .restart, .memory_limit,
      .accepts, .request, .request_element, .request_thread, .request_address,
      .response, .response_element, .response_thread, .response_address, .response_line,
      .response_is_intact,
      .write_room, .write_valid(has_copied), .write_address(copied_to), .write_line(copied),
      .has_written, .written,
      .reads(memory_reads), .writes(memory_writes), .used_address(memory_address),
      .written_line(memory_write_line), .is_ready(memory_is_ready),
      .arrives(memory_arrives), .arriving_line(memory_line),
      .is_stalled(memory_is_stalled), .reads_done(lines_read), .writes_done(lines_written));

  // --- Elements

  logic [ELEMENTS*device::ANSWER_BITS-1:0] answers;
  always_comb begin
    answer = '0;
    for (int e = 0; e < ELEMENTS; e++)
      if (first_element == 6'(e)) answer = answers[e*device::ANSWER_BITS+:device::ANSWER_BITS];
  end
  for (genvar e = 0; e < ELEMENTS; e++) begin : elements
    logic [5*THREADS-1:0] phases;
    search_element #(.THREADS(THREADS), .STACK_DEPTH(STACK_DEPTH), .NODE_LINES(NODE_LINES),
                     .RECORD_LINES(RECORD_LINES)) element (
        .clk, .reset, .flush,
        .start(start && start_element == 6'(e)), .start_thread, .query,
        .release_valid(release_valid && release_element == 6'(e)), .release_thread,
        .cycle(cycle[31:0]), .search_limit, .memory_lines,
        .request(requests[e]), .request_thread(request_threads[4*e+:4]),
        .request_address(request_addresses[26*e+:26]),
        .granted(request && request_element == 6'(e)),
        .response(response && response_element == 6'(e)), .response_thread, .response_is_intact,
        .response_address, .response_line,
        .forget(has_written), .forgotten(written),
        .phases, .is_done(done[e*THREADS+:THREADS]), .answer_thread(first_thread),
        .answer(answers[e*device::ANSWER_BITS+:device::ANSWER_BITS]),
        .counts(element_counts[e*device::ELEMENT_COUNTS_BITS+:device::ELEMENT_COUNTS_BITS]));
  end
endmodule
