#include "hwsim/descriptor.h"

#include <cassert>

#include "hwsim/registers.h"

namespace hwsim {
namespace {

constexpr uint32_t slot_mask = model_slots - 1;
constexpr uint32_t timed_flag = 1U << 30, last_flag = 1U << 31;
constexpr size_t words_of_pair = 3, first_pair = 9;

size_t word_of_pair(uint32_t place, bool is_first) {
    return (is_first ? first_pair : 0) + words_of_pair * place;
}

Order order_of(SegmentKind kind) {
    switch (kind) {
    case SegmentKind::permit:
        return Order::permit;
    case SegmentKind::measure:
        return Order::measure;
    case SegmentKind::model:
        return Order::model;
    }
    return Order::none;
}

Descriptor path_in(const Line& line, Order order) {
    Descriptor d;
    d.order = order;
    d.pairs = (line.word[0] >> 16) & 0xFFU;
    d.segment = {.sequence = line.word[1],
                 .kind = order == Order::measure ? SegmentKind::measure : SegmentKind::permit,
                 .log2_steps = static_cast<uint8_t>((line.word[0] >> 8) & 0xFFU),
                 .last = (line.word[0] & last_flag) != 0,
                 .is_timed = (line.word[0] & timed_flag) != 0,
                 .deadline = line.word[8]};
    for (size_t axis = 0; axis < 3; ++axis) {
        d.segment.start[axis] = static_cast<int32_t>(line.word[2 + axis]);
        d.segment.end[axis] = static_cast<int32_t>(line.word[5 + axis]);
    }
    return d;
}

Descriptor model_in(const Line& line) {
    Descriptor d;
    d.order = Order::model;
    d.segment = {.sequence = line.word[1],
                 .kind = SegmentKind::model,
                 .work_slot = static_cast<uint8_t>(line.word[2] & slot_mask),
                 .last = (line.word[0] & last_flag) != 0,
                 .work_epoch = line.word[4],
                 .model_header = line.word[3]};
    return d;
}

Stop fault_of(const LineCopy& copy, const DeviceConfig& config) {
    if (copy.from % sizeof(Line) != 0) return Stop::bad_descriptor;
    const bool fits =
        copy.line < config.memory_lines && copy.count <= config.memory_lines - copy.line;
    return fits ? Stop::none : Stop::bad_address;
}

} // namespace

Stop fault_of(const Segment& entry) {
    bool is_good = entry.log2_steps <= Segment::most_log2_steps
                   && entry.threshold <= static_cast<uint32_t>(greatest_coordinate)
                   && (!entry.last || entry.kind == SegmentKind::permit);
    for (size_t axis = 0; axis < 3; ++axis)
        is_good = is_good && is_coordinate(entry.start[axis]) && is_coordinate(entry.end[axis]);
    return is_good ? Stop::none : Stop::out_of_range;
}

Segment with_pair(Segment path, const Line& line, uint32_t place, bool is_first) {
    const size_t at = word_of_pair(place, is_first);
    path.tool_slot = static_cast<uint8_t>(line.word[at] & slot_mask);
    path.work_slot = static_cast<uint8_t>((line.word[at] >> 5) & slot_mask);
    path.threshold = line.word[at + 1];
    path.work_epoch = line.word[at + 2];
    return path;
}

DecodedDescriptor descriptor_in(const Line& line, const DeviceConfig& config) {
    const auto order = static_cast<Order>(line.word[0] & 0xFFU);
    switch (order) {
    case Order::permit:
    case Order::measure: {
        const Descriptor d = path_in(line, order);
        return {d, d.pairs == 0 ? Stop::bad_descriptor : fault_of(d.segment)};
    }
    case Order::model: {
        const Descriptor d = model_in(line);
        const bool is_inside = d.segment.model_header < config.memory_lines;
        return {d, is_inside ? fault_of(d.segment) : Stop::bad_address};
    }
    case Order::copy: {
        Descriptor d;
        d.order = order;
        d.copy = {line.word[3] | uint64_t{line.word[4]} << 32, line.word[1], line.word[2]};
        return {d, fault_of(d.copy, config)};
    }
    case Order::none:
        break;
    }
    return {{}, Stop::bad_descriptor};
}

std::vector<Line> descriptor_of(std::span<const Segment> entries) {
    assert(!entries.empty() && entries.size() <= Descriptor::most_pairs);
    const Segment& path = entries.front();
    std::vector<Line> lines(1);
    std::array<uint32_t, Line::words>& word = lines[0].word;
    word[0] = static_cast<uint32_t>(order_of(path.kind)) | (entries.back().last ? last_flag : 0U);
    word[1] = path.sequence;
    if (path.kind == SegmentKind::model) {
        word[2] = path.work_slot;
        word[3] = path.model_header;
        word[4] = path.work_epoch;
        return lines;
    }
    word[0] |= uint32_t{path.log2_steps} << 8 | static_cast<uint32_t>(entries.size()) << 16
               | (path.is_timed ? timed_flag : 0U);
    for (size_t axis = 0; axis < 3; ++axis) {
        word[2 + axis] = static_cast<uint32_t>(path.start[axis]);
        word[5 + axis] = static_cast<uint32_t>(path.end[axis]);
    }
    word[8] = path.deadline;
    uint32_t place = 0;
    for (const Segment& pair : entries) {
        const bool was_first = lines.size() == 1;
        if (place == (was_first ? Descriptor::pairs_in_first : Descriptor::pairs_in_next)) {
            lines.emplace_back();
            place = 0;
        }
        const size_t at = word_of_pair(place++, lines.size() == 1);
        lines.back().word[at] = pair.tool_slot | uint32_t{pair.work_slot} << 5;
        lines.back().word[at + 1] = pair.threshold;
        lines.back().word[at + 2] = pair.work_epoch;
    }
    return lines;
}

Line descriptor_of(const LineCopy& copy) {
    Line line;
    line.word[0] = static_cast<uint32_t>(Order::copy);
    line.word[1] = copy.line;
    line.word[2] = copy.count;
    line.word[3] = static_cast<uint32_t>(copy.from);
    line.word[4] = static_cast<uint32_t>(copy.from >> 32);
    return line;
}

void seal(Line& line, uint32_t number) { line.word[Line::check_word] = check_of(line, number); }

} // namespace hwsim
