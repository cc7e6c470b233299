#include "gcode/trace.h"

#include <cmath>

#include <fmt/format.h>

namespace gcode {
namespace {

/// To a millionth, without trailing zeros and without a negative zero.
std::string number(double value) {
    std::string text = fmt::format("{:.6f}", value);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text == "-0" ? "0" : text;
}

std::string place(const Position& position) {
    std::string text;
    for (size_t axis = 0; axis < 3; ++axis)
        if (position[axis]) text += fmt::format(" {}={}", "xyz"[axis], number(*position[axis]));
    return text;
}

std::string_view name_of(Plane plane) {
    if (plane == Plane::xy) return "XY";
    return plane == Plane::zx ? "ZX" : "YZ";
}

std::string_view name_of(core::SpindleDirection direction) {
    if (direction == core::SpindleDirection::stopped) return "stopped";
    return direction == core::SpindleDirection::clockwise ? "clockwise" : "counterclockwise";
}

/// What stands behind the name of a command.
struct Details {
    std::string operator()(const StraightTraverse& command) const { return place(command.end); }
    std::string operator()(const StraightFeed& command) const {
        return place(command.end) + " feed=" + number(command.feed);
    }
    std::string operator()(const ArcFeed& command) const {
        return fmt::format("{} plane={} centre={},{} turns={} feed={}", place(command.end),
                           name_of(command.plane), number(command.centre[0]),
                           number(command.centre[1]), command.turns, number(command.feed));
    }
    std::string operator()(const Dwell& command) const {
        return " seconds=" + number(command.seconds);
    }
    std::string operator()(const SelectTool& command) const {
        return fmt::format(" tool={}", value_of(command.tool));
    }
    std::string operator()(const ChangeTool& command) const {
        return fmt::format(" tool={}", command.tool ? value_of(*command.tool) : 0);
    }
    std::string operator()(const Spindle& command) const {
        return fmt::format(" direction={} speed={}", name_of(command.direction),
                           number(command.speed));
    }
    std::string operator()(const Coolant& command) const {
        return fmt::format(" mist={} flood={}", int(command.mist), int(command.flood));
    }
    std::string operator()(const SelectPlane& command) const {
        return fmt::format(" plane={}", name_of(command.plane));
    }
    std::string operator()(const SetOffset& command) const {
        const Offsets& offsets = command.offsets;
        const size_t index = offsets.active;
        const std::string name =
            index < 6 ? fmt::format("G{}", 54 + index) : fmt::format("G59.{}", index - 5);
        Position sum;
        for (int axis = 0; axis < 3; ++axis)
            if (offsets.axis[static_cast<size_t>(axis)])
                sum[static_cast<size_t>(axis)] = offsets.work[index][axis] + offsets.local[axis]
                                                 + *offsets.axis[static_cast<size_t>(axis)];
        return fmt::format(" offset={}{}", name, place(sum));
    }
    std::string operator()(const UseToolLengthOffset& command) const {
        const std::string name =
            command.number ? fmt::format(" number={}", value_of(*command.number)) : "";
        return name + " length=" + number(command.length);
    }
    std::string operator()(const ProgramStop&) const { return {}; }
    std::string operator()(const OptionalStop&) const { return {}; }
    std::string operator()(const ProgramEnd&) const { return {}; }
};

std::string to_text(const Warning& warning) {
    return fmt::format("{}:{}: {}: {}\n", warning.where.line, warning.where.column,
                       warning.severity == Severity::note ? "note" : "warning", warning.message);
}

} // namespace

std::string to_text(const CanonicalCommand& command) {
    return std::string(command_name(command)) + std::visit(Details{}, command);
}

std::string to_text(const Run& run) {
    std::string text;
    for (const BlockResult& block : run.blocks) {
        for (const CanonicalCommand& command : block.commands)
            text += fmt::format("{}: {}\n", block.line, to_text(command));
        for (const Warning& warning : block.warnings) text += to_text(warning);
    }
    if (run.ending) text += to_text(*run.ending);
    if (run.error)
        text += fmt::format("{}:{}: error: {}\n", run.error->where.line, run.error->where.column,
                            run.error->message);
    return text;
}

} // namespace gcode
