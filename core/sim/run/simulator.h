#pragma once

#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/dbm/cut_model.h"
#include "core/motion/event.h"
#include "core/sim/block_result.h"
#include "core/sim/clearance.h"
#include "core/sim/leg/check_memory.h"
#include "core/sim/rules/rules.h"

namespace core {

struct Setup;

/// Everything a run leaves behind for its next block. A plain value: copy it to go back in time.
struct SimulatorState {
    CutModel stock;
    std::optional<ToolNumber> tool;   // what is in the spindle; empty: nothing, or nobody knows
    bool tool_known = false;          // something was called, if only an empty spindle
    AxisPosition position;            // where the last motion ended
    std::vector<bool> fixtures_there; // of the set-up's fixtures
    SpindleChange spindle;
    LengthOffsetChange length_offset;
    PieceWatch pieces;  // of the stock
    CentreWatch centre; // of a tool that does not cut there
    RunWatch watch;
    double time = 0.0; // seconds since the program's start, everything at full speed
    Statistics statistics;
    CheckMemory memory;
    RoundedCorners corners;
    std::set<std::string> assumptions; // what had to be taken for granted on the way
    bool told_unknown_start = false;
    bool told_unchecked_tool = false; // of the tool that is in the spindle now
};

/// Whether the spindle turns, the way round that the tool cuts. At 0 rev/min it stands.
bool turns_to_cut(const SpindleChange& spindle, const ToolAssembly& tool);

/// Whether the tool cuts the way a motion goes: a drill cuts along its axis alone. Motions on which
/// rotary axes move are taken to go such a way.
bool cuts_along(const ToolAssembly& tool, const Motion& motion);

/// What a run needs to know of a block.
struct BlockEvents {
    BlockIndex block{};
    bool is_cycle = false; // one block with several motions: a canned cycle, G28
    std::span<const Event> events;
    bool goes_home = false; // G28 or G30
    // In place of measuring: the stock is cut, and rules that need no clearance are told.
    const Judgement* judgement = nullptr;
};

/// The state before the first block, with the machine at `position`.
///
/// Errors: those of make_cut_model, for a stock that cannot be modelled.
Result<SimulatorState> start_of_run(const Setup& setup, const AxisPosition& position);

/// Carries out one block: moves, cuts, measures. The set-up must outlive the result.
BlockResult run_block(const Setup& setup, const BlockEvents& block, SimulatorState& state);

/// What can only be told behind the last block, each finding with the block that it is about.
std::vector<Finding> end_of_run(const Setup& setup, SimulatorState& state);

} // namespace core
