// Reads descriptors from a ring in the host's memory and carries them out in order: entries go into
// the FIFO of the permit unit, copied lines into the memory. The host answers reads in order.
module ring_unit #(
    parameter int QUEUE_DEPTH = 16,  // reads under way, and lines of the ring that wait
    parameter int WRITE_BITS = 5     // of the room in the queue of the memory
) (
    input logic clk,
    input logic reset,
    input logic flush,       // drops all orders
    input logic clear,       // skips all that the host has written
    input logic is_stopped,
    input logic restart,     // the watchdog

    input logic [63:0] cycle,  // the number of the coming edge
    input logic [57:0] base,   // of the ring, in lines
    input logic [4:0] log2_size,
    input logic [31:0] tail,   // lines that the host has written
    input logic [26:0] memory_lines,
    input logic [31:0] memory_limit,
    input logic has_room,      // in the FIFO, for one more entry than `entry`
    input logic [WRITE_BITS-1:0] memory_room,

    // The port to the host: it takes a read when it is ready, and answers later.
    output logic read,
    output logic [57:0] read_from,  // line
    input logic is_ready,
    input logic arrives,
    input logic [511:0] arriving_line,
    input logic is_missing,  // the host has no memory there; the line is 0

    output logic entry_valid,
    output device::entry_t entry,
    output logic fault_valid,
    output logic [3:0] fault,  // device::stop_t
    output logic fault_has_sequence,
    output logic [31:0] fault_sequence,
    output logic [31:0] fault_line,

    output logic has_copied,  // a line for the memory
    output device::line_address_t copied_to,
    output logic [511:0] copied,

    output logic [31:0] head,  // lines that are carried out or in progress
    output logic is_idle,
    output logic is_stalled,
    output logic [63:0] reads_done
);
  localparam int QUEUE_BITS = QUEUE_DEPTH > 1 ? $clog2(QUEUE_DEPTH) : 1;
  localparam int LEVEL_BITS = QUEUE_BITS + 1;
  typedef logic [QUEUE_BITS-1:0] place_t;
  typedef logic [LEVEL_BITS-1:0] level_t;
  function automatic place_t place_after(input place_t place);
    place_after = place == QUEUE_BITS'(QUEUE_DEPTH - 1) ? '0 : place + 1'b1;
  endfunction

  logic is_faulty;  // between a fault and the stop
  logic works;
  assign works = !flush && !is_stopped && !is_faulty;

  // --- The descriptor in progress

  logic is_model;
  logic [7:0] pairs;      // of a path, still to be given
  logic [26:0] to_copy;   // lines, still to be read
  logic [57:0] copy_from;
  device::line_address_t copy_to;
  device::entry_t common;  // what the entries of a path share, or the entry of a model
  device::line_t pair_line;
  logic [2:0] next_pair;  // its place in that line
  logic is_first_line;
  logic has_entry;
  assign has_entry = is_model || (pairs != 0 && next_pair < (is_first_line ? 3'd2 : 3'd5));

  // --- Reads under way. Those from before a stop are stale.

  logic [96:0] under_way[0:QUEUE_DEPTH-1];  // of a copy, cycle, line
  place_t way_first, way_end;
  level_t way_level, stale;
  logic arriving_is_copy, arriving_is_stale;
  logic [63:0] arriving_asked;
  logic [31:0] arriving_number;
  assign {arriving_is_copy, arriving_asked, arriving_number} = under_way[way_first];
  assign arriving_is_stale = stale != 0 || flush;

  logic [31:0] fetched, fetched_now, head_now, ahead;
  assign fetched_now = clear ? tail : fetched;
  assign head_now = clear ? tail : head;
  assign ahead = fetched_now - head_now;

  level_t copying;  // reads of copies under way
  logic [QUEUE_BITS+1:0] on_the_way;
  assign on_the_way = {1'b0, copying} + (QUEUE_BITS + 2)'(has_copied);

  logic wants_ring, wants_copy, reads;
  assign wants_ring = works && way_level != LEVEL_BITS'(QUEUE_DEPTH) && fetched_now != tail && ahead < QUEUE_DEPTH;
  assign wants_copy = works && way_level != LEVEL_BITS'(QUEUE_DEPTH) && !wants_ring && to_copy != 0
      && 32'(on_the_way) < 32'(memory_room);
  assign read = wants_ring || wants_copy;
  assign reads = read && is_ready;
  logic [31:0] in_ring;
  assign in_ring = fetched_now & ((32'd1 << log2_size) - 32'd1);
  assign read_from = wants_ring ? base + 58'(in_ring) : copy_from;

  // --- Lines of the ring, checked, that wait

  logic checked_valid, checked_is_missing, checked_is_intact;
  logic [63:0] checked_asked;
  logic [31:0] checked_number;
  device::line_t checked_line;
  check_unit #(.TAG_BITS(65)) check_unit (
      .clk, .flush(flush | reset),
      .in_valid(arrives && !arriving_is_copy && !arriving_is_stale), .in_tag({is_missing, arriving_asked}),
      .in_address(arriving_number), .in_line(arriving_line),
      .out_valid(checked_valid), .tag({checked_is_missing, checked_asked}), .address(checked_number),
      .line(checked_line), .is_intact(checked_is_intact));

  logic [577:0] waiting[0:QUEUE_DEPTH-1];
  place_t wait_first, wait_end;
  level_t wait_level;
  logic next_is_missing, next_is_intact;
  logic [63:0] next_asked;
  logic [31:0] next_number;
  device::line_t next_line;
  assign {next_is_missing, next_is_intact, next_asked, next_number, next_line} = waiting[wait_first];

  // --- The next line of the ring as a descriptor, and its fault

  function automatic logic is_coordinate(input logic [31:0] word);
    is_coordinate = word[31:23] == {9{word[23]}};
  endfunction
  function automatic logic [31:0] word_of(input device::line_t line, input int number);
    word_of = line[32*number+:32];
  endfunction

  logic is_path, orders_model, orders_copy, is_last, are_coordinates;
  logic [31:0] memory_end;
  assign is_path = next_line[7:0] == 8'd1 || next_line[7:0] == 8'd2;
  assign orders_model = next_line[7:0] == 8'd3;
  assign orders_copy = next_line[7:0] == 8'd4;
  assign is_last = next_line[31];
  assign memory_end = {5'd0, memory_lines};
  always_comb begin
    are_coordinates = 1'b1;
    for (int i = 2; i < 8; i++) are_coordinates &= is_coordinate(word_of(next_line, i));
  end

  logic takes_line, is_first;
  assign takes_line = works && !has_entry && to_copy == 0 && wait_level != 0;
  assign is_first = pairs == 0;

  logic [3:0] line_fault;  // device::stop_t
  logic line_has_sequence;
  logic [31:0] line_at_fault;
  always_comb begin
    line_fault = device::NO_STOP;
    line_has_sequence = 1'b0;
    line_at_fault = next_number;
    if (next_is_missing) line_fault = device::BAD_ADDRESS;
    else if (!next_is_intact) line_fault = device::BAD_DESCRIPTOR;
    else if (is_first) begin
      if (is_path) begin
        line_has_sequence = 1'b1;
        if (next_line[23:16] == 0) line_fault = device::BAD_DESCRIPTOR;
        else if (next_line[15:8] > 8'd12 || (is_last && next_line[1]) || !are_coordinates)
          line_fault = device::OUT_OF_RANGE;
      end else if (orders_model) begin
        if (word_of(next_line, 3) >= memory_end) begin
          line_fault = device::BAD_ADDRESS;
          line_at_fault = word_of(next_line, 3);
        end else if (is_last) begin
          line_fault = device::OUT_OF_RANGE;
          line_has_sequence = 1'b1;
        end
      end else if (orders_copy) begin
        if (next_line[101:96] != 0) line_fault = device::BAD_DESCRIPTOR;
        else if (word_of(next_line, 1) >= memory_end
                 || word_of(next_line, 2) > memory_end - word_of(next_line, 1)) begin
          line_fault = device::BAD_ADDRESS;
          line_at_fault = word_of(next_line, 1);
        end
      end else line_fault = device::BAD_DESCRIPTOR;
    end
    if (word_of(next_line, 1) == 0) line_has_sequence = 1'b0;
  end

  device::entry_t decoded;
  always_comb begin
    decoded = '0;
    decoded.sequence_number = word_of(next_line, 1);
    decoded.last = is_last;
    decoded.asked = next_asked;
    if (orders_model) begin
      decoded.kind = device::MODEL;
      decoded.work_slot = next_line[68:64];
      decoded.model_header = next_line[121:96];
      decoded.work_epoch = word_of(next_line, 4);
    end else begin
      decoded.kind = next_line[1] ? device::MEASURE : device::PERMIT;
      decoded.path = {next_line[247:224], next_line[215:192], next_line[183:160],
                      next_line[151:128], next_line[119:96], next_line[87:64], next_line[11:8]};
      decoded.is_timed = next_line[30];
      decoded.deadline = word_of(next_line, 8);
    end
  end

  // --- The next entry

  logic lost_copy, copied_is_missing, copied_is_stale;
  assign lost_copy = works && has_copied && copied_is_missing && !copied_is_stale;
  logic makes_entry, is_overrun, is_beyond;
  assign is_overrun = works && tail - head_now > (32'd1 << log2_size);
  assign makes_entry = works && !is_overrun && !lost_copy && has_entry && has_room;

  logic [95:0] pair_words;
  always_comb begin
    pair_words = '0;
    for (int i = 0; i < 5; i++)
      if (next_pair == 3'(i)) begin
        pair_words = pair_line[96*i+:96];
        if (is_first_line && i < 2) pair_words = pair_line[288+96*i+:96];
      end
  end
  device::entry_t next_entry;
  logic [63:0] lines_asked;
  always_comb begin
    next_entry = common;
    next_entry.lines = lines_asked;
    if (!is_model) begin
      next_entry.tool_slot = pair_words[4:0];
      next_entry.work_slot = pair_words[9:5];
      next_entry.threshold = pair_words[54:32];
      next_entry.work_epoch = pair_words[95:64];
      next_entry.last = common.last && pairs == 8'd1;
    end
  end
  assign is_beyond = makes_entry && !is_model && pair_words[63:55] != 0;

  // --- Faults

  logic takes_now, fails;
  assign takes_now = takes_line && !is_overrun && !lost_copy;
  assign fails = lost_copy || is_overrun || is_beyond || (takes_now && line_fault != device::NO_STOP);

  assign is_idle = head == tail && !is_model && pairs == 0 && to_copy == 0 && !entry_valid && !fault_valid;
  logic [31:0] waited, waited_now;
  assign waited_now = restart ? '0 : waited;
  assign is_stalled = waited_now > memory_limit;

  level_t way_level_next;
  assign way_level_next = way_level + LEVEL_BITS'(reads) - LEVEL_BITS'(arrives);

  always_ff @(posedge clk) begin
    // Reads and their answers
    way_level <= way_level_next;
    if (reads) begin
      under_way[way_end] <= {!wants_ring, cycle, wants_ring ? fetched_now : {6'd0, copy_to}};
      way_end <= place_after(way_end);
    end
    if (arrives) begin
      way_first <= place_after(way_first);
      reads_done <= reads_done + 64'd1;
    end
    if (flush) stale <= way_level_next;
    else if (arrives && stale != 0) stale <= stale - 1'b1;
    has_copied <= arrives && arriving_is_copy;
    copied_is_missing <= is_missing;
    copied_is_stale <= arriving_is_stale;
    copied_to <= arriving_number[25:0];
    copied <= arriving_line;
    copying <= copying + LEVEL_BITS'(reads && !wants_ring) - LEVEL_BITS'(arrives && arriving_is_copy);
    fetched <= fetched_now + 32'(reads && wants_ring);
    if (way_level == 0 || arrives) waited <= '0;
    else if (!is_stalled) waited <= waited_now + 32'd1;

    // Lines that wait
    if (checked_valid && !flush) begin
      waiting[wait_end] <= {checked_is_missing, checked_is_intact, checked_asked, checked_number, checked_line};
      wait_end <= place_after(wait_end);
    end
    wait_level <= wait_level + LEVEL_BITS'(checked_valid) - LEVEL_BITS'(takes_now);
    if (takes_now) wait_first <= place_after(wait_first);
    head <= head_now + 32'(takes_now);

    // The descriptor in progress
    if (reads && !wants_ring) begin
      copy_from <= copy_from + 58'd1;
      copy_to <= copy_to + 26'd1;
      to_copy <= to_copy - 27'd1;
      lines_asked <= lines_asked + 64'd1;
    end
    if (takes_now) begin
      pair_line <= next_line;
      next_pair <= '0;
      is_first_line <= is_first;
      if (is_first) begin
        common <= decoded;
        is_model <= orders_model;
        pairs <= is_path ? next_line[23:16] : '0;
        to_copy <= orders_copy ? next_line[90:64] : '0;
        copy_from <= {word_of(next_line, 4), next_line[127:102]};
        copy_to <= next_line[57:32];
      end
    end
    if (makes_entry) begin
      next_pair <= next_pair + 3'd1;
      is_model <= 1'b0;
      if (!is_model) pairs <= pairs - 8'd1;
    end
    entry <= next_entry;
    entry_valid <= makes_entry && !is_beyond;

    // A fault ends it.
    fault_valid <= fails;
    fault_has_sequence <= 1'b0;
    fault_sequence <= common.sequence_number;
    if (lost_copy) begin
      fault <= device::BAD_ADDRESS;
      fault_line <= {6'd0, copied_to};
    end else if (is_overrun) begin
      fault <= device::FIFO_OVERRUN;
      fault_line <= tail;
    end else if (is_beyond) begin
      fault <= device::OUT_OF_RANGE;
      fault_has_sequence <= common.sequence_number != 0;
      fault_line <= head_now - 32'd1;
    end else begin
      fault <= line_fault;
      fault_has_sequence <= line_has_sequence;
      fault_sequence <= word_of(next_line, 1);
      fault_line <= line_at_fault;
    end
    if (fails) is_faulty <= 1'b1;
    if (flush) is_faulty <= 1'b0;
    if (fails || flush || reset) begin
      is_model <= 1'b0;
      pairs <= '0;
      to_copy <= '0;
    end
    if (flush || reset) begin
      wait_level <= '0;
      wait_first <= '0;
      wait_end <= '0;
    end

    if (reset) begin
      {entry_valid, fault_valid, has_copied, is_faulty} <= '0;
      {way_level, way_first, way_end, stale, copying} <= '0;
      {fetched, head, waited} <= '0;
      {lines_asked, reads_done} <= '0;
    end
  end
endmodule
