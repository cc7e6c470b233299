// A processing element: threads that share a path unit, a gap unit, two caches, a memory for their
// stacks, and one request to the main memory. Each unit takes the first thread that wants it, in an
// order that rotates with every cycle.
module search_element #(
    parameter int THREADS = 4,      // 2 to 16
    parameter int STACK_DEPTH = 64,
    parameter int NODE_LINES = 256,
    parameter int RECORD_LINES = 256
) (
    input logic clk,
    input logic reset,
    input logic flush,  // drops all searches and requests; the caches stay

    input logic start,
    input logic [3:0] start_thread,
    input device::query_t query,
    input logic release_valid,
    input logic [3:0] release_thread,

    input logic [31:0] cycle,
    input logic [31:0] search_limit,
    input logic [26:0] memory_lines,

    output logic request,  // held until it is granted
    output logic [3:0] request_thread,
    output device::line_address_t request_address,
    input logic granted,

    // The line of a request that was made since the last flush.
    input logic response,
    input logic [3:0] response_thread,
    input logic response_is_intact,
    input device::line_address_t response_address,
    input device::line_t response_line,

    input logic forget,  // a line of the memory was written
    input device::line_address_t forgotten,

    output logic [5*THREADS-1:0] phases,
    output logic [THREADS-1:0] is_done,
    input logic [3:0] answer_thread,
    output device::answer_t answer,
    output device::element_counts_t counts
);
  typedef logic [THREADS-1:0] threads_t;

  // The first thread of a set, from `first` on, then those before it.
  logic [3:0] first;
  function automatic threads_t first_of(input threads_t set, input logic [3:0] from);
    threads_t later, candidates;
    later = set & ({THREADS{1'b1}} << from);
    candidates = later != 0 ? later : set;
    first_of = candidates & (~candidates + 1'b1);
  endfunction
  always_ff @(posedge clk) first <= reset || first == 4'(THREADS - 1) ? '0 : first + 4'd1;

  threads_t wants_path, wants_gap, wants_cache, wants_stack, wants_memory;
  threads_t gets_path, gets_gap, gets_cache, gets_stack, gets_memory;
  assign gets_path = first_of(wants_path, first);
  assign gets_gap = first_of(wants_gap, first);
  assign gets_cache = first_of(wants_cache, first);
  assign gets_stack = first_of(wants_stack, first);
  assign gets_memory = !request || granted ? first_of(wants_memory, first) : '0;

  // The questions of the threads that get a unit, and who they are.
  threads_t asks_path, asks_cache, needs_node, is_stale, pushes;
  logic [THREADS*device::PATH_QUESTION_BITS-1:0] path_questions;
  logic [THREADS*device::GAP_QUESTION_BITS-1:0] gap_questions;
  logic [THREADS*27-1:0] line_addresses;
  logic [THREADS*7-1:0] stack_sizes;
  logic [THREADS*device::PAIR_BITS-1:0] pushed_pairs;
  logic [THREADS*device::ANSWER_BITS-1:0] answers;

  device::path_question_t path_question;
  device::gap_question_t gap_question;
  device::pair_t pushed;
  device::line_address_t look_address, ask_address;
  logic [3:0] path_thread, gap_thread, look_thread, stack_thread, ask_thread, push_thread;
  logic [5:0] pop_place, push_place;
  logic looks;
  always_comb begin
    path_question = '0;
    gap_question = '0;
    pushed = '0;
    look_address = '0;
    ask_address = '0;
    {path_thread, gap_thread, look_thread, stack_thread, ask_thread, push_thread} = '0;
    {pop_place, push_place} = '0;
    for (int i = 0; i < THREADS; i++) begin
      if (gets_path[i]) begin
        path_question |= path_questions[i*device::PATH_QUESTION_BITS+:device::PATH_QUESTION_BITS];
        path_thread |= 4'(i);
      end
      if (gets_gap[i]) begin
        gap_question |= gap_questions[i*device::GAP_QUESTION_BITS+:device::GAP_QUESTION_BITS];
        gap_thread |= 4'(i);
      end
      if (gets_cache[i]) begin
        look_address |= line_addresses[27*i+:26];
        look_thread |= 4'(i);
      end
      if (gets_memory[i]) begin
        ask_address |= line_addresses[27*i+:26];
        ask_thread |= 4'(i);
      end
      if (gets_stack[i]) begin
        pop_place |= stack_sizes[7*i+:6] - 6'd1;
        stack_thread |= 4'(i);
      end
      if (pushes[i]) begin
        pushed |= pushed_pairs[i*device::PAIR_BITS+:device::PAIR_BITS];
        push_place |= stack_sizes[7*i+:6];
        push_thread |= 4'(i);
      end
    end
    looks = (gets_cache & asks_cache) != 0;
    answer = '0;
    for (int i = 0; i < THREADS; i++)
      if (answer_thread == 4'(i)) answer = answers[i*device::ANSWER_BITS+:device::ANSWER_BITS];
  end

  // --- Units

  logic path_answers, gap_answers;
  logic [3:0] path_answer_thread, gap_answer_thread;
  device::path_answer_t path_answer;
  device::gap_answer_t gap_answer;
  path_unit #(.THREAD_BITS(4)) path_unit (
      .clk, .flush(flush | reset),
      .in_valid((gets_path & asks_path) != 0), .in_thread(path_thread), .question(path_question),
      .out_valid(path_answers), .out_thread(path_answer_thread), .answer(path_answer));
  gap_unit #(.THREAD_BITS(4)) gap_unit (
      .clk, .flush(flush | reset),
      .in_valid(gets_gap != 0), .in_thread(gap_thread), .question(gap_question),
      .out_valid(gap_answers), .out_thread(gap_answer_thread), .answer(gap_answer));

  // --- Stacks

  localparam int THREAD_BITS = $clog2(THREADS);
  logic [device::PAIR_BITS-1:0] stacks[64*2**THREAD_BITS];
  device::pair_t popped;
  always_ff @(posedge clk) begin
    popped <= stacks[{stack_thread[THREAD_BITS-1:0], pop_place}];
    if (pushes != 0) stacks[{push_thread[THREAD_BITS-1:0], push_place}] <= pushed;
  end

  // --- Caches. A line that was written while it was read is not kept.

  logic response_is_node, fills, node_hit, record_hit, is_looked, is_looked_node;
  logic [3:0] looked_thread;
  device::line_t node_line, record_line;
  always_comb begin
    response_is_node = 1'b0;
    fills = 1'b0;
    for (int i = 0; i < THREADS; i++)
      if (response && response_thread == 4'(i)) begin
        response_is_node = needs_node[i];
        fills = response_is_intact && !is_stale[i];
      end
  end
  always_ff @(posedge clk) begin
    is_looked <= looks && !flush && !reset;
    is_looked_node <= (gets_cache & needs_node) != 0;
    looked_thread <= look_thread;
  end
  line_cache #(.LINES(NODE_LINES)) nodes (
      .clk, .reset, .look_address, .hit(node_hit), .line(node_line),
      .fill(fills && response_is_node), .fill_address(response_address), .fill_line(response_line),
      .forget, .forgotten, .any_fill(fills));
  line_cache #(.LINES(RECORD_LINES)) records (
      .clk, .reset, .look_address, .hit(record_hit), .line(record_line),
      .fill(fills && !response_is_node), .fill_address(response_address), .fill_line(response_line),
      .forget, .forgotten, .any_fill(fills));

  // --- The request to the memory

  always_ff @(posedge clk) begin
    if (granted) request <= 1'b0;
    if (gets_memory != 0) begin
      request <= 1'b1;
      request_thread <= ask_thread;
      request_address <= ask_address;
    end
    if (flush || reset) request <= 1'b0;
  end

  // --- Counters

  function automatic logic [4:0] count_of(input threads_t set);
    count_of = '0;
    for (int i = 0; i < THREADS; i++) count_of = count_of + 5'(set[i]);
  endfunction
  threads_t is_busy, is_waiting;
  logic [6:0] without_port;
  assign without_port = 7'(count_of(wants_path & ~gets_path)) + 7'(count_of(wants_gap & ~gets_gap))
      + 7'(count_of(wants_cache & ~gets_cache)) + 7'(count_of(wants_stack & ~gets_stack))
      + 7'(count_of(wants_memory & ~gets_memory));
  always_ff @(posedge clk) begin
    counts.busy <= counts.busy + 64'(is_busy != 0);
    counts.node_hits <= counts.node_hits + 64'(is_looked && is_looked_node && node_hit);
    counts.node_misses <= counts.node_misses + 64'(is_looked && is_looked_node && !node_hit);
    counts.record_hits <= counts.record_hits + 64'(is_looked && !is_looked_node && record_hit);
    counts.record_misses <= counts.record_misses + 64'(is_looked && !is_looked_node && !record_hit);
    counts.wait_memory <= counts.wait_memory + 64'(count_of(is_waiting));
    counts.wait_port <= counts.wait_port + 64'(without_port);
    counts.wait_retire <= counts.wait_retire + 64'(count_of(is_done));
    if (reset) counts <= '0;
  end

  // --- Threads

  for (genvar i = 0; i < THREADS; i++) begin : threads
    device::phase_t phase;
    search_thread #(.STACK_DEPTH(STACK_DEPTH)) thread (
        .clk, .flush(flush | reset),
        .start(start && start_thread == 4'(i)), .query,
        .release_thread(release_valid && release_thread == 4'(i)),
        .cycle, .search_limit, .memory_lines,
        .wants_path(wants_path[i]), .wants_gap(wants_gap[i]), .wants_cache(wants_cache[i]),
        .wants_stack(wants_stack[i]), .wants_memory(wants_memory[i]),
        .gets_path(gets_path[i]), .gets_gap(gets_gap[i]), .gets_cache(gets_cache[i]),
        .gets_stack(gets_stack[i]), .gets_memory(gets_memory[i]),
        .asks_path(asks_path[i]),
        .path_question(path_questions[i*device::PATH_QUESTION_BITS+:device::PATH_QUESTION_BITS]),
        .path_answers(path_answers && path_answer_thread == 4'(i)), .path_answer,
        .gap_question(gap_questions[i*device::GAP_QUESTION_BITS+:device::GAP_QUESTION_BITS]),
        .gap_answers(gap_answers && gap_answer_thread == 4'(i)), .gap_answer,
        .line_address(line_addresses[27*i+:27]), .needs_node(needs_node[i]),
        .asks_cache(asks_cache[i]),
        .cache_answers(is_looked && looked_thread == 4'(i)),
        .cache_hit(is_looked_node ? node_hit : record_hit),
        .cache_line(is_looked_node ? node_line : record_line),
        .memory_answers(response && response_thread == 4'(i)),
        .memory_is_intact(response_is_intact), .memory_line(response_line),
        .forget, .forgotten, .is_stale(is_stale[i]),
        .stack_size(stack_sizes[7*i+:7]), .pushes(pushes[i]),
        .pushed(pushed_pairs[i*device::PAIR_BITS+:device::PAIR_BITS]), .popped,
        .phase, .answer(answers[i*device::ANSWER_BITS+:device::ANSWER_BITS]));
    assign phases[5*i+:5] = phase;
    assign is_done[i] = phase == device::DONE;
    assign is_busy[i] = phase != device::IDLE;
    assign is_waiting[i] = phase == device::WAIT_LINE;
  end
endmodule
