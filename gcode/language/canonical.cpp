#include "gcode/language/canonical.h"

#include <array>
#include <charconv>

#include <fmt/format.h>

namespace gcode {

std::string_view command_name(const CanonicalCommand& command) {
    // In the order of the variant.
    constexpr std::array<std::string_view, std::variant_size_v<CanonicalCommand>> names = {
        "straight_traverse", "straight_feed",    "arc_feed",
        "straight_probe",    "thread_feed",      "dwell",
        "select_tool",       "change_tool",      "name_tool",
        "spindle",           "use_spindle_mode", "coolant",
        "select_plane",      "set_offset",       "use_tool_length_offset",
        "set_path_mode",     "enable_override",  "set_output",
        "wait_for_input",    "message",          "program_stop",
        "optional_stop",     "program_end"};
    return names[command.index()];
}

bool is_motion(const CanonicalCommand& command) {
    return std::holds_alternative<StraightTraverse>(command)
           || std::holds_alternative<StraightFeed>(command)
           || std::holds_alternative<ArcFeed>(command)
           || std::holds_alternative<StraightProbe>(command)
           || std::holds_alternative<ThreadFeed>(command);
}

std::string_view name_of(Plane plane) {
    constexpr std::string_view names[] = {"XY", "ZX", "YZ", "UV", "WU", "VW"};
    return names[static_cast<size_t>(plane)];
}

std::string name_of_offset(size_t index) {
    if (index == no_work_offset) return "G500";
    if (index < 6) return fmt::format("G{}", 54 + index);
    if (index < plain_offset_count) return fmt::format("G59.{}", index - 5);
    return fmt::format("G54.1 P{}", index - plain_offset_count + 1);
}

std::string siemens_name_of_offset(size_t index) {
    return index < 4 || index == no_work_offset ? name_of_offset(index)
                                                : fmt::format("G{}", index - 4 + 505);
}

std::optional<size_t> offset_of_name(std::string_view name) {
    for (size_t index = 0; index < plain_offset_count; ++index)
        if (name == name_of_offset(index)) return index;
    const auto number_after = [&](std::string_view code, size_t least, size_t most) {
        size_t number = 0;
        if (!name.starts_with(code)) return number;
        const char* end = name.data() + name.size();
        const auto read = std::from_chars(name.data() + code.size(), end, number);
        const bool is_valid = read.ec == std::errc() && read.ptr == end;
        return is_valid && number >= least && number <= most ? number : size_t{0};
    };
    for (const char* code : {"G54.1 P", "G154 P"})
        if (const size_t number = number_after(code, 1, extended_offset_count))
            return plain_offset_count + number - 1;
    const size_t siemens = number_after("G", 505, 599);
    return siemens > 0 ? std::optional(siemens - 505 + 4) : std::nullopt;
}

} // namespace gcode
