#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/sim/finding.h"
#include "core/sim/verdict.h"
#include "render/palette.h"

namespace app {
struct BlockFacts;
struct CheckedBlock;
} // namespace app

namespace core {
struct Setup;
}

namespace app::viewer {

/// The names of two bodies: one on the spindle side, and the stock or a fixture.
using BodyNames = std::array<std::string, 2>;

/// Where the two bodies of a pair are nearest, or first collide.
struct PairWitness {
    BodyNames names;
    core::Vec3 on_tool = core::Vec3(0.0); // frame of the stock
    core::Vec3 on_body = core::Vec3(0.0);
    double time = 0.0; // seconds after the block's start
    core::Verdict verdict = core::Verdict::clear;
};

/// An executed block as the panels show it. A copy, because the thread of the window must not read
/// the record, to which another thread adds blocks; and a small one, without events and clear
/// pairs.
struct BlockRow {
    uint32_t line = 0;
    std::string text;
    std::string file;   // of the subprogram; empty for the main program
    uint32_t depth = 0; // of subprogram calls
    core::BlockMotion motion = core::BlockMotion::none;
    std::optional<core::ToolNumber> tool; // in the spindle after the block
    double time = 0.0;                    // at its start, seconds
    double duration = 0.0;                // seconds
    double removed = 0.0;                 // mm3
    bool is_known = false; // true once checked; until then all members below are empty
    bool is_judged = true; // false: the block moves, but could not be checked
    core::Verdict verdict = core::Verdict::clear;
    std::optional<double> lower, upper;   // clearance, mm; upper is empty beyond the search limit
    std::optional<double> allowance;      // of the deciding pair, mm
    std::string part, body;               // of the deciding pair
    core::Vec3 on_tool = core::Vec3(0.0); // witness, frame of the stock
    core::Vec3 on_body = core::Vec3(0.0);
    double witness_time = 0.0;            // seconds after the block's start
    std::optional<core::Overlap> overlap; // of the deciding pair, if it collides and was measured
    std::vector<PairWitness> others;      // of other pairs that are not clear
    core::Severity worst = core::Severity::off; // of the findings about the block

    bool has_pair() const { return upper.has_value(); }
    bool has_witness() const { return upper.has_value(); }
};

/// The row of a checked block.
BlockRow row_of(const core::Setup& setup, const CheckedBlock& checked);

/// The witness of the pair with these names, else that of the deciding pair; empty if the block has
/// none.
std::optional<PairWitness> witness_in(const BlockRow& row, const BodyNames& names);

/// The facts of a row for conditions: only the deciding pair, no findings (the window has a
/// separate list of them) and no values of the control.
BlockFacts facts_of(const BlockRow& row, size_t block);

/// Whether the block moves anything.
inline bool moves(const BlockRow& row) { return row.motion != core::BlockMotion::none; }

/// Whether the block moves otherwise than by rapids alone.
inline bool feeds(const BlockRow& row) {
    return moves(row) && row.motion != core::BlockMotion::rapid;
}

/// Whether the key N stops at the block: it has an error, or is not proven clear.
inline bool is_offending(const BlockRow& row) {
    return row.worst == core::Severity::error || row.verdict != core::Verdict::clear;
}

/// Whether the bodies touch as intended: cutting, or contact of a pair that may touch.
inline bool is_contact(const BlockRow& row) {
    return row.is_known && row.verdict == core::Verdict::clear && row.upper
           && *row.upper <= core::resolution && row.allowance && *row.allowance <= core::resolution;
}

/// Whether the clearance is between the allowance and twice the allowance.
bool is_near(const BlockRow& row);

/// The state that gives the block its colour in all panels.
render::ClearanceState state_of(const BlockRow& row);

} // namespace app::viewer
