#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/base/ids.h"
#include "core/base/result.h"
#include "core/motion/event.h"
#include "gcode/language/modal_state.h"

namespace gcode {

/// Canonical commands: the meaning of a block with modes and units resolved. Lengths in mm, feed in
/// mm/min; end points in program coordinates of the offsets active at the command.
struct StraightTraverse {
    Position end;
    std::optional<core::RapidStyle> style = {}; // empty: that of the machine
    bool in_plane = false; // rotary axes turn the tool in the plane of its directions at the ends

    bool operator==(const StraightTraverse&) const = default;
};
struct StraightFeed {
    Position end;
    double feed;
    bool in_plane = false; // as above

    bool operator==(const StraightFeed&) const = default;
};
struct ArcFeed {
    Position end;
    Plane plane;
    double centre[2]; // along the plane's first and second axis
    int turns;        // as LinuxCNC: +1 up to one turn counter-clockwise, -2 up to two clockwise
    double feed;

    bool operator==(const ArcFeed&) const = default;
};
/// A probing move. It stops at contact, or goes to its end if there is none.
struct StraightProbe {
    Position end;
    double feed;
    bool towards;      // until contact is made; otherwise until it is lost
    bool must_succeed; // missing contact is an error

    bool operator==(const StraightProbe&) const = default;
};
/// A feed synchronised with the spindle.
struct ThreadFeed {
    Position end;
    double pitch;    // mm per revolution
    bool back_again; // G33.1: reverses at the end and returns to its start

    bool operator==(const ThreadFeed&) const = default;
};
struct Dwell {
    double seconds;

    bool operator==(const Dwell&) const = default;
};
struct SelectTool {
    core::ToolNumber tool;

    bool operator==(const SelectTool&) const = default;
};
struct ChangeTool {
    std::optional<core::ToolNumber> tool; // empty: T0, an empty spindle

    bool operator==(const ChangeTool&) const = default;
};
/// M61: declares the tool in the spindle.
struct NameTool {
    std::optional<core::ToolNumber> tool;

    bool operator==(const NameTool&) const = default;
};
struct Spindle {
    core::SpindleDirection direction;
    double speed; // rev/min; m/min under G96

    bool operator==(const Spindle&) const = default;
};
struct Coolant {
    bool mist, flood;

    bool operator==(const Coolant&) const = default;
};
struct SelectPlane {
    Plane plane;

    bool operator==(const SelectPlane&) const = default;
};
/// A work offset, G52 or G92 changed, or another work offset was activated.
struct SetOffset {
    Offsets offsets; // all active offsets after the change
    // The control is told, and LinuxCNC waits for the end of the motion before it. Not so if only
    // a parameter is written or the offset was in use, nor where that is not certain.
    bool is_told = false;

    bool operator==(const SetOffset&) const = default;
};
struct UseToolLengthOffset {
    std::optional<core::OffsetNumber> number; // empty: G49, or a length without a number (G43.1)
    AxisValues offset;                        // mm and degrees; the length is along Z
    bool follows_tip = false;                 // G43.4, G43.5
    bool is_assumed = false;                  // nobody states the length under this number

    bool operator==(const UseToolLengthOffset&) const = default;
};
struct UseSpindleMode {
    bool surface_speed;   // G96; false: G97
    double speed;         // m/min, or rev/min
    double fastest_speed; // rev/min; 0: no limit

    bool operator==(const UseSpindleMode&) const = default;
};
struct SetPathMode {
    PathMode mode;
    double tolerance, naive_tolerance; // mm
    CornerTolerances corners = {};

    bool operator==(const SetPathMode&) const = default;
};
enum class OverrideKind : uint8_t { feed, speed, adaptive_feed, feed_hold };
struct EnableOverride {
    OverrideKind kind;
    bool enabled;

    bool operator==(const EnableOverride&) const = default;
};
struct SetOutput {
    int number;
    double value;
    bool is_analog;
    bool with_motion; // with the next motion; otherwise immediately

