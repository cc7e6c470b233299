#include "gcode/language/tables.h"

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

bool lacks_length(const Tables& tables, std::optional<core::OffsetNumber> number) {
    return number && value_of(*number) != 0 && !length_under(tables, value_of(*number));
}

std::optional<double> diameter_under(const Tables& tables, int number) {
    const auto entry = tables.lengths.find(core::OffsetNumber(number));
    if (entry != tables.lengths.end() && entry->second.diameter != 0.0)
        return entry->second.diameter + 2.0 * entry->second.radius_wear;
    const auto tool = tables.tool_diameters.find(core::ToolNumber(number));
    if (tool != tables.tool_diameters.end()) return tool->second;
    if (entry != tables.lengths.end()) return 2.0 * entry->second.radius_wear;
    return std::nullopt;
}

} // namespace gcode
