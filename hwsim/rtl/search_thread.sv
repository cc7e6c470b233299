// One search: its state, and its next step. It takes a step when it gets the unit that it needs, and
// continues when an answer comes.
module search_thread #(
    parameter int STACK_DEPTH = 64  // at most 64
) (
    input logic clk,
    input logic flush,

    input logic start,
    input device::query_t query,
    input logic release_thread,

    input logic [31:0] cycle,
    input logic [31:0] search_limit,  // cycles of a search
    input logic [26:0] memory_lines,

    // The units that it wants, and whether it gets them in this cycle.
    output logic wants_path, wants_gap, wants_cache, wants_stack, wants_memory,
    input logic gets_path, gets_gap, gets_cache, gets_stack, gets_memory,

    output logic asks_path,  // not if the search takes too long
    output device::path_question_t path_question,
    input logic path_answers,
    input device::path_answer_t path_answer,

    output device::gap_question_t gap_question,
    input logic gap_answers,
    input device::gap_answer_t gap_answer,

    // The line that it needs, from a cache or from the memory.
    output logic [26:0] line_address,
    output logic needs_node,
    output logic asks_cache,  // not if the address is beyond the memory
    input logic cache_answers,
    input logic cache_hit,
    input device::line_t cache_line,
    input logic memory_answers,
    input logic memory_is_intact,
    input device::line_t memory_line,
    input logic forget,  // a line was written
    input device::line_address_t forgotten,
    output logic is_stale,  // it was written after it was requested

    // Its part of the stacks.
    output logic [6:0] stack_size,
    output logic pushes,
    output device::pair_t pushed,
    input device::pair_t popped,

    output device::phase_t phase,
    output device::answer_t answer
);
  device::phase_t after_line;  // OPEN, TAKE_TOOL or TAKE_WORK: the purpose of reading a line
  device::division_t division;
  device::pair_t pair, half_0, half_1;
  device::path_t path;
  device::vector_t at_first, at_last, at_middle_0, at_middle_1;
  logic [4*device::RECORD_BITS-1:0] tools, works;  // of a line each
  logic [31:0] started, tool_epoch, work_epoch;
  logic [2:0] tool_line, work_line;    // of the leaves
  logic [1:0] tool_index, work_index;  // of the records in these lines
  logic [4:0] in_gap_unit;             // pairs of records
  logic next_half;
  logic [1:0] is_there, is_in_range;   // the halves

  assign wants_path = phase == device::DIVIDE || phase == device::MIDDLE;
  assign wants_gap = phase == device::TEST || phase == device::COMPARE;
  assign wants_cache = phase == device::OPEN || phase == device::TAKE_TOOL || phase == device::TAKE_WORK;
  assign wants_stack = phase == device::POP && stack_size != 0;
  assign wants_memory = phase == device::ASK;

  // --- The path unit: the pair as a whole, or the middle of its samples.

  logic is_whole;
  assign is_whole = phase == device::DIVIDE;
  assign asks_path = !(is_whole && cycle - started > search_limit);
  assign path_question = {
    path,
    is_whole ? pair.last : half_1.first,
    is_whole ? pair.first : half_0.last,
    pair.tool[31],
    pair.work[31],
    pair.tool_volume,
    pair.work_box
  };
  device::sample_t middle;
  assign middle = 13'((14'(pair.first) + 14'(pair.last)) >> 1);

  // --- The gap unit: a half, or the next pair of records.

  logic of_records;
  device::record_t tool_record, work_record;
  device::record_name_t tool_name, work_name;
  always_comb begin
    tool_record = tools[0+:device::RECORD_BITS];
    work_record = works[0+:device::RECORD_BITS];
    for (int i = 1; i < 4; i++) begin
      if (tool_index == 2'(i)) tool_record = tools[device::RECORD_BITS*i+:device::RECORD_BITS];
      if (work_index == 2'(i)) work_record = works[device::RECORD_BITS*i+:device::RECORD_BITS];
    end
  end
  assign tool_name = {pair.tool[25:0] + 26'(tool_line), tool_index};
  assign work_name = {pair.work[25:0] + 26'(work_line), work_index};
  device::vector_t offset_0, offset_1;
  assign of_records = phase == device::COMPARE;
  assign offset_0 = !of_records && division == device::WAY && next_half ? at_middle_1 : at_first;
  assign offset_1 = of_records ? at_first
                  : division == device::WAY && !next_half ? at_middle_0 : at_last;
  assign gap_question = {
    of_records,
    next_half,
    offset_1,
    offset_0,
    next_half ? half_1.tool_volume : half_0.tool_volume,
    next_half ? half_1.work_box : half_0.work_box,
    tool_record,
    work_record,
    tool_name,
    work_name
  };

  function automatic logic is_last_record(
      input device::reference_t leaf, input logic [2:0] line, input logic [1:0] index);
    is_last_record = index == 2'd3 || {line, index} == leaf[30:26];
  endfunction
  function automatic logic is_last_line(input device::reference_t leaf, input logic [2:0] line);
    is_last_line = line == leaf[30:28];
  endfunction
  logic ends_work_line, ends_tool_line;
  assign ends_work_line = is_last_record(pair.work, work_line, work_index);
  assign ends_tool_line = is_last_record(pair.tool, tool_line, tool_index);

  // Its answer about records
  logic records_answer, is_nearer;
  logic [4:0] in_gap_unit_next;
  assign records_answer = gap_answers && gap_answer.of_records;
  assign is_nearer = records_answer && {1'b0, gap_answer.squared} < answer.squared;
  assign in_gap_unit_next = in_gap_unit + 5'(gets_gap && of_records) - 5'(records_answer);

  // Its answer about a half; the last one decides how to go on.
  logic half_answers, ends_test;
  logic [49:0] squared_0, squared_1;
  logic [1:0] fits, goes_on;
  logic leaves_range, takes_second, is_full;
  assign half_answers = gap_answers && !gap_answer.of_records;
  assign ends_test = half_answers && (gap_answer.half || !is_there[1]);
  assign squared_0 = half_answers && !gap_answer.half ? gap_answer.squared : half_0.squared;
  assign squared_1 = half_answers && gap_answer.half ? gap_answer.squared : half_1.squared;
  assign fits[0] = half_answers && !gap_answer.half ? gap_answer.in_range : is_in_range[0];
  assign fits[1] = half_answers && gap_answer.half ? gap_answer.in_range : is_in_range[1];
  assign goes_on[0] = is_there[0] && {1'b0, squared_0} < answer.squared;
  assign goes_on[1] = is_there[1] && {1'b0, squared_1} < answer.squared;
  assign leaves_range = (is_there & ~fits) != 0;
  assign takes_second = goes_on[1] && (!goes_on[0] || squared_1 < squared_0);
  assign is_full = stack_size == 7'(STACK_DEPTH);

  device::pair_t tested_0, tested_1;
  always_comb begin
    tested_0 = half_0;
    tested_1 = half_1;
    tested_0.squared = squared_0;
    tested_1.squared = squared_1;
  end
  assign pushes = ends_test && !leaves_range && goes_on == 2'b11 && !is_full;
  assign pushed = takes_second ? tested_0 : tested_1;

  // --- The line that it needs.

  device::phase_t purpose;
  logic of_work;
  device::line_address_t from;
  assign purpose = wants_cache ? phase : after_line;
  assign needs_node = purpose == device::OPEN;
  assign of_work = needs_node ? division == device::WORK : purpose == device::TAKE_WORK;
  assign from = of_work ? pair.work[25:0] : pair.tool[25:0];
  assign line_address = 27'(from) + (needs_node ? 27'd0 : of_work ? 27'(work_line) : 27'(tool_line));
  assign asks_cache = line_address < memory_lines;

  logic has_line, is_too_new;
  device::node_line_t node;
  device::leaf_line_t leaf;
  assign has_line = (cache_answers && cache_hit) || (memory_answers && memory_is_intact);
  assign node = memory_answers ? memory_line : cache_line;
  assign leaf = memory_answers ? memory_line : cache_line;
  assign is_too_new = node.epoch > (of_work ? work_epoch : tool_epoch);

  device::pair_t child_pair_0, child_pair_1;
  logic [1:0] is_child_there;
  assign is_child_there = {node.child_1 != device::NO_REFERENCE, node.child_0 != device::NO_REFERENCE};
  always_comb begin
    child_pair_0 = pair;
    child_pair_1 = pair;
    if (of_work) begin
      child_pair_0.work = node.child_0;
      child_pair_1.work = node.child_1;
      child_pair_0.work_box = node.box_0;
      child_pair_1.work_box = node.box_1;
    end else begin
      child_pair_0.tool = node.child_0;
      child_pair_1.tool = node.child_1;
      child_pair_0.tool_volume = {node.radius_0, node.box_0};
      child_pair_1.tool_volume = {node.radius_1, node.box_1};
    end
  end

  // --- Steps

  // The reason to end the search without an answer, and the line at fault.
  device::stop_t fault;
  logic [26:0] fault_line;
  always_comb begin
    fault = device::NO_STOP;
    fault_line = '0;
    if (gets_path && !asks_path) fault = device::TOO_LONG;
    if (ends_test && leaves_range) fault = device::OUT_OF_RANGE;
    else if (ends_test && goes_on == 2'b11 && is_full) fault = device::STACK_OVERFLOW;
    if (gets_cache && !asks_cache) begin
      fault = device::BAD_ADDRESS;
      fault_line = line_address;
    end
    if (memory_answers && !memory_is_intact) begin
      fault = device::BAD_CHECK;
      fault_line = line_address;
    end
    if (has_line && is_too_new) begin
      fault = device::MODEL_CHANGED;
      fault_line = line_address;
    end
  end

  always_ff @(posedge clk) begin
    // Answers about records come while the thread goes on.
    in_gap_unit <= in_gap_unit_next;
    if (records_answer) answer.pair_tests <= answer.pair_tests + 1;
    if (is_nearer) begin
      answer.found <= 1'b1;
      answer.squared <= {1'b0, gap_answer.squared};
      answer.tool_record <= gap_answer.tool_name;
      answer.work_record <= gap_answer.work_name;
      answer.sample <= pair.first;
    end
    if (forget && phase == device::WAIT_LINE && line_address == {1'b0, forgotten}) is_stale <= 1'b1;

    case (phase)
      device::DIVIDE: if (gets_path) phase <= device::DIVIDING;
      device::DIVIDING:
        if (path_answers) begin
          at_first <= path_answer.offset_0;
          at_last <= path_answer.offset_1;
          division <= path_answer.division;
          case (path_answer.division)
            device::WAY: begin
              answer.splits <= answer.splits + 1;
              half_0 <= pair;
              half_1 <= pair;
              half_0.last <= middle;
              half_1.first <= middle + 13'd1;
              phase <= device::MIDDLE;
            end
            device::NONE: begin
              tool_line <= '0;
              work_line <= '0;
              tool_index <= '0;
              work_index <= '0;
              phase <= device::TAKE_TOOL;
            end
            default: phase <= device::OPEN;
          endcase
        end
      device::MIDDLE: if (gets_path) phase <= device::HALVING;
      device::HALVING:
        if (path_answers) begin
          at_middle_0 <= path_answer.offset_0;
          at_middle_1 <= path_answer.offset_1;
          is_there <= 2'b11;
          next_half <= 1'b0;
          phase <= device::TEST;
        end
      device::TEST:
        if (gets_gap) begin
          next_half <= 1'b1;
          if (next_half || !is_there[1]) phase <= device::TESTED;
        end
      device::POP:
        if (stack_size == 0) phase <= device::DONE;
        else if (gets_stack) phase <= device::POPPED;
      device::POPPED: begin
        stack_size <= stack_size - 7'd1;
        if ({1'b0, popped.squared} < answer.squared) begin
          pair <= popped;
          phase <= device::DIVIDE;
        end else phase <= device::POP;
      end
      device::OPEN, device::TAKE_TOOL, device::TAKE_WORK:
        if (gets_cache) begin
          after_line <= phase;
          phase <= device::LOOK;
        end
      device::LOOK: if (cache_answers && !cache_hit) phase <= device::ASK;
      device::ASK:
        if (gets_memory) begin
          is_stale <= 1'b0;
          phase <= device::WAIT_LINE;
        end
      device::COMPARE:
        if (gets_gap) begin
          work_index <= work_index + 2'd1;
          if (ends_work_line) begin
            work_index <= '0;
            tool_index <= tool_index + 2'd1;
            if (ends_tool_line) begin
              tool_index <= '0;
              work_line <= work_line + 3'd1;
              phase <= device::TAKE_WORK;
              if (is_last_line(pair.work, work_line)) begin
                work_line <= '0;
                tool_line <= tool_line + 3'd1;
                phase <= is_last_line(pair.tool, tool_line) ? device::DRAIN : device::TAKE_TOOL;
              end
            end
          end
        end
      device::DRAIN: if (records_answer && in_gap_unit_next == 0) phase <= device::POP;
      default: ;
    endcase

    if (has_line)
      case (after_line)
        device::OPEN: begin
          if (!is_too_new) answer.nodes <= answer.nodes + 1;
          half_0 <= child_pair_0;
          half_1 <= child_pair_1;
          is_there <= is_child_there;
          next_half <= !is_child_there[0];
          phase <= is_child_there == 0 ? device::POP : device::TEST;
        end
        device::TAKE_TOOL: begin
          tools <= leaf.records;
          phase <= device::TAKE_WORK;
        end
        default: begin
          works <= leaf.records;
          phase <= device::COMPARE;
        end
      endcase

    if (half_answers) begin
      half_0.squared <= squared_0;
      half_1.squared <= squared_1;
      is_in_range <= fits;
    end
    if (ends_test) begin
      // The second half does not count if the first one ended the search.
      answer.box_tests <= answer.box_tests + 32'(is_there[0])
                          + 32'(is_there[1] && (fits[0] || !is_there[0]));
      if (goes_on == 0) phase <= device::POP;
      else begin
        pair <= takes_second ? tested_1 : tested_0;
        phase <= device::DIVIDE;
      end
      if (pushes) begin
        stack_size <= stack_size + 7'd1;
        if (stack_size >= answer.deepest) answer.deepest <= stack_size + 7'd1;
      end
    end

    if (fault != device::NO_STOP) begin
      answer.stop <= fault;
      answer.at_line <= fault_line;
      phase <= device::DONE;
    end

    if (release_thread) phase <= device::IDLE;
    if (start) begin
      phase <= device::DIVIDE;
      started <= cycle;
      path <= query.path;
      tool_epoch <= query.tool_epoch;
      work_epoch <= query.work_epoch;
      stack_size <= '0;
      in_gap_unit <= '0;
      answer <= '0;
      answer.squared <= query.limit;
      pair <= '0;
      pair.tool <= {6'd0, query.tool_header};
      pair.work <= {6'd0, query.work_header};
      pair.tool_volume.box <= device::EVERYWHERE;
      pair.work_box <= device::EVERYWHERE;
      pair.last <= 13'd1 << query.path.log2_steps;
    end
    if (flush) phase <= device::IDLE;
  end
endmodule
