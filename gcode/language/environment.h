#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "gcode/language/dialect.h"
#include "gcode/language/modal_state.h"
#include "gcode/language/tables.h"

namespace gcode {

/// How long and how deep a program may run.
struct Limits {
    uint64_t blocks = 50'000'000;
    size_t calls = 0;                      // 0: the limit of the control
    std::function<bool()> is_stopped = {}; // by the user; polled from time to time
};

/// The control before the program starts. Lengths in mm, positions in machine coordinates.
struct Environment {
    DialectId dialect = DialectId::linuxcnc;
    bool block_delete = false;                // true: blocks with `/` are skipped
    LengthUnit machine_unit = LengthUnit::mm; // in which LinuxCNC keeps offsets and starts
    std::array<AxisValues, plain_offset_count> work_offsets{};
    std::map<core::OffsetNumber, LengthOffset> length_offsets{};
    std::map<core::ToolNumber, double> tool_lengths{};   // for H numbers without an entry
    std::map<core::ToolNumber, double> tool_diameters{}; // for D numbers without an entry
    Position start{};                                    // gauge line; X, Y, Z empty if unknown
    std::optional<AxisValues> home{};                    // G28; machine zero if not stated
    std::optional<AxisValues> second_home{};             // G30; likewise
    bool counts_smallest_steps = false;         // X5 is 5 um, X5. is 5 mm, where points matter
    std::map<int, double> parameters{};         // numbered ones, as in a variables file
    std::map<std::string, double> ini_values{}; // LinuxCNC's ini file, by names as _ini[traj]x
    std::vector<std::string> search_path{};     // folders of subprograms; else the program's own
    std::set<int> known_m_codes{};              // of the machine builder, ignored without a warning
    Limits limits{};
    std::shared_ptr<const core::Machine> machine{}; // only if it has rotary axes
};

} // namespace gcode
