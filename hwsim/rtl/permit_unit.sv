// Takes entries in turn, gives their searches to threads, and permits segments in order. It stops at
// the first refusal or fault, and then permits nothing until it is cleared.
module permit_unit #(
    parameter int ELEMENTS = 8,
    parameter int THREADS = 4,  // of each element
    parameter int FIFO_DEPTH = 32
) (
    input logic clk,
    input logic reset,
    input logic enable,  // otherwise nothing is dispatched or permitted
    input logic clear,   // ends a stop

    input logic [63:0] cycle,  // the number of the coming edge
    input logic host_is_silent,
    input logic memory_is_stalled,
    input logic [63:0] lines_written,

    // From the ring unit.
    input logic entry_valid,
    input device::entry_t entry,
    input logic fault_valid,
    input logic [3:0] fault,  // device::stop_t
    input logic fault_has_sequence,
    input logic [31:0] fault_sequence,
    input logic [31:0] fault_line,

    // Of all threads: whether they have an answer; and that of the thread which searches the first
    // entry.
    input logic [ELEMENTS*THREADS-1:0] done,
    output logic [5:0] first_element,
    output logic [3:0] first_thread,
    input device::answer_t answer,

    output logic start,
    output logic [5:0] start_element,
    output logic [3:0] start_thread,
    output device::query_t query,
    output logic release_valid,
    output logic [5:0] release_element,
    output logic [3:0] release_thread,
    output logic flush,  // drops all searches

    output logic [12:0] fifo_used,
    output logic [31:0] next_sequence,
    output logic [12:0] dispatched,
    output logic [31:0] permit_sequence,
    output logic [31:0] retired,
    output logic [3:0] stop,  // device::stop_t
    output logic [31:0] stop_sequence,
    output logic [31:0] stop_line,
    output device::answer_t found,
    output logic [31:0] found_sequence,
    output logic [63:0] missed,
    output logic [63:0] longest,
    output logic [63:0] least_slack,
    output logic has_permitted,  // at the last edge
    output logic has_measured,
    output device::search_totals_t totals,
    output logic [ELEMENTS*THREADS-1:0] occupied
);
  localparam int ALL_THREADS = ELEMENTS * THREADS;
  localparam int QUEUE_DEPTH = ALL_THREADS + FIFO_DEPTH;
  localparam int THREAD_BITS = ALL_THREADS > 1 ? $clog2(ALL_THREADS) : 1;
  localparam int FIFO_BITS = FIFO_DEPTH > 1 ? $clog2(FIFO_DEPTH) : 1;
  localparam int QUEUE_BITS = $clog2(QUEUE_DEPTH);

  // The number of a thread among all.
  function automatic logic [THREAD_BITS-1:0] number_of(input logic [5:0] element, input logic [3:0] thread);
    number_of = THREAD_BITS'(10'(element) * 10'(THREADS) + 10'(thread));
  endfunction

  // Entries that wait, and those that are dispatched, with the source of their answers.
  typedef struct packed {
    logic [63:0] asked;
    logic [31:0] deadline;
    logic is_timed, last;
    logic [1:0] kind;  // device::kind_t
    logic [31:0] sequence_number;
    logic [3:0] fault;  // device::stop_t, unless it is searched
    logic is_searched;
    logic [3:0] thread;
    logic [5:0] element;
  } dispatched_t;
  localparam int DISPATCHED_BITS = 147;

  logic [device::ENTRY_BITS-1:0] fifo[0:FIFO_DEPTH-1];
  logic [DISPATCHED_BITS-1:0] queue[0:QUEUE_DEPTH-1];
  logic [11:0] fifo_first, fifo_end;
  logic [12:0] queue_first, queue_end;
  device::entry_t waiting;
  dispatched_t first;
  assign waiting = fifo[fifo_first[FIFO_BITS-1:0]];
  assign first = queue[queue_first[QUEUE_BITS-1:0]];
  assign first_element = first.element;
  assign first_thread = first.thread;

  // Slots of models.
  logic [31:0] has_model;
  logic [57:0] slots[0:31];  // epoch, header
  logic [57:0] tool_model, work_model;
  assign tool_model = slots[waiting.tool_slot];
  assign work_model = slots[waiting.work_slot];

  // What CLEAR leaves.
  logic is_cleared;
  logic [3:0] stop_now;  // device::stop_t
  logic [31:0] next_sequence_now, has_model_now;
  assign is_cleared = clear && stop != device::NO_STOP;
  assign stop_now = clear ? device::NO_STOP : stop;
  assign next_sequence_now = is_cleared ? permit_sequence + 32'd1 : next_sequence;
  assign has_model_now = is_cleared ? '0 : has_model;

  // A thread is free once its element has seen the release.
  logic [ALL_THREADS-1:0] occupied_now;
  always_comb begin
    occupied_now = occupied;
    if (release_valid)
      occupied_now[number_of(release_element, release_thread)] = 1'b0;
  end

  // The first entry retires when its answer is there.
  logic has_answer, retires, is_searched_answer, permits, measures;
  logic [3:0] answer_stop, retire_stop;  // device::stop_t
  always_comb begin
    has_answer = !first.is_searched
        || done[number_of(first.element, first.thread)];
    retires = enable && dispatched != 0 && has_answer;
    is_searched_answer = first.is_searched && answer.found;
    answer_stop = first.is_searched ? answer.stop : first.fault;
    measures = retires && answer_stop == device::NO_STOP && first.kind == device::MEASURE;
    retire_stop = device::NO_STOP;
    if (retires && answer_stop != device::NO_STOP) retire_stop = answer_stop;
    else if (retires && first.kind == device::PERMIT && is_searched_answer) retire_stop = device::VIOLATION;
    permits = retires && retire_stop == device::NO_STOP && first.kind == device::PERMIT && first.last;
  end
  logic [31:0] permitted_now;
  assign permitted_now = permits ? first.sequence_number : permit_sequence;

  // The next entry is dispatched: a model into its slot, a search to the first free thread of the
  // first element that has one, from `next_element` on.
  logic [5:0] next_element, chosen_element;
  logic [3:0] chosen_thread;
  logic has_thread;
  always_comb begin
    has_thread = 1'b0;
    chosen_element = '0;
    chosen_thread = '0;
    for (int i = ELEMENTS - 1; i >= 0; i--)
      for (int t = THREADS - 1; t >= 0; t--) begin
        logic [6:0] number;
        number = {1'b0, next_element} + 7'(i);
        if (number >= 7'(ELEMENTS)) number = number - 7'(ELEMENTS);
        if (!occupied_now[number_of(number[5:0], 4'(t))]) begin
          has_thread = 1'b1;
          chosen_element = number[5:0];
          chosen_thread = 4'(t);
        end
      end
  end

  logic is_dispatched, is_search, has_room;
  logic [3:0] model_fault;  // device::stop_t
  dispatched_t next_dispatched;
  always_comb begin
    if (!has_model_now[waiting.tool_slot] || !has_model_now[waiting.work_slot])
      model_fault = device::MODEL_MISSING;
    else if (work_model[57:26] != waiting.work_epoch) model_fault = device::MODEL_CHANGED;
    else model_fault = device::NO_STOP;
    has_room = dispatched != 13'(QUEUE_DEPTH) || retires;
    is_search = waiting.kind != device::MODEL && model_fault == device::NO_STOP;
    is_dispatched = stop_now == device::NO_STOP && retire_stop == device::NO_STOP && enable && fifo_used != 0 && has_room;
    if (waiting.kind == device::MODEL && lines_written < waiting.lines) is_dispatched = 1'b0;
    if (is_search && !has_thread) is_dispatched = 1'b0;
    next_dispatched = {waiting.asked, waiting.deadline, waiting.is_timed, waiting.last, waiting.kind,
        waiting.sequence_number, device::NO_STOP, is_search, chosen_thread, chosen_element};
    if (waiting.kind != device::MODEL && !is_search) next_dispatched.fault = model_fault;
  end

  // A new entry goes into the FIFO, or stops the device if it is not the next. Outputs of the ring
  // unit from before a stop come together with `flush`.
  logic is_taken, is_out_of_turn, is_faulty, has_watchdog_stop;
  assign is_taken = entry_valid && !flush && stop_now == device::NO_STOP && retire_stop == device::NO_STOP;
  assign is_out_of_turn = is_taken
      && (entry.sequence_number != next_sequence_now || next_sequence_now == 0);
  assign is_faulty = fault_valid && !flush && stop_now == device::NO_STOP && retire_stop == device::NO_STOP && !is_out_of_turn;
  assign has_watchdog_stop = enable && stop_now == device::NO_STOP && (host_is_silent || memory_is_stalled);

  logic [3:0] reason;  // device::stop_t
  logic [31:0] reason_sequence, reason_line;
  always_comb begin
    reason = device::NO_STOP;
    reason_sequence = permitted_now + 32'd1;
    reason_line = '0;
    if (retire_stop != device::NO_STOP) begin
      reason = retire_stop;
      reason_sequence = first.sequence_number;
      if (first.is_searched) reason_line = {5'd0, answer.at_line};
    end else if (is_out_of_turn) begin
      reason = device::SEQUENCE;
      reason_sequence = entry.sequence_number;
    end else if (is_faulty) begin
      reason = fault;
      if (fault_has_sequence) reason_sequence = fault_sequence;
      reason_line = fault_line;
    end else if (has_watchdog_stop) reason = host_is_silent ? device::HOST_SILENT : device::MEMORY_STALLED;
  end

  // A measurement without a threshold has no limit.
  logic [50:0] limit;
  search_limit limit_of_waiting (
      .threshold(waiting.threshold), .is_measured(waiting.kind == device::MEASURE), .limit);

  logic [63:0] taken, slack;
  logic [31:0] cycles_left;
  assign taken = cycle - first.asked;
  assign cycles_left = first.deadline - cycle[31:0];
  assign slack = {{32{cycles_left[31]}}, cycles_left};

  always_ff @(posedge clk) begin
    flush <= 1'b0;
    start <= 1'b0;
    release_valid <= 1'b0;
    if (is_taken && !is_out_of_turn) fifo[fifo_end[FIFO_BITS-1:0]] <= entry;
    if (is_dispatched) queue[queue_end[QUEUE_BITS-1:0]] <= next_dispatched;
    if (is_dispatched && waiting.kind == device::MODEL)
      slots[waiting.work_slot] <= {waiting.work_epoch, waiting.model_header};
    start_element <= chosen_element;
    start_thread <= chosen_thread;
    query <= {limit, work_model[57:26], tool_model[57:26], work_model[25:0], tool_model[25:0], waiting.path};
    release_element <= first.element;
    release_thread <= first.thread;

    has_model <= has_model_now;
    if (is_dispatched && waiting.kind == device::MODEL) has_model[waiting.work_slot] <= 1'b1;
    next_sequence <= next_sequence_now;
    if (is_taken && !is_out_of_turn && entry.last) next_sequence <= next_sequence_now + 32'd1;
    if (is_cleared) begin
      stop <= device::NO_STOP;
      stop_sequence <= '0;
      stop_line <= '0;
    end

    if (retires && answer_stop == device::NO_STOP) begin
      retired <= retired + 32'd1;
      if (measures || retire_stop == device::VIOLATION) begin
        found <= answer;
        found_sequence <= first.sequence_number;
      end
    end
    if (permits) begin
      permit_sequence <= first.sequence_number;
      if (taken > longest) longest <= taken;
      if (first.is_timed) begin
        if ($signed(slack) < $signed(least_slack)) least_slack <= slack;
        if (slack[63]) missed <= missed + 64'd1;
      end
    end

    has_permitted <= permits;
    has_measured <= measures;
    if (retires && first.kind != device::MODEL) totals.queries <= totals.queries + 64'd1;
    if (retires && first.is_searched) begin
      totals.nodes <= totals.nodes + 64'(answer.nodes);
      totals.splits <= totals.splits + 64'(answer.splits);
      totals.box_tests <= totals.box_tests + 64'(answer.box_tests);
      totals.pair_tests <= totals.pair_tests + 64'(answer.pair_tests);
      if (answer.deepest > totals.deepest) totals.deepest <= answer.deepest;
    end

    if (reason != device::NO_STOP) begin
      stop <= reason;
      stop_sequence <= reason_sequence;
      stop_line <= reason_line;
      flush <= 1'b1;
      occupied <= '0;
      fifo_used <= '0;
      dispatched <= '0;
    end else begin
      occupied <= occupied_now;
      if (is_dispatched && is_search)
        occupied[number_of(chosen_element, chosen_thread)] <= 1'b1;
      start <= is_dispatched && is_search;
      release_valid <= retires && first.is_searched;
      fifo_used <= fifo_used + 13'(is_taken) - 13'(is_dispatched);
      dispatched <= dispatched + 13'(is_dispatched) - 13'(retires);
    end
    if (is_dispatched && is_search)
      next_element <= chosen_element == 6'(ELEMENTS - 1) ? '0 : chosen_element + 6'd1;
    if (is_taken && !is_out_of_turn) fifo_end <= fifo_end == 12'(FIFO_DEPTH - 1) ? '0 : fifo_end + 12'd1;
    if (is_dispatched) begin
      fifo_first <= fifo_first == 12'(FIFO_DEPTH - 1) ? '0 : fifo_first + 12'd1;
      queue_end <= queue_end == 13'(QUEUE_DEPTH - 1) ? '0 : queue_end + 13'd1;
    end
    if (retires) queue_first <= queue_first == 13'(QUEUE_DEPTH - 1) ? '0 : queue_first + 13'd1;
    if (reason != device::NO_STOP) begin
      fifo_first <= '0;
      fifo_end <= '0;
      queue_first <= '0;
      queue_end <= '0;
    end

    if (reset) begin
      flush <= 1'b0;
      start <= 1'b0;
      release_valid <= 1'b0;
      fifo_used <= '0;
      dispatched <= '0;
      fifo_first <= '0;
      fifo_end <= '0;
      queue_first <= '0;
      queue_end <= '0;
      occupied <= '0;
      next_element <= '0;
      has_model <= '0;
      next_sequence <= 32'd1;
      permit_sequence <= '0;
      retired <= '0;
      stop <= device::NO_STOP;
      stop_sequence <= '0;
      stop_line <= '0;
      found <= '0;
      found_sequence <= '0;
      missed <= '0;
      longest <= '0;
      least_slack <= {1'b0, {63{1'b1}}};
      has_permitted <= 1'b0;
      has_measured <= 1'b0;
      totals <= '0;
    end
  end

`ifdef PROOF
`include "permit_proof.sv"
`endif
endmodule

// The least squared distance that is permitted, in the cycle in which it is asked for.
module search_limit (
    input logic [22:0] threshold,
    input logic is_measured,
    output logic [50:0] limit
);
  logic [23:0] kept;
  assign kept = {1'b0, threshold} + 24'd3;
  assign limit = is_measured && threshold == 0 ? 51'd1 << 50 : 51'(48'(kept) * 48'(kept));
endmodule
