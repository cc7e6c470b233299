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

struct CheckRun;

/// Blocks in which the tool stands lower than meant, because the control counts with a shorter
/// length than the tool has.
struct LengthMismatch {
    core::BlockIndex first{}, last{};         // the first has the finding that says why
    double too_low = 0.0;                     // mm
    double length = 0.0;                      // that the tool has, mm
    std::optional<core::OffsetNumber> number; // under which the control finds another
    std::optional<core::BlockIndex> cured_to; // up to here the blocks were run with that length
    std::vector<core::Finding> left;          // and this was found, and about offsets
};

/// What is known of the lengths that a program counts with. A plain value.
struct LengthWatch {
    std::vector<LengthMismatch> doubts;
    bool is_open = false; // the last of them goes on
};

/// Takes a block into account before it is run, and tells the state whether the control's length is
/// in doubt.
void watch_length(LengthWatch& watch, const core::Setup& setup, const core::BlockEvents& block,
                  std::span<const gcode::Warning> warnings, core::SimulatorState& state);

/// Takes into account that the tool's length, or the one that the control counts with, was changed
/// between two blocks.
void watch_changed_length(LengthWatch& watch, const core::Setup& setup,
                          core::SimulatorState& state);

/// Makes one finding of all that comes of a wrong length: what the tool runs into or passes too
/// near from there on, until another length or tool is called, and keeps away from with the length
/// that it has. What is found of the same bodies with that length, too, stays by itself. The
/// finding of the rule `missing-length-offset`, `length-offset-cancelled` or `offset-not-tool` says
/// how many blocks these are; where its severity is milder than theirs, one of them stays as well
/// and says it. A rule that is switched off takes in nothing. Blocks keep their verdicts, and the
/// run keeps what was taken in as `taken_in`.
void gather_consequences(CheckRun& run, const std::vector<LengthMismatch>& doubts);

} // namespace app
