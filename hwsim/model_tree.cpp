#include "hwsim/model_tree.h"

#include <algorithm>
#include <tuple>

#include <fmt/format.h>

namespace hwsim {
namespace {

core::Result<LineRun> taken(ModelWriter& writer, uint32_t count) {
    const auto run = take(*writer.space, count);
    if (!run)
        return core::fail(core::ErrorCode::invalid_value,
                          fmt::format("the models do not fit into the coprocessor's memory of {} "
                                      "lines; a larger mesh size makes fewer",
                                      writer.space->end));
    writer.runs.push_back(*run);
    return *run;
}

bool fits(const Record& record) {
    const Box box = box_of(record);
    for (size_t axis = 0; axis < 3; ++axis)
        if (!is_coordinate(box.min[axis]) || !is_coordinate(box.max[axis])) return false;
    const auto is_extent = [](int32_t x) { return x >= 0 && x <= Record::greatest_extent; };
    return is_extent(record.run) && is_extent(record.half);
}

/// Twice the middle of a record along an axis.
int64_t middle(const Record& record, size_t axis) {
    return 2 * int64_t{record.base[axis]} + (axis == 2 ? record.run : 0);
}

size_t longest_axis(std::span<const Record> records) {
    size_t longest = 0;
    int64_t length = -1;
    for (size_t axis = 0; axis < 3; ++axis) {
        int64_t min = middle(records[0], axis), max = min;
        for (const Record& record : records) {
            min = std::min(min, middle(record, axis));
            max = std::max(max, middle(record, axis));
        }
        if (max - min <= length) continue;
        longest = axis;
        length = max - min;
    }
    return longest;
}

core::Result<Branch> subtree(ModelWriter& writer, std::span<Record> records, uint32_t leaf_size) {
    if (records.size() <= leaf_size) return writer.add_leaf(records);
    const size_t axis = longest_axis(records);
    const auto by_place = [axis](const Record& r) {
        return std::tuple(middle(r, axis), middle(r, 0), middle(r, 1), middle(r, 2), r.run, r.half);
    };
    // Whole lines on the left, so that few places of the leaves stay empty.
    const size_t half =
        (records.size() / 2 + records_per_line - 1) / records_per_line * records_per_line;
    const size_t left = records.size() > size_t{2} * records_per_line ? half : records.size() / 2;
    const auto at = static_cast<std::ptrdiff_t>(left);
    std::nth_element(records.begin(), records.begin() + at, records.end(),
                     [&](const Record& a, const Record& b) { return by_place(a) < by_place(b); });
    FEELER_TRY(const Branch a, subtree(writer, records.first(left), leaf_size));
    FEELER_TRY(const Branch b, subtree(writer, records.subspan(left), leaf_size));
    return add_above(writer, a, b);
}

} // namespace

core::Result<uint32_t> ModelWriter::add(const Node& node) {
    FEELER_TRY(const LineRun run, taken(*this, 1));
    lines.push_back({run.first, packed(node, epoch, run.first)});
    return run.first;
}

core::Result<Branch> ModelWriter::add_leaf(std::span<const Record> records) {
    const auto count = static_cast<uint32_t>(records.size());
    FEELER_TRY(const LineRun run, taken(*this, leaf_lines(count)));
    Branch leaf{Reference::leaf(run.first, count), volume_of(records[0], side)};
    for (const Record& record : records) leaf.volume.extend(volume_of(record, side));
    for (uint32_t i = 0; i < run.count; ++i) {
        Records four{};
        const auto part = records.subspan(size_t{i} * records_per_line);
        std::copy_n(part.begin(), std::min<size_t>(records_per_line, part.size()), four.begin());
        lines.push_back({run.first + i, packed(four, epoch, run.first + i)});
    }
    return leaf;
}

core::Result<Branch> add_tree(ModelWriter& writer, std::vector<Record> records,
                              uint32_t leaf_size) {
    if (records.empty() || leaf_size < 1 || leaf_size > Reference::most_records)
        return core::fail(core::ErrorCode::invalid_value,
                          "a model needs at least one record, and leaves of 1 to 32 of them");
    if (!std::all_of(records.begin(), records.end(), fits))
        return core::fail(core::ErrorCode::invalid_value,
                          "a model reaches beyond the coprocessor's range of 2048 mm, or a part "
                          "of it is larger than 256 mm");
    return subtree(writer, records, leaf_size);
}

core::Result<Branch> add_above(ModelWriter& writer, const Branch& a, const Branch& b) {
    if (a.reference.is_none()) return b;
    if (b.reference.is_none()) return a;
    FEELER_TRY(const uint32_t line,
               writer.add(Node{{a.volume, b.volume}, {a.reference, b.reference}}));
    Branch above{Reference::node(line), a.volume};
    above.volume.extend(b.volume);
    return above;
}

core::Result<uint32_t> add_header(ModelWriter& writer, const Branch& root) {
    return writer.add(Node{{root.volume, root.volume}, {root.reference, Reference{}}});
}

} // namespace hwsim
