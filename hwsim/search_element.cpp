#include "hwsim/search_element.h"

#include <bit>

#include "hwsim/memory_line.h"
#include "hwsim/registers.h"
#include "hwsim/search.h"

namespace hwsim {
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

/// Begins the tests of the halves, or drops the pair if there are none.
void test_halves(SearchThread& thread) {
    thread.next_half = thread.halves.there[0] ? 0 : 1;
    const bool is_empty = !thread.halves.there[0] && !thread.halves.there[1];
    thread.phase = is_empty ? Phase::pop : Phase::test;
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

bool is_last_half(const SearchThread& thread, uint8_t half) {
    return half == 1 || !thread.halves.there[1];
}

GapAnswer test_of_half(SearchThread& thread, uint8_t number, Volumes volumes) {
    const uint8_t half = thread.next_half;
    const SearchPair& pair = thread.halves.pair[half];
    std::array<FixedVec, 2> at = thread.offset;
    if (thread.division == Division::way) at[1 - half] = thread.middle[half];
    const auto gap = squared_gap(pair, at[0], at[1], volumes);
    thread.next_half = 1;
    if (is_last_half(thread, half)) thread.phase = Phase::tested;
    return {.valid = true,
            .thread = number,
            .half = half,
            .in_range = gap.has_value(),
            .squared = gap.value_or(0)};
}

GapAnswer next_records(SearchThread& thread, uint8_t number) {
    const uint32_t tool = thread.pair.tool.line() + thread.tool_line;
    const uint32_t work = thread.pair.work.line() + thread.work_line;
    ++thread.in_gap_unit;
    const GapAnswer question{.valid = true,
                             .thread = number,
                             .of_records = true,
                             .tool_record = record_name(tool, thread.tool_record_index),
                             .work_record = record_name(work, thread.work_record_index),
                             .squared = squared_distance(thread.tools[thread.tool_record_index],
                                                         thread.offset[0],
                                                         thread.works[thread.work_record_index])};
    if (++thread.work_record_index == records_in_line(thread.pair.work, thread.work_line)) {
        thread.work_record_index = 0;
        if (++thread.tool_record_index == records_in_line(thread.pair.tool, thread.tool_line))
            next_lines(thread);
    }
    return question;
}

/// Both halves are tested: the nearer one is next, the other one waits on the stack.
void choose_half(SearchThread& thread, uint32_t stack_depth) {
    const SplitPairs& halves = thread.halves;
    std::array<bool, 2> goes_on{};
    for (size_t i = 0; i < 2; ++i) {
        if (!halves.there[i]) continue;
        ++thread.answer.counts.box_tests;
        if (!thread.in_range[i]) return stop(thread, Stop::out_of_range, 0);
        goes_on[i] = halves.pair[i].squared < thread.answer.squared;
    }
    if (!goes_on[0] && !goes_on[1]) {
        thread.phase = Phase::pop;
        return;
    }
    const bool second =
        goes_on[1] && (!goes_on[0] || halves.pair[1].squared < halves.pair[0].squared);
    if (goes_on[0] && goes_on[1] && !push(thread, halves.pair[second ? 0 : 1], stack_depth)) return;
    thread.pair = halves.pair[second ? 1 : 0];
    thread.phase = Phase::divide;
}

void accept_records(SearchThread& thread, const GapAnswer& answer) {
    --thread.in_gap_unit;
    ++thread.answer.counts.pair_tests;
    if (answer.squared < thread.answer.squared) {
        thread.answer.found = true;
        thread.answer.squared = answer.squared;
        thread.answer.tool_record = answer.tool_record;
        thread.answer.work_record = answer.work_record;
        thread.answer.sample = thread.pair.first;
    }
    if (thread.phase == Phase::drain && thread.in_gap_unit == 0) thread.phase = Phase::pop;
}

} // namespace

void start(SearchThread& thread, const Query& query, uint64_t cycle) {
    thread.phase = Phase::divide;
    thread.stack_size = 0;
    thread.in_gap_unit = 0;
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
    return thread.after_line == Phase::open ? thread.division == Division::work
                                            : thread.after_line == Phase::take_work;
}

uint32_t requested_line(const SearchThread& thread) {
    const Reference& from = needs_work(thread) ? thread.pair.work : thread.pair.tool;
    if (thread.after_line == Phase::open) return from.line();
    return from.line() + (needs_work(thread) ? thread.work_line : thread.tool_line);
}

PathAnswer ask_path_unit(SearchThread& thread, uint8_t number, uint64_t cycle,
                         const DeviceConfig& config) {
    const Segment& segment = thread.query.segment;
    if (thread.phase == Phase::middle) {
        thread.phase = Phase::halving;
        const SplitPairs& halves = thread.halves;
        return {
            true,
            number,
            Division::none,
            {offset_at(segment, halves.pair[0].last), offset_at(segment, halves.pair[1].first)}};
    }
    if (cycle - thread.started > config.search_limit) {
        stop(thread, Stop::too_long, 0);
        return {};
    }
    thread.phase = Phase::dividing;
    return {true,
            number,
            division_of(thread.pair, segment, config.volumes),
            {offset_at(segment, thread.pair.first), offset_at(segment, thread.pair.last)}};
}

void accept_path(SearchThread& thread, const PathAnswer& answer) {
    if (thread.phase == Phase::halving) {
        thread.middle = answer.offset;
        test_halves(thread);
        return;
    }
    thread.offset = answer.offset;
    thread.division = answer.division;
    switch (thread.division) {
    case Division::tool:
    case Division::work:
        thread.phase = Phase::open;
        return;
    case Division::way:
        ++thread.answer.counts.splits;
        thread.halves = split_at_middle(thread.pair);
        thread.phase = Phase::middle;
        return;
    case Division::none:
        thread.tool_line = thread.work_line = 0;
        thread.tool_record_index = thread.work_record_index = 0;
        thread.phase = Phase::take_tool;
    }
}

void accept_line(SearchThread& thread, const Line& line, Volumes volumes) {
    const bool of_work = needs_work(thread);
    const uint32_t epoch = of_work ? thread.query.work_epoch : thread.query.tool_epoch;
    if (epoch_of(line) > epoch) return stop(thread, Stop::model_changed, requested_line(thread));
    switch (thread.after_line) {
    case Phase::open:
        ++thread.answer.counts.nodes;
        thread.halves = halves_of_node(thread.pair, thread.division, node_in(line, volumes));
        return test_halves(thread);
    case Phase::take_tool:
        thread.tools = records_in(line);
        thread.phase = Phase::take_work;
        return;
    default:
        thread.works = records_in(line);
        thread.phase = Phase::compare;
    }
}

GapAnswer ask_gap_unit(SearchThread& thread, uint8_t number, Volumes volumes) {
    return thread.phase == Phase::test ? test_of_half(thread, number, volumes)
                                       : next_records(thread, number);
}

void accept_gap(SearchThread& thread, const GapAnswer& answer, uint32_t stack_depth) {
    if (answer.of_records) return accept_records(thread, answer);
    thread.halves.pair[answer.half].squared = answer.squared;
    thread.in_range[answer.half] = answer.in_range;
    if (is_last_half(thread, answer.half)) choose_half(thread, stack_depth);
}

void accept_popped(SearchThread& thread) {
    const SearchPair& pair = thread.stack[--thread.stack_size];
    const bool goes_on = pair.squared < thread.answer.squared;
    if (goes_on) thread.pair = pair;
    thread.phase = goes_on ? Phase::divide : Phase::pop;
}

namespace {

/// The units that a thread uses in this cycle, and the questions to them.
struct Ports {
    bool path_taken = false, gap_taken = false, caches_taken = false, stacks_taken = false;
    PathAnswer path;
    GapAnswer gap;
};

constexpr uint32_t bit(uint32_t thread) { return 1U << thread; }

/// std::popcount for 16 bits; the standard one calls a library function without -mpopcnt.
constexpr uint32_t count_of(uint32_t set) {
    set = set - ((set >> 1) & 0x5555U);
    set = (set & 0x3333U) + ((set >> 2) & 0x3333U);
    set = (set + (set >> 4)) & 0x0F0FU;
    return (set + (set >> 8)) & 0x1FU;
}

constexpr uint32_t bit(Phase phase) { return bit(static_cast<uint32_t>(phase)); }

/// The phases in which a thread takes a step; in the others it waits for an input.
constexpr uint32_t acting_phases = bit(Phase::divide) | bit(Phase::open) | bit(Phase::middle)
                                   | bit(Phase::test) | bit(Phase::pop) | bit(Phase::popped)
                                   | bit(Phase::take_tool) | bit(Phase::take_work)
                                   | bit(Phase::compare) | bit(Phase::ask);

/// Updates the sets of threads by phase for this thread.
void sort_in(SearchElement& e, uint32_t number) {
    const Phase phase = e.threads[number].phase;
    const auto put = [&](uint32_t& set, bool is_in) {
        set = is_in ? set | bit(number) : set & ~bit(number);
    };
    put(e.acting, (acting_phases & bit(phase)) != 0);
    put(e.busy, phase != Phase::idle);
    put(e.waiting, phase == Phase::wait);
    put(e.done, phase == Phase::done);
}

LineCache& cache_for(SearchElement& e, const SearchThread& thread) {
    return thread.after_line == Phase::open ? e.nodes : e.records;
}

/// Reads the line that the thread needs from its cache.
void read_cache(SearchElement& e, const DeviceConfig& config, uint8_t number) {
    SearchThread& thread = e.threads[number];
    thread.after_line = thread.phase;
    const uint32_t address = requested_line(thread);
    if (address >= config.memory_lines) return stop(thread, Stop::bad_address, address);
    const Line* line = cached_line(cache_for(e, thread), address);
    e.looked.valid = true;
    e.looked.hit = line != nullptr;
    e.looked.thread = number;
    if (line) e.looked.line = *line;
    thread.phase = Phase::look;
}

/// Whether a thread gets a unit; it is taken for the threads after it.
bool takes(SearchElement& e, bool& is_taken) {
    if (is_taken) {
        ++e.counts.wait_port;
        return false;
    }
    return is_taken = true;
}

void act(SearchElement& e, const DeviceConfig& config, const ElementInput& in, uint8_t number,
         Ports& ports) {
    SearchThread& thread = e.threads[number];
    switch (thread.phase) {
    case Phase::divide:
    case Phase::middle:
        if (takes(e, ports.path_taken))
            ports.path = ask_path_unit(thread, number, in.cycle, config);
        break;
    case Phase::open:
    case Phase::take_tool:
    case Phase::take_work:
        if (takes(e, ports.caches_taken)) read_cache(e, config, number);
        break;
    case Phase::ask:
        if (!takes(e, e.request.valid)) break;
        e.request = {true, in.number, number, in.run, requested_line(thread)};
        thread.is_stale = false;
        thread.phase = Phase::wait;
        break;
    case Phase::test:
    case Phase::compare:
        if (takes(e, ports.gap_taken)) ports.gap = ask_gap_unit(thread, number, config.volumes);
        break;
    case Phase::pop:
        if (thread.stack_size == 0)
            thread.phase = Phase::done;
        else if (takes(e, ports.stacks_taken))
            thread.phase = Phase::popped;
        break;
    default:
        accept_popped(thread);
    }
    sort_in(e, number);
}

/// Continues with the line that the cache gave, or has it read from memory.
void take_looked(SearchElement& e, Volumes volumes) {
    if (!e.looked.valid) return;
    e.looked.valid = false;
    SearchThread& thread = e.threads[e.looked.thread];
    const bool is_node = thread.after_line == Phase::open;
    if (e.looked.hit) {
        ++(is_node ? e.counts.node_hits : e.counts.record_hits);
        accept_line(thread, e.looked.line, volumes);
    } else {
        ++(is_node ? e.counts.node_misses : e.counts.record_misses);
        thread.phase = Phase::ask;
    }
    sort_in(e, e.looked.thread);
}

/// Whether a line from memory goes into a cache. One that was written meanwhile does not.
bool is_filling(const SearchElement& e, const ElementInput& in) {
    if (!in.response || in.response->request.run != in.run || !in.response->is_intact) return false;
    return !e.threads[in.response->request.thread].is_stale;
}

void take_response(SearchElement& e, const ElementInput& in, Volumes volumes) {
    const ReadRequest& request = in.response->request;
    if (request.run != in.run) return;
    SearchThread& thread = e.threads[request.thread];
    if (in.response->is_intact)
        accept_line(thread, in.response->line, volumes);
    else
        stop(thread, Stop::bad_check, request.address);
    sort_in(e, request.thread);
}

void take_answers(SearchElement& e, const DeviceConfig& config) {
    if (const PathAnswer& answer = e.path.output(); answer.valid) {
        accept_path(e.threads[answer.thread], answer);
        sort_in(e, answer.thread);
    }
    if (const GapAnswer& answer = e.gap.output(); answer.valid) {
        accept_gap(e.threads[answer.thread], answer, config.stack_depth);
        sort_in(e, answer.thread);
    }
}

/// Lines whose reading is under way when they are written must not go into a cache.
void mark_stale(SearchElement& e, uint32_t written) {
    for (uint32_t set = e.waiting; set != 0; set &= set - 1) {
        SearchThread& thread = e.threads[static_cast<size_t>(std::countr_zero(set))];
        if (requested_line(thread) == written) thread.is_stale = true;
    }
}

/// Puts the line from memory into its cache, and drops lines that were written. The tags have one
/// port for both: if a line comes in, whatever is in the place of the written one is dropped.
void update_caches(SearchElement& e, const ElementInput& in, LineCache* filled) {
    if (filled) fill(*filled, in.response->request.address, in.response->line);
    if (e.snoop.in_nodes) entry_of(e.nodes, e.snoop.address).valid = false;
    if (e.snoop.in_records) entry_of(e.records, e.snoop.address).valid = false;
    e.snoop = {};
    if (!in.forget) return;
    if (filled) {
        entry_of(e.nodes, in.forgotten).valid = false;
        entry_of(e.records, in.forgotten).valid = false;
    } else {
        e.snoop = {cached_line(e.nodes, in.forgotten) != nullptr,
                   cached_line(e.records, in.forgotten) != nullptr, in.forgotten};
    }
}

/// Drops all searches and requests; the caches stay.
void flush(SearchElement& e) {
    for (SearchThread& thread : e.threads) thread.phase = Phase::idle;
    e.acting = e.busy = e.waiting = e.done = 0;
    e.request.valid = e.looked.valid = false;
    e.path = {};
    e.gap = {};
}

void step_threads(SearchElement& e, const DeviceConfig& config, const ElementInput& in) {
    ++e.counts.busy;
    e.counts.wait_retire += count_of(e.done);
    e.counts.wait_memory += count_of(e.waiting);
    // Threads that get an input in this cycle act in the next.
    const uint32_t acting = e.acting;
    if (in.granted) e.request.valid = false;
    take_looked(e, config.volumes);
    if (in.response) take_response(e, in, config.volumes);
    take_answers(e, config);
    Ports ports;
    // The threads from `first` on, then those before it.
    const uint32_t before = bit(e.first) - 1;
    for (uint32_t set : {acting & ~before, acting & before})
        for (; set != 0; set &= set - 1)
            act(e, config, in, static_cast<uint8_t>(std::countr_zero(set)), ports);
    e.path.tick(ports.path);
    e.gap.tick(ports.gap);
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
    LineCache* const filled =
        is_filling(e, in) ? &cache_for(e, e.threads[in.response->request.thread]) : nullptr;
    if (in.forget) mark_stale(e, in.forgotten);
    if (e.busy != 0) step_threads(e, config, in);
    update_caches(e, in, filled);
    e.first = e.first + 1U == config.threads ? 0 : static_cast<uint8_t>(e.first + 1);
    if (in.release) {
        e.threads[in.release->thread].phase = Phase::idle;
        sort_in(e, in.release->thread);
    }
    if (in.start) {
        start(e.threads[in.start->thread], in.start->query, in.cycle);
        sort_in(e, in.start->thread);
    }
    if (in.flush) flush(e);
}

} // namespace hwsim
