#include "gcode/tables.h"

namespace gcode {

WorkOffset work_offset(const Tables& tables, size_t index) {
    return index < tables.work.size() ? tables.work[index] : WorkOffset{};
}

WorkOffset& writable_work_offset(Tables& tables, size_t index) {
    if (tables.work.size() <= index) tables.work.resize(index + 1);
    return tables.work[index];
}

std::optional<double> length_under(const Tables& tables, int number) {
    const auto entry = tables.lengths.find(core::OffsetNumber(number));
    if (entry != tables.lengths.end()) return entry->second.length + entry->second.wear;
    const auto tool = tables.tool_lengths.find(core::ToolNumber(number));
    if (tool != tables.tool_lengths.end()) return tool->second;
    return std::nullopt;
}

} // namespace gcode
