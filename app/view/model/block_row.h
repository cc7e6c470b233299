#pragma once

#include <optional>
#include <string>

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
namespace app {
struct CheckedBlock;
}

namespace app::viewer {

/// What the panels show of a block as executed. Plain, so that it can go from thread to thread.
struct BlockRow {
    uint32_t line = 0;
    std::string text;
    std::string file;   // of a subprogram's file; empty for the main program
    uint32_t depth = 0; // of calls
    core::BlockMotion motion = core::BlockMotion::none;
    std::optional<core::ToolNumber> tool; // in the spindle after it
    double time = 0.0;                    // of its start, seconds
    double duration = 0.0;                // seconds
    double removed = 0.0;                 // mm3
    bool is_known = false;                // the check has been here; all below is empty until then
    bool is_judged = true;                // false: it moves, but nothing can be said of it
    core::Verdict verdict = core::Verdict::clear;
    std::optional<double> lower, upper;   // clearance, mm; upper is empty beyond the search limit
    std::optional<double> allowance;      // that the deciding pair must keep, mm
    std::string part, body;               // of the deciding pair
    core::Vec3 on_tool = core::Vec3(0.0); // witness, frame of the stock
    core::Vec3 on_body = core::Vec3(0.0);
    double witness_time = 0.0;                  // seconds after the block's start
    core::Severity worst = core::Severity::off; // of the findings about it

    bool has_pair() const { return upper.has_value(); }
    bool has_witness() const { return upper.has_value(); }
};

/// The row of a block that was checked.
BlockRow row_of(const core::Setup& setup, const CheckedBlock& checked);

/// What a condition can ask of a row. Pairs other than the deciding one are not in it, nor findings
/// (the window has them in a list of their own), nor anything of the control.
BlockFacts facts_of(const BlockRow& row, size_t block);

/// Whether anything moves in it.
inline bool moves(const BlockRow& row) { return row.motion != core::BlockMotion::none; }

/// Whether N stops at it: an error was found in it, or its allowance is not proven to be kept.
inline bool is_offending(const BlockRow& row) {
    return row.worst == core::Severity::error || row.verdict != core::Verdict::clear;
}

/// Whether it keeps its allowance, but not twice.
bool is_near(const BlockRow& row);

/// How it is coloured wherever it is drawn.
render::ClearanceState state_of(const BlockRow& row);

} // namespace app::viewer
