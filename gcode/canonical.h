#pragma once

#include <optional>
#include <string_view>
#include <variant>

#include "core/base/ids.h"
#include "core/sim/event.h"
#include "gcode/modal_state.h"

namespace gcode {

/// Canonical commands: what a block means once modes and units are resolved. Lengths in mm, feed in
/// mm/min, ends in program coordinates of the offsets that are active at the command.
struct StraightTraverse {
    Position end;
};
struct StraightFeed {
    Position end;
    double feed;
};
struct ArcFeed {
    Position end;
    Plane plane;
    double centre[2]; // along the plane's first and second axis
    int turns;        // as LinuxCNC: +1 up to one turn counter-clockwise, -2 up to two clockwise
    double feed;
};
struct Dwell {
    double seconds;
};
struct SelectTool {
    core::ToolNumber tool;
};
struct ChangeTool {
    std::optional<core::ToolNumber> tool; // empty: T0, an empty spindle
};
struct Spindle {
    core::SpindleDirection direction;
    double speed; // rev/min
};
struct Coolant {
    bool mist, flood;
};
struct SelectPlane {
    Plane plane;
};
/// A work offset, G52 or G92 took new values, or another work offset became active.
struct SetOffset {
    Offsets offsets; // all of them, as they are from here on
};
struct UseToolLengthOffset {
    std::optional<core::OffsetNumber> number; // empty: G49, or a length without a number (G43.1)
    double length;                            // mm along Z
};
struct ProgramStop {};
struct OptionalStop {};
struct ProgramEnd {};

using CanonicalCommand = std::variant<StraightTraverse, StraightFeed, ArcFeed, Dwell, SelectTool,
                                      ChangeTool, Spindle, Coolant, SelectPlane, SetOffset,
                                      UseToolLengthOffset, ProgramStop, OptionalStop, ProgramEnd>;

/// The name of a command in traces: straight_traverse, arc_feed, change_tool ...
std::string_view command_name(const CanonicalCommand& command);

} // namespace gcode
