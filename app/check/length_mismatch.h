#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/sim/finding.h"

namespace core {
struct BlockEvents;
struct Setup;
struct SimulatorState;
} // namespace core
namespace gcode {
struct Warning;
}

namespace app {

struct CheckRecord;
struct CheckReport;

/// Blocks in which the tool is lower than intended because the control uses a length that is too
/// short.
struct LengthMismatch {
    core::BlockIndex first{}, last{};         // the first has the finding that names the cause
    double too_low = 0.0;                     // mm
    double length = 0.0;                      // true length of the tool, mm
    std::optional<core::OffsetNumber> number; // of the offset with the wrong length
    // Blocks up to this one were also run with the true length, and gave these findings.
    std::optional<core::BlockIndex> corrected_to;
    std::vector<core::Finding> remaining;
};

/// The length mismatches of a program so far. A plain value.
struct LengthTracker {
    std::vector<LengthMismatch> mismatches;
    bool is_open = false; // the last of them continues
};

/// Updates the mismatches before a block is run, and sets `length_in_doubt` of the state.
void track_length(LengthTracker& tracker, const core::Setup& setup, const core::BlockEvents& block,
                  std::span<const gcode::Warning> warnings, core::SimulatorState& state);

/// Updates the mismatches after the user changed the tool's length or its offset between two
/// blocks.
void track_changed_length(LengthTracker& tracker, const core::Setup& setup,
                          core::SimulatorState& state);

/// Combines the findings that a wrong length causes into one: collisions and near misses until the
/// next length or tool call that do not occur with the tool's true length. The finding of the rule
/// `missing-length-offset`, `length-offset-cancelled` or `offset-not-tool` then states the number
/// of blocks; if its severity is lower than theirs, one of them stays and states it. A rule that is
/// off combines nothing. Blocks keep their verdicts, and `report.combined_findings` holds the
/// findings that were combined.
void combine_consequences(CheckRecord& record, CheckReport& report,
                          const std::vector<LengthMismatch>& mismatches);

} // namespace app
