// The port to the memory. Reads of the elements have priority; lines that are copied from the host
// are written when no read waits, or in turn with reads while their queue is full. The memory answers
// in order.
module memory_unit #(
    parameter int QUEUE_DEPTH = 64,       // reads that wait, and reads under way
    parameter int WRITE_QUEUE_DEPTH = 16,
    parameter int WRITE_BITS = 5          // of the room in that queue
) (
    input logic clk,
    input logic reset,
    input logic flush,    // answers to requests made so far are ignored
    input logic restart,  // the watchdog
    input logic [31:0] memory_limit,

    output logic accepts,
    input logic request,
    input logic [5:0] request_element,
    input logic [3:0] request_thread,
    input device::line_address_t request_address,

    output logic response,
    output logic [5:0] response_element,
    output logic [3:0] response_thread,
    output device::line_address_t response_address,
    output device::line_t response_line,
    output logic response_is_intact,

    output logic [WRITE_BITS-1:0] write_room,
    input logic write_valid,
    input device::line_address_t write_address,
    input logic [511:0] write_line,
    output logic has_written,
    output device::line_address_t written,

    // The memory: it takes a read or a write when it is ready.
    output logic reads,
    output logic writes,
    output device::line_address_t used_address,
    output logic [511:0] written_line,
    input logic is_ready,
    input logic arrives,
    input logic [511:0] arriving_line,

    output logic is_stalled,
    output logic [63:0] reads_done,
    output logic [63:0] writes_done
);
  // Requests: those under way, then those that wait.
  localparam int PLACES = 2 * QUEUE_DEPTH;
  localparam int PLACE_BITS = $clog2(PLACES);
  typedef logic [PLACE_BITS-1:0] place_t;
  localparam int LEVEL_BITS = PLACE_BITS + 1;
  typedef logic [LEVEL_BITS-1:0] level_t;
  logic [35:0] requests[0:PLACES-1];  // element, thread, address
  place_t first, next, last;
  level_t asked, under_way, stale;
  function automatic place_t place_after(input place_t place);
    place_after = place == PLACE_BITS'(PLACES - 1) ? '0 : place + 1'b1;
  endfunction
  assign accepts = asked != LEVEL_BITS'(QUEUE_DEPTH);

  localparam int WRITE_PLACE_BITS = WRITE_QUEUE_DEPTH > 1 ? $clog2(WRITE_QUEUE_DEPTH) : 1;
  typedef logic [WRITE_PLACE_BITS-1:0] write_place_t;
  logic [537:0] queue[0:WRITE_QUEUE_DEPTH-1];  // address, line
  write_place_t write_first, write_end;
  logic [WRITE_BITS-1:0] waiting;
  function automatic write_place_t write_place_after(input write_place_t place);
    write_place_after = place == WRITE_PLACE_BITS'(WRITE_QUEUE_DEPTH - 1) ? '0 : place + 1'b1;
  endfunction
  assign write_room = WRITE_BITS'(WRITE_QUEUE_DEPTH) - waiting;

  // --- The port

  logic can_read, write_was_last;
  device::line_address_t read_address, first_write_address;
  assign can_read = asked != 0 && under_way != LEVEL_BITS'(QUEUE_DEPTH);
  assign writes = waiting != 0
      && (!can_read || (waiting == WRITE_BITS'(WRITE_QUEUE_DEPTH) && !write_was_last));
  assign reads = can_read && !writes;
  assign read_address = requests[next][25:0];
  assign {first_write_address, written_line} = queue[write_first];
  assign used_address = writes ? first_write_address : read_address;
  logic has_read, is_written;
  assign has_read = reads && is_ready;
  assign is_written = writes && is_ready;

  // --- Answers

  device::line_address_t arriving_address;
  logic [9:0] arriving_tag;
  assign {arriving_tag, arriving_address} = requests[first];
  logic checked_valid;
  logic [31:0] checked_address;
  check_unit #(.TAG_BITS(10)) check_unit (
      .clk, .flush(flush | reset),
      .in_valid(arrives && stale == 0 && !flush), .in_tag(arriving_tag),
      .in_address({6'd0, arriving_address}), .in_line(arriving_line),
      .out_valid(checked_valid), .tag({response_element, response_thread}), .address(checked_address),
      .line(response_line), .is_intact(response_is_intact));
  assign response = checked_valid && !flush;
  assign response_address = checked_address[25:0];

  logic [31:0] waited, waited_now;
  logic is_due;
  assign is_due = asked != 0 || under_way != 0 || waiting != 0;
  assign waited_now = restart ? '0 : waited;
  assign is_stalled = waited_now > memory_limit;

  level_t asked_next, under_way_next;
  assign asked_next = asked + LEVEL_BITS'(request) - LEVEL_BITS'(has_read);
  assign under_way_next = under_way + LEVEL_BITS'(has_read) - LEVEL_BITS'(arrives);

  always_ff @(posedge clk) begin
    asked <= asked_next;
    under_way <= under_way_next;
    if (request) begin
      requests[last] <= {request_element, request_thread, request_address};
      last <= place_after(last);
    end
    if (has_read) next <= place_after(next);
    if (arrives) begin
      first <= place_after(first);
      reads_done <= reads_done + 64'd1;
    end
    if (flush) stale <= asked_next + under_way_next;
    else if (arrives && stale != 0) stale <= stale - 1'b1;

    if (write_valid) begin
      queue[write_end] <= {write_address, write_line};
      write_end <= write_place_after(write_end);
    end
    waiting <= waiting + WRITE_BITS'(write_valid) - WRITE_BITS'(is_written);
    if (is_written) begin
      write_first <= write_place_after(write_first);
      writes_done <= writes_done + 64'd1;
    end
    has_written <= is_written;
    written <= first_write_address;
    if (has_read || is_written) write_was_last <= is_written;

    if (!is_due || has_read || is_written || arrives) waited <= '0;
    else if (!is_stalled) waited <= waited_now + 32'd1;

    if (reset) begin
      {asked, under_way, stale, first, next, last} <= '0;
      {waiting, write_first, write_end} <= '0;
      {has_written, write_was_last} <= '0;
      {waited, reads_done, writes_done} <= '0;
    end
  end
endmodule
