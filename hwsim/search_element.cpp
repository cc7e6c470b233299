#include "hwsim/search_element.h"

#include <bit>

#include "hwsim/memory_line.h"
#include "hwsim/registers.h"
#include "hwsim/search.h"

namespace hwsim {

BoxUnit::Output box_question(uint8_t thread, const SplitPairs& halves, const Segment& segment) {
    BoxUnit::Output in{.valid = true, .thread = thread, .in_range = {true, true}};
    for (size_t i = 0; i < 2; ++i) {
        if (!halves.there[i]) continue;
        const auto gap = squared_gap(halves.pair[i], segment);
        in.in_range[i] = gap.has_value();
        in.squared[i] = gap.value_or(0);
    }
    return in;
}

void tick(BoxUnit& unit, const BoxUnit::Output& in) {
    // An empty stage keeps its old contents except `valid`.
    if (in.valid)
        unit.stage[unit.next] = in;
    else
        unit.stage[unit.next].valid = false;
    unit.next = unit.next + 1 == BoxUnit::latency ? 0 : unit.next + 1;
}

void tick(PairUnit& unit, const PairUnit::Output& in) {
    // An empty stage keeps its old contents except `valid`.
    if (in.valid)
        unit.stage[unit.next] = in;
    else
        unit.stage[unit.next].valid = false;
    unit.next = unit.next + 1 == PairUnit::latency ? 0 : unit.next + 1;
}

namespace {

/// The number of records in a line of a leaf.
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

/// After the last pair of two lines: the next line of the work, or of the tool, or none.
void next_lines(SearchThread& thread) {
    thread.tool_record_index = thread.work_record_index = 0;
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

bool needs_work(const SearchThread& thread) {
    return thread.phase == Phase::open ? thread.division == Division::work
                                       : thread.phase == Phase::take_work;
}

uint32_t requested_line(const SearchThread& thread) {
    const Reference& from = needs_work(thread) ? thread.pair.work : thread.pair.tool;
    if (thread.phase == Phase::open) return from.line();
    return from.line() + (needs_work(thread) ? thread.work_line : thread.tool_line);
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
        thread.halves = split_at_middle(thread.pair);
        thread.phase = Phase::test;
        return;
    case Division::none:
        break;
    }
    thread.offset = offset_at(thread.query.segment, thread.pair.first);
    thread.tool_line = thread.work_line = thread.tool_record_index = thread.work_record_index = 0;
    thread.phase = Phase::take_tool;
}

void accept_line(SearchThread& thread, const Line& line) {
    const bool of_work = needs_work(thread);
    const uint32_t epoch = of_work ? thread.query.work_epoch : thread.query.tool_epoch;
    if (epoch_of(line) > epoch) return stop(thread, Stop::model_changed, requested_line(thread));
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

void accept_tests(SearchThread& thread, const BoxUnit::Output& tests, uint32_t stack_depth) {
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
                              .tool_record = record_name(tool, thread.tool_record_index),
                              .work_record = record_name(work, thread.work_record_index),
                              .squared = squared_distance(thread.tools[thread.tool_record_index],
                                                          thread.offset,
                                                          thread.works[thread.work_record_index])};
    if (++thread.work_record_index == records_in_line(thread.pair.work, thread.work_line)) {
        thread.work_record_index = 0;
        if (++thread.tool_record_index == records_in_line(thread.pair.tool, thread.tool_line))
            next_lines(thread);
    }
    return in;
}

void accept_distance(SearchThread& thread, const PairUnit::Output& distance) {
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

namespace {

/// Units already used in this cycle.
struct Ports {
    bool nodes = false, records = false;
    BoxUnit::Output box;
    PairUnit::Output pair;
};

constexpr uint32_t bit(uint32_t thread) { return 1U << thread; }

/// std::popcount for 16 bits; the standard one calls a library function without -mpopcnt.
constexpr uint32_t count_of(uint32_t set) {
    set = set - ((set >> 1) & 0x5555U);
    set = (set & 0x3333U) + ((set >> 2) & 0x3333U);
    set = (set + (set >> 4)) & 0x0F0FU;
    return (set + (set >> 8)) & 0x1FU;
}

/// Updates the sets of threads by phase for this thread.
void sort_in(SearchElement& e, uint32_t number) {
    const Phase phase = e.threads[number].phase;
    const bool is_waiting = phase == Phase::wait, is_done = phase == Phase::done;
    const bool is_acting = phase != Phase::idle && !is_done && !is_waiting && phase != Phase::tested
                           && phase != Phase::drain;
    e.acting = is_acting ? e.acting | bit(number) : e.acting & ~bit(number);
    e.done = is_done ? e.done | bit(number) : e.done & ~bit(number);
    e.waiting = is_waiting ? e.waiting | bit(number) : e.waiting & ~bit(number);
}

/// Reads from a cache, or makes the thread request the line from memory.
void read_line(SearchElement& e, const DeviceConfig& config, SearchThread& thread, Ports& ports) {
    const bool is_node = thread.phase == Phase::open;
    bool& taken = is_node ? ports.nodes : ports.records;
    if (taken) {
        ++e.counts.wait_port;
        return;
    }
    taken = true;
    const uint32_t address = requested_line(thread);
    if (address >= config.memory_lines) return stop(thread, Stop::bad_address, address);
    const Line* line = cached_line(is_node ? e.nodes : e.records, address);
    if (line) {
        ++(is_node ? e.counts.node_hits : e.counts.record_hits);
        return accept_line(thread, *line);
    }
    ++(is_node ? e.counts.node_misses : e.counts.record_misses);
    thread.after_line = thread.phase;
    thread.phase = Phase::ask;
}

void ask_memory(SearchElement& e, const ElementInput& in, uint8_t number) {
    SearchThread& thread = e.threads[number];
    if (e.request.valid) {
        ++e.counts.wait_port;
        return;
    }
    thread.phase = thread.after_line;
    e.request = {true, in.number, number, in.run, requested_line(thread)};
    thread.phase = Phase::wait;
}

void act(SearchElement& e, const DeviceConfig& config, const ElementInput& in, uint8_t number,
         Ports& ports) {
    SearchThread& thread = e.threads[number];
    switch (thread.phase) {
    case Phase::divide:
        divide(thread, in.cycle, config.search_limit);
        break;
    case Phase::open:
    case Phase::take_tool:
    case Phase::take_work:
        read_line(e, config, thread, ports);
        break;
    case Phase::ask:
        ask_memory(e, in, number);
        break;
    case Phase::pop:
        pop(thread);
        break;
    case Phase::test:
        if (ports.box.valid) {
            ++e.counts.wait_port;
            break;
        }
        ports.box = box_question(number, thread.halves, thread.query.segment);
        thread.phase = Phase::tested;
        break;
    case Phase::compare:
        if (ports.pair.valid)
            ++e.counts.wait_port;
        else
            ports.pair = next_records(thread, number);
        break;
    default:
        break;
    }
    sort_in(e, number);
}

void take_response(SearchElement& e, const ElementInput& in) {
    const ReadRequest& request = in.response->request;
    if (request.run != in.run) return;
    SearchThread& thread = e.threads[request.thread];
    thread.phase = thread.after_line;
    if (!is_intact(in.response->line, request.address)) {
        stop(thread, Stop::bad_check, request.address);
    } else {
        const bool is_node = thread.phase == Phase::open;
        fill(is_node ? e.nodes : e.records, request.address, in.response->line);
        accept_line(thread, in.response->line);
    }
    sort_in(e, request.thread);
}

void take_results(SearchElement& e, const DeviceConfig& config) {
    if (const BoxUnit::Output& tests = e.box.output(); tests.valid) {
        accept_tests(e.threads[tests.thread], tests, config.stack_depth);
        sort_in(e, tests.thread);
    }
    if (const PairUnit::Output& distance = e.pair.output(); distance.valid) {
        accept_distance(e.threads[distance.thread], distance);
        sort_in(e, distance.thread);
    }
}

} // namespace

SearchElement search_element(const DeviceConfig& config) {
    SearchElement e;
    e.threads.resize(config.threads);
    e.nodes.entries.resize(config.node_cache_lines);
    e.records.entries.resize(config.record_cache_lines);
    return e;
}

void tick(SearchElement& e, const DeviceConfig& config, const ElementInput& in) {
    if (e.busy != 0) {
        ++e.counts.busy;
        e.counts.wait_retire += count_of(e.done);
        e.counts.wait_memory += count_of(e.waiting);
        // Threads that become ready in this cycle act in the next.
        const uint32_t acting = e.acting;
        if (in.granted) e.request.valid = false;
        if (in.response) take_response(e, in);
        take_results(e, config);
        Ports ports;
        // The threads from `first` on, then those before it.
        const uint32_t before = bit(e.first) - 1;
        for (uint32_t set : {acting & ~before, acting & before})
            for (; set != 0; set &= set - 1)
                act(e, config, in, static_cast<uint8_t>(std::countr_zero(set)), ports);
        tick(e.box, ports.box);
        tick(e.pair, ports.pair);
    }
    e.first = e.first + 1U == config.threads ? 0 : static_cast<uint8_t>(e.first + 1);
    if (in.forget) {
        invalidate(e.nodes, in.forgotten);
        invalidate(e.records, in.forgotten);
    }
}

std::optional<uint8_t> idle_thread(const SearchElement& element) {
    const auto number = static_cast<size_t>(std::countr_one(element.busy));
    if (number >= element.threads.size()) return {};
    return static_cast<uint8_t>(number);
}

void begin(SearchElement& element, uint8_t thread, const Query& query, uint64_t cycle) {
    start(element.threads[thread], query, cycle);
    element.busy |= bit(thread);
    sort_in(element, thread);
}

void release(SearchElement& element, uint8_t thread) {
    element.threads[thread].phase = Phase::idle;
    element.busy &= ~bit(thread);
    sort_in(element, thread);
}

void flush(SearchElement& element) {
    for (SearchThread& thread : element.threads) thread.phase = Phase::idle;
    element.acting = element.busy = element.waiting = element.done = 0;
    element.request.valid = false;
    element.box = {};
    element.pair = {};
}

} // namespace hwsim