    bool operator==(const SetOutput&) const = default;
};
struct WaitForInput {
    int number;
    bool is_analog;
    double seconds; // 0: does not wait

    bool operator==(const WaitForInput&) const = default;
};
/// A message of the program to the operator.
struct Message {
    std::string text;

    bool operator==(const Message&) const = default;
};
struct ProgramStop {
    bool operator==(const ProgramStop&) const = default;
};
struct OptionalStop {
    bool operator==(const OptionalStop&) const = default;
};
struct ProgramEnd {
    bool operator==(const ProgramEnd&) const = default;
};

using CanonicalCommand =
    std::variant<StraightTraverse, StraightFeed, ArcFeed, StraightProbe, ThreadFeed, Dwell,
                 SelectTool, ChangeTool, NameTool, Spindle, UseSpindleMode, Coolant, SelectPlane,
                 SetOffset, UseToolLengthOffset, SetPathMode, EnableOverride, SetOutput,
                 WaitForInput, Message, ProgramStop, OptionalStop, ProgramEnd>;

/// The command for the path mode of a modal state.
inline SetPathMode path_mode_of(const ModalState& modal) {
    return {modal.path, modal.path_tolerance, modal.naive_tolerance, modal.corner_tolerances};
}

/// Whether a command moves axes: a rapid, a feed, an arc, a probing move or a thread.
bool is_motion(const CanonicalCommand& command);

/// The name of a command in traces: straight_traverse, arc_feed, change_tool ...
std::string_view command_name(const CanonicalCommand& command);

/// G54 to G59.3, then "G54.1 P1" and up; G500 for no offset.
std::string name_of_offset(size_t index);

/// The same as a Siemens control has it: "G505" and up after G57.
std::string siemens_name_of_offset(size_t index);

/// The index of a work offset by its name on any control: also "G154 P7", and Siemens' G505 to
/// G599.
std::optional<size_t> offset_of_name(std::string_view name);

/// XY, ZX, YZ, UV, WU or VW.
std::string_view name_of(Plane plane);

/// What the interpreter can say of a remark. Whether a rule is off or an error depends on the
/// set-up.
enum class Severity : uint8_t { note, warning };

/// The rule of a remark that has none of its own.
constexpr std::string_view rule_of_remarks = "program";

/// A remark about a block that does not stop the program. Traces print it with its line and column;
/// a check turns it into a core::Finding, with the severity that the set-up gives its rule, which
/// the interpreter does not know.
struct Warning {
    Severity severity;
    core::SourceSpan where;
    std::string message;
    std::string_view rule = rule_of_remarks; // stable name of the rule
    std::string cure{};                      // may be empty

    bool operator==(const Warning&) const = default;
};

/// One block as executed.
struct BlockCommands {
    core::BlockIndex block{};
    uint32_t line = 0;
    std::string_view text{}; // the line. Valid as long as the library is not moved; in a program
                             // read in windows, until the next block
    std::string_view file{}; // file of a subprogram; empty for the main program
    std::vector<uint32_t> calls{}; // lines of the calls that led here, outermost first
    bool is_cycle = false;         // a canned cycle, G28 or G30: one block, several motions
    bool goes_home = false;        // G28 or G30
    bool in_machine = false;       // moves to machine coordinates: G53, SUPA, M91
    core::PathCertainty path = core::PathCertainty::known;
    std::vector<CanonicalCommand> commands{};
    std::vector<uint32_t> columns{}; // of the words that produced the commands
    // Of each command, the axes that it brings to a known position although a probing move ended at
    // an unknown point; empty while the position is known.
    std::vector<core::AxisSet> settled{};
    std::vector<Warning> warnings{};
    std::shared_ptr<const std::string> own_text{}; // owns `text` when the windows have moved on

    bool operator==(const BlockCommands&) const = default;
};

} // namespace gcode
