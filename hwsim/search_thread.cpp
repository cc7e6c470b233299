#include "hwsim/search_thread.h"

#include "hwsim/pair_distance.h"
#include "hwsim/search.h"

namespace hwsim {
namespace {

/// How many records a line of a leaf holds.
uint32_t records_in_line(const Reference& leaf, uint32_t line) {
    return std::min(records_per_line, leaf.count() - line * records_per_line);
}

bool push(SearchThread& thread, const SearchPair& pair, uint32_t stack_depth) {
    if (thread.stack_size == stack_depth) {
        stop(thread, Stop::stack_overflow, 0);
        return false;
    }
    thread.stack[thread.stack_size++] = pair;
    thread.answer.counts.deepest =
        std::max<uint32_t>(thread.answer.counts.deepest, thread.stack_size);
    return true;
}

/// Behind the last pair of two lines: the next line of the work, or of the tool, or none.
void next_lines(SearchThread& thread) {
    thread.tool_place = thread.work_place = 0;
    if (++thread.work_line < leaf_lines(thread.pair.work.count())) {
        thread.phase = Phase::take_work;
        return;
    }
    thread.work_line = 0;
    ++thread.tool_line;
    const bool is_last = thread.tool_line == leaf_lines(thread.pair.tool.count());
    thread.phase = is_last ? Phase::drain : Phase::take_tool;
}

} // namespace

void start(SearchThread& thread, const Query& query, uint64_t cycle) {
    thread.phase = Phase::divide;
    thread.stack_size = 0;
    thread.in_pair_unit = 0;
    thread.started = cycle;
    thread.query = query;
    thread.answer = {.squared = query.limit};
    thread.pair = first_pair(query);
}

void stop(SearchThread& thread, Stop reason, uint32_t line) {
    thread.answer.stop = reason;
    thread.answer.at_line = line;
    thread.phase = Phase::done;
}

bool wants_work(const SearchThread& thread) {
    return thread.phase == Phase::open ? thread.division == Division::work
                                       : thread.phase == Phase::take_work;
}

uint32_t wanted_line(const SearchThread& thread) {
    const Reference& from = wants_work(thread) ? thread.pair.work : thread.pair.tool;
    if (thread.phase == Phase::open) return from.line();
    return from.line() + (wants_work(thread) ? thread.work_line : thread.tool_line);
}

void divide(SearchThread& thread, uint64_t cycle, uint32_t search_limit) {
    if (cycle - thread.started > search_limit) return stop(thread, Stop::too_long, 0);
    thread.division = division_of(thread.pair, thread.query.segment);
    switch (thread.division) {
    case Division::tool:
    case Division::work:
        thread.phase = Phase::open;
        return;
    case Division::way:
        ++thread.answer.counts.splits;
        thread.halves = halves_of_way(thread.pair);
        thread.phase = Phase::test;
        return;
    case Division::none:
        break;
    }
    thread.offset = offset_at(thread.query.segment, thread.pair.first);
    thread.tool_line = thread.work_line = thread.tool_place = thread.work_place = 0;
    thread.phase = Phase::take_tool;
}

void take_line(SearchThread& thread, const Line& line) {
    const bool of_work = wants_work(thread);
    const uint32_t epoch = of_work ? thread.query.work_epoch : thread.query.tool_epoch;
    if (epoch_of(line) > epoch) return stop(thread, Stop::model_changed, wanted_line(thread));
    switch (thread.phase) {
    case Phase::open:
        ++thread.answer.counts.nodes;
        thread.halves = halves_of_node(thread.pair, thread.division, node_in(line));
        thread.phase = Phase::test;
        return;
    case Phase::take_tool:
        thread.tools = records_in(line);
        thread.phase = Phase::take_work;
        return;
    default:
        thread.works = records_in(line);
        thread.phase = Phase::compare;
    }
}

void take_tests(SearchThread& thread, const BoxUnit::Output& tests, uint32_t stack_depth) {
    std::array<bool, 2> goes_on{};
    for (size_t i = 0; i < 2; ++i) {
        if (!thread.halves.there[i]) continue;
        ++thread.answer.counts.box_tests;
        if (!tests.in_range[i]) return stop(thread, Stop::out_of_range, 0);
        thread.halves.pair[i].squared = tests.squared[i];
        goes_on[i] = tests.squared[i] < thread.answer.squared;
    }
    if (!goes_on[0] && !goes_on[1]) {
        thread.phase = Phase::pop;
        return;
    }
    const bool second = goes_on[1] && (!goes_on[0] || tests.squared[1] < tests.squared[0]);
    if (goes_on[0] && goes_on[1] && !push(thread, thread.halves.pair[second ? 0 : 1], stack_depth))
        return;
    thread.pair = thread.halves.pair[second ? 1 : 0];
    thread.phase = Phase::divide;
}

void pop(SearchThread& thread) {
    if (thread.stack_size == 0) {
        thread.phase = Phase::done;
        return;
    }
    const SearchPair& pair = thread.stack[--thread.stack_size];
    if (pair.squared >= thread.answer.squared) return;
    thread.pair = pair;
    thread.phase = Phase::divide;
}

PairUnit::Output next_records(SearchThread& thread, uint8_t number) {
    const uint32_t tool = thread.pair.tool.line() + thread.tool_line;
    const uint32_t work = thread.pair.work.line() + thread.work_line;
    ++thread.in_pair_unit;
    const PairUnit::Output in{.valid = true,
                              .thread = number,
                              .tool_record = record_name(tool, thread.tool_place),
                              .work_record = record_name(work, thread.work_place),
                              .squared =
                                  squared_distance(thread.tools[thread.tool_place], thread.offset,
                                                   thread.works[thread.work_place])};
    if (++thread.work_place == records_in_line(thread.pair.work, thread.work_line)) {
        thread.work_place = 0;
        if (++thread.tool_place == records_in_line(thread.pair.tool, thread.tool_line))
            next_lines(thread);
    }
    return in;
}

void take_distance(SearchThread& thread, const PairUnit::Output& distance) {
    --thread.in_pair_unit;
    ++thread.answer.counts.pair_tests;
    if (distance.squared < thread.answer.squared) {
        thread.answer.found = true;
        thread.answer.squared = distance.squared;
        thread.answer.tool_record = distance.tool_record;
        thread.answer.work_record = distance.work_record;
        thread.answer.sample = thread.pair.first;
    }
    if (thread.phase == Phase::drain && thread.in_pair_unit == 0) thread.phase = Phase::pop;
}

} // namespace hwsim
