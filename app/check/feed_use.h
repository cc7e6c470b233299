#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/sim/finding.h"

namespace core {
struct BlockEvents;
struct Setup;
struct SimulatorState;
} // namespace core
namespace gcode {
struct ModalState;
struct Offsets;
} // namespace gcode

namespace app {

/// A tool whose length in the control is not its true length.
struct LengthError {
    core::ToolNumber tool{};
    std::optional<core::OffsetNumber> number; // of the length offset; empty: it has none
    double counted = 0.0, length = 0.0;       // in the control, and true, mm

    /// How much higher the tip is than the control counts, mm; negative: lower.
    double higher() const { return counted - length; }
};

/// Where the feeds of a program in one work offset are, relative to the stock.
struct OffsetUse {
    // The first feed of all, and those above, below and beside the stock.
    std::optional<core::BlockIndex> first, above_block, below_block, beside_block;
    double total = 0.0;              // travel of all feeds, mm
    double way = 0.0;                // of this, within the stock's outline in XY
    double above = 0.0, below = 0.0; // of this, above and below the stock
    // Of `above` and `below`, where the tip would not be if the control had its true length.
    double above_by_length = 0.0, below_by_length = 0.0;
    std::optional<LengthError> length_error; // of the first of these feeds
    double beside = 0.0;                     // of `total`, with the flutes beside the outline
    double lowest = core::infinity,
           highest = -core::infinity;        // Z of the feeds above or below, from the datum, mm
    double highest_bottom = -core::infinity; // the highest of the lowest points of these feeds,
                                             // frame of the stock
    double under = core::infinity; // least distance of feeds below the stock from its bottom
    double gap = core::infinity;   // lower bound of the distance of the flutes to the stock and to
                                   // expendable fixtures, mm
    core::Aabb feeds;              // box of the tip on all feeds, frame of the stock
    core::Vec3 datum = core::Vec3(0.0); // zero of the work offset, frame of the stock
    bool is_parallel = true;            // false: the program's axes are turned against the stock's
    bool rapids_through = false;        // a rapid crosses the stock's height range, not upwards
    bool is_upright = true;             // false: the tool was tilted
};

/// The uses of all work offsets so far, by index; 0 is G54. A plain value.
using OffsetUses = std::map<size_t, OffsetUse>;

/// Adds the feeds and rapids of a block. `offsets` are those with which it moved, and `state` is
/// the state after it.
void track_offsets(OffsetUses& uses, const core::Setup& setup, const gcode::Offsets& offsets,
                   const core::BlockEvents& block, const core::SimulatorState& state);

/// The findings `offset-implausible`: work offsets in which nearly all feeds are beside the stock,
/// above it, or below it by more than cutting through needs or together with rapids at its height.
/// The datum was probably set elsewhere; or the tool's length in the control is wrong, if the cuts
/// would be at the stock with the true one. If the program cuts the stock in another work offset,
/// the one beside it may belong to a second workpiece, and the finding is a note.
std::vector<core::Finding> implausible_offsets(const OffsetUses& uses, const core::Setup& setup,
                                               const core::Aabb& stock);

/// The finding `nothing-cut`: the program feeds with a tool that turns, but no flutes come near the
/// stock in any work offset. `is_located`: another finding says where the cuts are.
std::optional<core::Finding> nothing_cut(const OffsetUses& uses, const core::Setup& setup,
                                         const core::Aabb& stock, bool is_located);

/// A value and the block in which it first occurs.
struct ValueInBlock {
    double value = 0.0;
    core::BlockIndex block{};
};

/// What the feeds of a program have in common. A plain value.
struct FeedFacts {
    core::Aabb box; // of all feeds, machine coordinates of the gauge line
    std::optional<core::BlockIndex> first;
    std::optional<ValueInBlock> fastest;  // feed, mm/min
    std::optional<ValueInBlock> too_fast; // first feed above the rapid speed of the machine, mm/min
    double possible = 0.0;                // the fastest feed on the path of `too_fast`, mm/min
    std::optional<ValueInBlock> speed;    // greatest spindle speed, rev/min
    std::optional<ValueInBlock> edge_speed;             // greatest speed of a cutting edge, m/min
    std::map<core::ToolNumber, core::BlockIndex> tools; // that feed, with their first feeds
    double sideways = 0.0;                 // greatest feed across the tool axis, mm/min
    double cut_way = 0.0;                  // travel of feeds with a stated spindle speed, mm
    double revolutions = 0.0;              // of the spindle on these feeds
    bool in_mm = false, in_inches = false; // units in effect at feeds
    bool moves = false;                    // some motion is not an incremental one by 0
};

/// Adds the motions of a block. `modal` and `state` are those after it.
void note_feeds(FeedFacts& facts, const core::Setup& setup, const gcode::ModalState& modal,
                const core::BlockEvents& block, const core::SimulatorState& state);

} // namespace app
