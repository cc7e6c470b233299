#include "hwsim/coprocessor.h"

namespace hwsim {
namespace {

/// The sequence number that a fault of the whole device is put down to: the first not permitted.
uint32_t next_to_permit(const CoprocessorState& s) { return s.permits.permit_sequence + 1; }

void watch(CoprocessorState& s, const DeviceConfig& config) {
    if (s.permits.stopped != Stop::none || !s.host.enabled) return;
    if (s.host.watchdog != 0 && s.cycle - s.host.heartbeat > s.host.watchdog)
        halt(s, Stop::host_silent, next_to_permit(s));
    else if (is_stalled(s.memory, config, s.cycle))
        halt(s, Stop::memory_stalled, next_to_permit(s));
}

/// The answer to the first entry, if it is there.
std::optional<Answer> first_answer(const CoprocessorState& s) {
    if (s.permits.in_order.empty()) return {};
    const Dispatched& first = s.permits.in_order.front();
    if (!first.searched) return Answer{.stop = first.fault};
    const SearchThread& thread = s.elements[first.element].threads[first.thread];
    if (thread.phase != Phase::done) return {};
    return thread.answer;
}

void add(SearchSums& sum, const SearchCounts& counts) {
    ++sum.queries;
    sum.deepest = std::max(sum.deepest, counts.deepest);
    sum.nodes += counts.nodes;
    sum.splits += counts.splits;
    sum.box_tests += counts.box_tests;
    sum.pair_tests += counts.pair_tests;
}

void retire_first(CoprocessorState& s) {
    s.retired.valid = false;
    if (!s.host.enabled) return;
    const std::optional<Answer> answer = first_answer(s);
    if (!answer) return;
    const Dispatched& first = s.permits.in_order.front();
    if (first.searched) {
        release(s.elements[first.element], first.thread);
        --s.searching;
    }
    retire_with(s, *answer);
}

/// Gives a segment to an idle thread; false if there is none.
bool begin_search(CoprocessorState& s, const Segment& segment, Dispatched& entry) {
    const size_t count = s.elements.size();
    if (s.searching == count * s.elements[0].threads.size()) return false;
    for (size_t i = 0; i < count; ++i) {
        size_t number = s.next_element + i;
        if (number >= count) number -= count;
        SearchElement& element = s.elements[number];
        const auto thread = idle_thread(element);
        if (!thread) continue;
        ++s.searching;
        begin(element, *thread, query_of(s, segment), s.cycle);
        entry.searched = true;
        entry.element = static_cast<uint8_t>(number);
        entry.thread = *thread;
        s.next_element = static_cast<uint8_t>(number + 1 == count ? 0 : number + 1);
        return true;
    }
    return false;
}

/// The first entry of the FIFO leaves it: a model for its slot, once all lines that came before it
/// are written, or a
/// segment for a thread.
void dispatch(CoprocessorState& s) {
    if (s.permits.stopped != Stop::none || !s.host.enabled) return;
    if (s.fifo.entries.empty() || s.permits.in_order.full()) return;
    const SegmentFifo::Entry& first = s.fifo.entries.front();
    const Segment& segment = first.segment;
    Dispatched entry{.segment = segment, .pushed = first.pushed};
    if (segment.kind == SegmentKind::model) {
        if (s.memory.writes_done < first.lines) return;
        take_model(s, segment);
    } else {
        entry.fault = fault_of_models(s, segment);
        if (entry.fault == Stop::none && !begin_search(s, segment, entry)) return;
    }
    s.permits.in_order.push(entry);
    s.fifo.entries.pop();
}

/// Whose request is taken in, in turn; `none` if nobody asks or the memory takes nothing.
constexpr size_t none = SIZE_MAX;
size_t granted_element(const CoprocessorState& s) {
    if (!accepts(s.memory)) return none;
    const size_t count = s.elements.size();
    size_t number = s.next_request;
    for (size_t i = 0; i < count; ++i) {
        if (s.elements[number].request.valid) return number;
        if (++number == count) number = 0;
    }
    return none;
}

} // namespace

CoprocessorState power_up(const DeviceConfig& config) {
    CoprocessorState s;
    s.fifo.entries = Ring<SegmentFifo::Entry>(config.fifo_depth);
    const size_t entries = size_t{config.elements} * config.threads + config.fifo_depth;
    s.permits.in_order = Ring<Dispatched>(entries);
    s.elements.assign(config.elements, search_element(config));
    s.memory = memory_unit(config);
    return s;
}

void tick(CoprocessorState& s, const DeviceConfig& config) {
    ++s.cycle;
    // What the units showed before the edge.
    const size_t granted = granted_element(s);
    const ReadRequest request = granted == none ? ReadRequest{} : s.elements[granted].request;
    const ReadResponse& response = s.memory.response;
    ElementInput in{.cycle = s.cycle,
                    .run = s.run,
                    .forget = s.memory.has_written,
                    .forgotten = s.memory.written};
    for (size_t i = 0; i < s.elements.size(); ++i) {
        in.number = static_cast<uint8_t>(i);
        in.granted = i == granted;
        in.response = response.request.valid && response.request.element == i ? &response : nullptr;
        tick(s.elements[i], config, in);
    }
    if (granted != none) s.next_request = static_cast<uint8_t>((granted + 1) % s.elements.size());
    tick(s.memory, config, s.cycle, request);
    retire_first(s);
    dispatch(s);
    watch(s, config);
}

void halt(CoprocessorState& s, Stop reason, uint32_t sequence, uint32_t line) {
    stop(s.permits, reason, sequence, line);
    ++s.run;
    s.fifo.entries.clear();
    for (SearchElement& element : s.elements) flush(element);
    s.searching = 0;
    s.host.irq_pending |= irq_stop;
}

Stop fault_of_models(const CoprocessorState& s, const Segment& segment) {
    const ModelSlot& tool = s.slots[segment.tool_slot];
    const ModelSlot& work = s.slots[segment.work_slot];
    if (!tool.valid || !work.valid) return Stop::model_missing;
    return work.epoch == segment.work_epoch ? Stop::none : Stop::model_changed;
}

Query query_of(const CoprocessorState& s, const Segment& segment) {
    const ModelSlot& tool = s.slots[segment.tool_slot];
    const ModelSlot& work = s.slots[segment.work_slot];
    return {segment, tool.header, work.header, tool.epoch, work.epoch, limit_of(segment)};
}

void take_model(CoprocessorState& s, const Segment& segment) {
    s.slots[segment.work_slot] = {true, segment.model_header, segment.work_epoch};
}

void retire_with(CoprocessorState& s, const Answer& answer) {
    const Dispatched entry = s.permits.in_order.front();
    if (entry.segment.kind != SegmentKind::model) add(s.searched, answer.counts);
    s.retired = {true, entry.segment, answer, entry.pushed};
    const Retirement done = retire(s.permits, answer, s.cycle);
    if (done.permitted) s.host.irq_pending |= irq_permit;
    if (done.measured) s.host.irq_pending |= irq_measured;
    if (done.stopped != Stop::none) halt(s, done.stopped, entry.segment.sequence, answer.at_line);
}

bool store(CoprocessorState& s, uint32_t address, const Line& line) {
    if (address >= s.memory.lines.size() || s.memory.writes.full()) return false;
    s.memory.writes.push({address, line, s.cycle});
    return true;
}

} // namespace hwsim
