#include "hwsim/registers.h"

#include <bit>

namespace hwsim {
namespace {

constexpr auto at(SegmentWord word) { return static_cast<size_t>(word); }
constexpr uint32_t slot_mask = model_slots - 1;
constexpr uint32_t last_flag = 1U << 31;

} // namespace

SegmentWords words_of(const Segment& segment) {
    SegmentWords words{};
    words[at(SegmentWord::sequence)] = segment.sequence;
    words[at(SegmentWord::kind)] =
        static_cast<uint32_t>(segment.kind) | uint32_t{segment.log2_steps} << 8
        | uint32_t{segment.tool_slot} << 16 | uint32_t{segment.work_slot} << 21
        | (segment.last ? last_flag : 0U);
    for (size_t axis = 0; axis < 3; ++axis) {
        words[at(SegmentWord::start) + axis] = static_cast<uint32_t>(segment.start[axis]);
        words[at(SegmentWord::end) + axis] = static_cast<uint32_t>(segment.end[axis]);
    }
    words[at(SegmentWord::threshold)] = segment.threshold;
    words[at(SegmentWord::work_epoch)] = segment.work_epoch;
    words[at(SegmentWord::model_header)] = segment.model_header;
    words[at(SegmentWord::budget)] = segment.budget;
    return words;
}

DecodedSegment segment_in(const SegmentWords& words) {
    const uint32_t kind = words[at(SegmentWord::kind)];
    Segment s{.sequence = words[at(SegmentWord::sequence)],
              .kind = static_cast<SegmentKind>(kind & 0xFFU),
              .tool_slot = static_cast<uint8_t>((kind >> 16) & slot_mask),
              .work_slot = static_cast<uint8_t>((kind >> 21) & slot_mask),
              .log2_steps = static_cast<uint8_t>((kind >> 8) & 0xFFU),
              .last = (kind & last_flag) != 0,
              .threshold = words[at(SegmentWord::threshold)],
              .work_epoch = words[at(SegmentWord::work_epoch)],
              .model_header = words[at(SegmentWord::model_header)],
              .budget = words[at(SegmentWord::budget)]};
    bool good = (kind & 0xFFU) <= static_cast<uint32_t>(SegmentKind::model)
                && s.log2_steps <= Segment::most_log2_steps
                && s.threshold <= static_cast<uint32_t>(greatest_coordinate)
                && (!s.last || s.kind == SegmentKind::permit);
    for (size_t axis = 0; axis < 3; ++axis) {
        s.start[axis] = static_cast<int32_t>(words[at(SegmentWord::start) + axis]);
        s.end[axis] = static_cast<int32_t>(words[at(SegmentWord::end) + axis]);
        good = good && is_coordinate(s.start[axis]) && is_coordinate(s.end[axis]);
    }
    return {s, good ? Stop::none : Stop::out_of_range};
}

core::Result<DeviceConfig> checked(const DeviceConfig& c) {
    const auto is_within = [](uint32_t value, uint32_t most) {
        return value >= 1 && value <= most;
    };
    const auto is_cache = [&](uint32_t lines) {
        return is_within(lines, DeviceConfig::most_cache_lines) && std::has_single_bit(lines);
    };
    const bool good =
        is_within(c.clock_mhz, 10'000) && is_within(c.elements, DeviceConfig::most_elements)
        && is_within(c.threads, DeviceConfig::most_threads)
        && is_within(c.stack_depth, DeviceConfig::most_stack) && is_within(c.fifo_depth, 4096)
        && is_within(c.memory_lines, 1U << Reference::line_bits)
        && is_within(c.memory_latency, 10'000) && is_within(c.cycles_per_line, 1'000)
        && is_within(c.memory_queue, 4096) && is_within(c.write_queue, 4096) && c.search_limit > 0
        && c.memory_limit > 0 && is_cache(c.node_cache_lines) && is_cache(c.record_cache_lines);
    if (!good)
        return core::fail(
            core::ErrorCode::invalid_value,
            "invalid coprocessor: sizes and times must be at least 1, elements at most 64, threads "
            "at most 16, the stack at most 64, and caches powers of two up to 16384 lines");
    return c;
}

} // namespace hwsim
