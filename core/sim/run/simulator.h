#pragma once

#include <array>
#include <memory>
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

class CutReplay;
struct Setup;

/// What the trials of cures have used so far. A plain value.
struct TrialMemory {
    std::shared_ptr<const CutModel> raw;   // the uncut stock; empty: not needed yet
    std::shared_ptr<const CutModel> stock; // as it was before an earlier block; empty: none yet
    std::vector<Pair> studied;             // whose overlaps were measured or whose cures were tried
    size_t work = 0;                       // tests made by trials
};

/// State of a run between two blocks. A plain value: copy it to step back.
struct SimulatorState {
    CutModel stock; // without what undecided blocks may have removed from it
    /// The stock that is certainly left: `stock` less what undecided blocks may have removed. Empty
    /// before the first such block.
    std::optional<CutModel> certain_stock;
    std::optional<ToolNumber> tool;     // tool in the spindle; empty: none, or unknown
    bool tool_known = false;            // a tool or an empty spindle was called
    AxisPosition position;              // at the end of the last motion
    AxisSpread spread;                  // around `position`, since a probing move
    std::vector<bool> mounted_fixtures; // whether each fixture of the set-up is mounted
    SpindleChange spindle;
    LengthOffsetChange length_offset;
    bool height_is_assumed = false; // Z was reached by a length that nobody states
    PieceTracker pieces;            // of the stock
    CentreTracker centre;           // of a tool that does not cut at its centre
    RunRules rules;
    double time = 0.0; // seconds since the program's start, without accelerations
    Statistics statistics;
    CheckMemory memory;
    RoundedCorners corners;
    TrialMemory trials;
    std::set<std::string> assumptions; // assumptions made so far
    bool reported_unknown_start = false;
    std::array<bool, 3> is_assumed{};     // X, Y, Z: not moved yet from an assumed start position
    bool reported_unchecked_tool = false; // for the tool now in the spindle
};

/// Whether the spindle turns in the cutting direction of the tool, at more than 0 rev/min.
bool turns_to_cut(const SpindleChange& spindle, const ToolAssembly& tool);

/// Whether the tool can cut in the direction of a motion: a drill cuts only along its axis. Motions
/// in which rotary axes move are assumed to be in a cutting direction.
bool cuts_along(const ToolAssembly& tool, const Motion& motion);

/// Whether a tool leaves what it has cut when it goes straight up: flutes and shank get no narrower
/// upwards, or it only drills. Above the head of a T-slot cutter there may be stock.
bool leaves_its_cut_upwards(const ToolAssembly& tool);

/// Input of a run for one block.
struct BlockEvents {
    BlockIndex block{};
    bool is_cycle = false; // several motions in one block: a canned cycle, G28
    std::span<const Event> events;
    bool goes_home = false;  // G28 or G30
    bool in_machine = false; // moves to machine coordinates: G53
    PathCertainty path = PathCertainty::known;
    // Replaces measuring: the stock is still cut, and rules that need no clearance still apply.
    const Judgement* judgement = nullptr;
    bool is_trial = false;       // of a cure: no depths and cures, and no rules that span blocks
    CutReplay* replay = nullptr; // makes the cuts of the state's stock, if they are prepared
    unsigned threads = 1;        // for large cuts
};

/// The state before the first block, with the machine at `position`.
///
/// Errors: those of make_cut_model, for a stock that cannot be modelled.
Result<SimulatorState> start_of_run(const Setup& setup, const AxisPosition& position);

/// Runs one block: moves, cuts, measures. The set-up must outlive the result.
BlockResult run_block(const Setup& setup, const BlockEvents& block, SimulatorState& state);

/// Findings that are only known after the last block, each with the block that it is about.
std::vector<Finding> end_of_run(const Setup& setup, SimulatorState& state);

} // namespace core
