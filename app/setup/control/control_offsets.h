#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/base/result.h"
#include "core/motion/event.h"

namespace gcode {
enum class DialectId : uint8_t;
enum class LengthUnit : uint8_t;
} // namespace gcode

namespace app {

struct SetupFile;

/// A value that a control has stored, and the file and line that state it.
struct ControlValue {
    double value = 0.0; // mm or degrees
    bool in_inches = false;
    std::string file{};
    uint32_t line = 0;
};

/// An origin in machine coordinates; axes that no file states are empty.
struct ControlOrigin {
    std::array<std::optional<ControlValue>, core::axis_count> axes{};
    std::optional<ControlValue> rotation_deg{};
};

/// A number of the control's table of tool offsets.
struct ControlToolOffset {
    std::optional<ControlValue> length, wear;            // along the tool
    std::optional<ControlValue> diameter, diameter_wear; // of the cutter
};

/// What a control has stored, as far as files from it state it.
struct ControlOffsets {
    std::map<size_t, ControlOrigin> work; // by index, 0 is G54
    ControlOrigin external;               // Fanuc: added to all work offsets
    ControlOrigin shift;                  // LinuxCNC: that of G92, while it is on
    std::map<core::OffsetNumber, ControlToolOffset> tools;
    std::vector<std::string> notes; // for the user
};

/// How the control writes numbers that do not say it themselves.
struct ControlReading {
    gcode::DialectId dialect{};
    gcode::LengthUnit unit{}; // of files that state none
    bool unit_is_stated = false;
    bool sizes_are_radii = false;       // under D, in G10 L12 and in files of Haas
    bool counts_smallest_steps = false; // X1000 without a point is 1000 least increments
    double step_mm = 0.001, step_inch = 0.0001, step_deg = 0.001; // the least increment
};

/// How to read the files of the control that a set-up describes. `program_unit` counts where the
/// set-up states no unit.
ControlReading reading_of(const SetupFile& setup, gcode::LengthUnit program_unit);

/// Reads the offsets in files from a control: LinuxCNC's variables (.var) and tool table (.tbl),
/// blocks with G10 as Fanuc and Haas write them, Haas's tool offsets (.ofs). The kind of a file is
/// recognised by its content. Where several values are given for the same entry, the last counts,
/// with a note.
///
/// Errors: io if a file cannot be read; syntax, with file, line and column, for a file of another
///         kind or with a value that is not a number.
core::Result<ControlOffsets> read_control_offsets(const std::vector<std::string>& paths,
                                                  const ControlReading& reading);

} // namespace app
