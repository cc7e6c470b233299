#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "gcode/language/modal_state.h"
#include "gcode/language/tables.h"

namespace gcode {

enum class DialectId : uint8_t;

/// Limits on the run of a program.
struct Limits {
    uint64_t blocks = 50'000'000;
    size_t calls = 0;                      // 0: the limit of the control
    std::function<bool()> is_stopped = {}; // cancelled by the user; polled from time to time
};

/// The state of the control before the program starts. Lengths in mm, positions in machine
/// coordinates.
struct Environment {
    DialectId dialect{};                      // LinuxCNC
    bool block_delete = false;                // true: blocks with `/` are skipped
    LengthUnit machine_unit = LengthUnit::mm; // unit of LinuxCNC's offsets and start positions
    std::array<AxisValues, plain_offset_count> work_offsets{};
    std::map<core::OffsetNumber, LengthOffset> length_offsets{};
    std::map<core::ToolNumber, double> tool_lengths{};   // for H numbers not in the table
    std::map<core::ToolNumber, double> tool_diameters{}; // for D numbers not in the table
    Position start{};                                    // gauge line; X, Y, Z empty if unknown
    std::optional<AxisValues> home{};                    // G28; machine zero if not stated
    std::optional<AxisValues> second_home{};             // G30; likewise
    bool counts_smallest_steps = false; // X5 is 5 um and X5. is 5 mm, where the point matters
    std::map<int, double> parameters{}; // numbered ones, as in a variables file
    std::map<std::string, double> ini_values{}; // LinuxCNC's ini file, by names such as _ini[traj]x
    std::vector<std::string> search_path{}; // folders of subprograms; empty: the program's folder
    std::set<int> known_m_codes{};          // of the machine builder; ignored without a warning
    Limits limits{};
    std::shared_ptr<const core::Machine> machine{}; // only if the machine has rotary axes
};

} // namespace gcode
