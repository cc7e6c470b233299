#include "gcode/lower/trace.h"

#include <cmath>

#include <fmt/format.h>

#include "core/base/text.h"
#include "gcode/language/lexer.h"

namespace gcode {
namespace {

/// Rounded to a millionth, without trailing zeros or negative zero.
std::string number(double value) { return core::number_text(value, 6); }

std::string axes_text(const Position& position) {
    std::string text;
    // Axes other than X, Y and Z that are at zero usually do not exist.
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (position[axis] && (axis < 3 || *position[axis] != 0.0))
            text += fmt::format(" {}={}", lower(axis_letters[axis]), number(*position[axis]));
        else if (!position[axis] && axis >= 3)
            text += fmt::format(" {}=?", lower(axis_letters[axis]));
    return text;
}

} // namespace

namespace {

std::string_view name_of(core::SpindleDirection direction) {
    if (direction == core::SpindleDirection::stopped) return "stopped";
    return direction == core::SpindleDirection::clockwise ? "clockwise" : "counterclockwise";
}

std::string frame(const ProgramFrame& frame) {
    std::string text = " frame=";
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) text += number(frame.linear[column][row]) + ",";
    return text + number(frame.shift.x) + "," + number(frame.shift.y) + "," + number(frame.shift.z);
}

/// The text after the name of a command.
struct Details {
    std::string operator()(const StraightTraverse& command) const { return axes_text(command.end); }
    std::string operator()(const StraightFeed& command) const {
        return axes_text(command.end) + " feed=" + number(command.feed);
    }
    std::string operator()(const ArcFeed& command) const {
        return fmt::format("{} plane={} centre={},{} turns={} feed={}", axes_text(command.end),
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
    std::string operator()(const NameTool& command) const {
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
        Position sum;
        for (size_t axis = 0; axis < axis_count; ++axis)
            if (offsets.axis[axis])
                sum[axis] = offsets.work.origin[axis] + offsets.local[axis] + *offsets.axis[axis];
        const std::string turn = offsets.work.rotation_deg == 0.0
                                     ? std::string()
                                     : " rotation=" + number(offsets.work.rotation_deg);
        return " offset=" + name_of_offset(offsets.active) + axes_text(sum) + turn
               + (offsets.has_frame ? frame(offsets.frame) : std::string());
    }
    std::string operator()(const UseToolLengthOffset& command) const {
        const std::string name =
            command.number ? fmt::format(" number={}", value_of(*command.number)) : "";
        std::string others;
        for (size_t axis = 0; axis < axis_count; ++axis)
            if (axis != 2 && command.offset[axis] != 0.0)
                others +=
                    fmt::format(" {}={}", lower(axis_letters[axis]), number(command.offset[axis]));
        if (command.follows_tip) others += " follows_tip";
        return name + " length=" + number(command.offset[2]) + others;
    }
    std::string operator()(const UseSpindleMode& command) const {
        return fmt::format(" surface_speed={} speed={} fastest_speed={}",
                           int(command.surface_speed), number(command.speed),
                           number(command.fastest_speed));
    }
    std::string operator()(const SetPathMode& command) const {
        constexpr std::string_view names[] = {"exact_path", "exact_stop", "continuous"};
        std::string text = fmt::format(" mode={} tolerance={} naive_tolerance={}",
                                       names[static_cast<size_t>(command.mode)],
                                       number(command.tolerance), number(command.naive_tolerance));
        const auto add = [&](const char* name, const std::optional<double>& value) {
            if (value) text += fmt::format(" {}={}", name, number(*value));
        };
        add("distance", command.corners.distance);
        // In LinuxCNC's G64 P it is the tolerance.
        if (command.corners.rapid_tolerance != command.tolerance)
            add("rapid_tolerance", command.corners.rapid_tolerance);
        add("rapid_distance", command.corners.rapid_distance);
        return text;
    }
    std::string operator()(const EnableOverride& command) const {
        constexpr std::string_view names[] = {"feed", "speed", "adaptive_feed", "feed_hold"};
        return fmt::format(" kind={} enabled={}", names[static_cast<size_t>(command.kind)],
                           int(command.enabled));
    }
    std::string operator()(const SetOutput& command) const {
        return fmt::format(" number={} value={} analog={} with_motion={}", command.number,
                           number(command.value), int(command.is_analog), int(command.with_motion));
    }
    std::string operator()(const WaitForInput& command) const {
        return fmt::format(" number={} analog={} seconds={}", command.number,
                           int(command.is_analog), number(command.seconds));
    }
    std::string operator()(const Message& command) const { return " text=" + command.text; }
    std::string operator()(const StraightProbe& command) const {
        return fmt::format("{} feed={} towards={} must_succeed={}", axes_text(command.end),
                           number(command.feed), int(command.towards), int(command.must_succeed));
    }
    std::string operator()(const ThreadFeed& command) const {
        return fmt::format("{} pitch={} back_again={}", axes_text(command.end),
                           number(command.pitch), int(command.back_again));
    }
    std::string operator()(const ProgramStop&) const { return {}; }
    std::string operator()(const OptionalStop&) const { return {}; }
    std::string operator()(const ProgramEnd&) const { return {}; }
};

} // namespace

std::string to_text(const CanonicalCommand& command) {
    return std::string(command_name(command)) + std::visit(Details{}, command);
}

} // namespace gcode
