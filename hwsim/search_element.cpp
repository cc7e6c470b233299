#include "hwsim/search_element.h"

#include <bit>

#include "hwsim/search.h"

namespace hwsim {
namespace {

/// What has been given away in this cycle.
struct Ports {
    bool nodes = false, records = false;
    BoxUnit::Output box;
    PairUnit::Output pair;
};

constexpr uint32_t bit(uint32_t thread) { return 1U << thread; }

/// std::popcount calls a library where the processor is not known to have it. For 16 bits.
constexpr uint32_t count_of(uint32_t set) {
    set = set - ((set >> 1) & 0x5555U);
    set = (set & 0x3333U) + ((set >> 2) & 0x3333U);
    set = (set + (set >> 4)) & 0x0F0FU;
    return (set + (set >> 8)) & 0x1FU;
}

/// Puts a thread into the sets that its phase belongs to.
void sort_in(SearchElement& e, uint32_t number) {
    const Phase phase = e.threads[number].phase;
    const bool is_waiting = phase == Phase::wait, is_done = phase == Phase::done;
    const bool is_acting = phase != Phase::idle && !is_done && !is_waiting && phase != Phase::tested
                           && phase != Phase::drain;
    e.acting = is_acting ? e.acting | bit(number) : e.acting & ~bit(number);
    e.done = is_done ? e.done | bit(number) : e.done & ~bit(number);
    e.waiting = is_waiting ? e.waiting | bit(number) : e.waiting & ~bit(number);
}

/// Reads from a cache, or lets the thread ask the memory.
void read_line(SearchElement& e, const DeviceConfig& config, SearchThread& thread, Ports& ports) {
    const bool is_node = thread.phase == Phase::open;
    bool& taken = is_node ? ports.nodes : ports.records;
    if (taken) {
        ++e.counts.wait_port;
        return;
    }
    taken = true;
    const uint32_t address = wanted_line(thread);
    if (address >= config.memory_lines) return stop(thread, Stop::bad_address, address);
    const Line* line = looked_up(is_node ? e.nodes : e.records, address);
    if (line) {
        ++(is_node ? e.counts.node_hits : e.counts.record_hits);
        return take_line(thread, *line);
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
    e.request = {true, in.number, number, in.run, wanted_line(thread)};
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
        take_line(thread, in.response->line);
    }
    sort_in(e, request.thread);
}

void take_results(SearchElement& e, const DeviceConfig& config) {
    if (const BoxUnit::Output& tests = e.box.output(); tests.valid) {
        take_tests(e.threads[tests.thread], tests, config.stack_depth);
        sort_in(e, tests.thread);
    }
    if (const PairUnit::Output& distance = e.pair.output(); distance.valid) {
        take_distance(e.threads[distance.thread], distance);
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
        // What becomes ready in this cycle acts in the next.
        const uint32_t acting = e.acting;
        if (in.granted) e.request.valid = false;
        if (in.response) take_response(e, in);
        take_results(e, config);
        Ports ports;
        // From the first one on, then those before it.
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
