#pragma once

#include <set>
#include <span>

#include "core/dbm/cut_model.h"
#include "core/motion/path.h"
#include "core/sim/clearance.h"
#include "core/sim/finding.h"
#include "core/sim/leg/leg_check.h"
#include "core/sim/rules/centre_watch.h"
#include "core/sim/rules/loose_pieces.h"
#include "core/sim/rules/stick_out.h"

namespace core {

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
inline bool turns_to_cut(const SpindleChange& spindle, const ToolAssembly& tool) {
    return spindle.direction == tool.description.cuts && spindle.speed > 0.0;
}

/// Whether the tool cuts the way a motion goes: a drill cuts along its axis alone. Motions on which
/// rotary axes move are taken to go such a way.
bool cuts_along(const ToolAssembly& tool, const Motion& motion);

/// What a block did and how near it came.
struct BlockResult {
    BlockMotion motion = BlockMotion::none;
    std::optional<ToolNumber> tool;
    double time = 0.0;     // of its start, seconds, at full speed unless settle_time was called
    double duration = 0.0; // seconds, likewise
    double removed = 0.0;  // mm3
    bool checked = true;   // false: it moves, but nothing can be said about its clearance
    Verdict verdict = Verdict::clear;
    std::vector<PairClearance> pairs;
    std::optional<size_t> deciding; // the pair that the report shows; empty beyond the limit
    std::vector<Finding> findings;
};

/// What somebody other than the distance core says of a block.
struct Judgement {
    Verdict verdict = Verdict::clear;
    std::vector<PairClearance> pairs = {}; // that were looked at
    std::optional<Finding> finding = {};   // its severity is left open
    bool checked = true;                   // false: nothing can be said about its clearance
    bool runs_into_stock = false;          // with flutes that do not cut
};

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
