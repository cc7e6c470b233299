#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/dbm/cut_model.h"
#include "core/dbm/stock_pieces.h"
#include "core/sim/finding.h"

namespace core {

struct Leg;
struct Machine;
struct Motion;
struct Setup;
struct RelativeLeg;
struct ToolAssembly;
struct ToolDescription;
struct TrackedPair;

/// Flutes that keep farther than this from the stock are in the air, mm; nearer they may be on a
/// spring pass.
constexpr double air_gap = 0.5;

/// Motions of one tool in a row, rapids between them not counted, that feed through nothing but
/// air. A plain value.
struct AirSeries {
    std::optional<BlockIndex> begin;
    double way = 0.0; // mm
    size_t blocks = 0;
    std::optional<BlockIndex> last;
};

/// A feed of this length that kept away from the stock.
void add_air(AirSeries& series, BlockIndex block, double way);

/// Ends a series, and gives the finding `air-cut` about it, with its first block, if it is longer
/// than the ways in and out of a cut by a tool of this diameter. Its severity is left open.
std::optional<Finding> end_air(AirSeries& series, double diameter);

/// Where a tool is too short for what it does, over all blocks so far. A plain value.
struct ToolReach {
    std::optional<BlockIndex> holder_block; // the first in which the holder meets the stock
    double more_stick_out = 0.0;            // mm that the holder would have to stand higher
    std::optional<BlockIndex> shank_block;  // the first in which the shank does
    double more_flute = 0.0;                // mm that the shank would have to begin higher
    std::optional<BlockIndex> rub_block;    // the first in which the shank only touches
    size_t blocks = 0;                      // in which holder or shank meet the stock
    size_t looks = 0;                       // at how long it would have to be; then no more
    std::optional<BlockIndex> last;
};

using ToolReaches = std::map<ToolNumber, ToolReach>;

/// A leg of the run, with what a rule needs to check it again with other tool positions.
struct LegAsRun {
    const Setup& setup;
    const ToolAssembly& tool;
    BlockIndex block;
    const Leg& leg;
    const std::vector<bool>& fixtures_there;
    const CutModel& stock; // note_reach: after the leg; low_retract: before it
};

/// Notes whether holder and shank met the stock on a leg that the flutes cut, and how much higher
/// they would have to stand to keep every allowance on it.
///
/// Cost: nothing for a leg on which they keep away; else, where they have to stand higher than on
///       any leg before, some ten checks of the leg.
void note_reach(ToolReaches& reaches, const LegAsRun& cut, const std::vector<TrackedPair>& pairs);

/// The findings `stick-out-short` and `over-engagement`, one of each for a tool, with the first
/// block that they are about and what would do for all blocks. Severities are left open but for a
/// shank that only rubs, which is a note.
std::vector<Finding> findings_of(const ToolReaches& reaches, const Setup& setup);

/// What rules that look at more than one block remember. A plain value.
struct RunWatch {
    AirSeries air;
    ToolReaches reaches;
    bool has_fed = false;           // the tool that is in the spindle now
    bool singular_reported = false; // of the same tool, singular-orientation
    // The control counts with another length than the tool's: how deep the tool goes then says
    // nothing of its stick-out. Whoever runs the blocks knows that and sets it.
    bool length_in_doubt = false;
};

/// Whether a leg goes across far enough to be a way from one feature to another.
bool goes_across(const Leg& leg);

/// The finding `low-retract`: the tool is free where the rapid begins and where it ends, but not of
/// what stands between, or passes over it by less than half a millimetre. `pairs` are what was
/// found on the leg. Its severity is left open.
///
/// Cost: nothing where the rapid passes well clear; else some twenty checks of the leg.
std::optional<Finding> low_retract(const LegAsRun& link, const std::vector<TrackedPair>& known);

/// What is known about the pieces of a stock while it is cut. A plain value.
struct PieceWatch {
    PieceMap map;
    size_t known = 1; // pieces, without crumbs
};

/// The watch over a stock at the start of a run.
PieceWatch watch_of(const CutModel& stock);

/// Looks, with these of the fixtures in place, whether the cuts from `first` on, by their numbers
/// in the log, have parted the stock.
///
/// Result: a finding `loose-piece` for each new piece but the largest, without its block: how large
///         it is, where, and whether a fixture touches it, to within a mesh size.
/// Cost:   some microseconds for cuts above solid matter, else that of PieceMap::pieces().
std::vector<Finding> watch_pieces(const Setup& setup, const std::vector<bool>& fixtures_there,
                                  const CutModel& stock, size_t first, PieceWatch& watch);

/// What has to be remembered of a tool that does not cut at its centre while it goes down: how the
/// stock stood before, and where the tool has been since.
///
/// Frame: places are those of the tip, along the tool's own axes.
struct CentreWatch {
    std::optional<CutModel> before;
    Mat3 orientation = Mat3(1.0);
    double top = 0.0;        // height at which it began to go down
    std::vector<Vec3> trail; // the last of it, as far as it is within the recess of the lowest
};

/// Where on a leg the centre of a tool is pushed into matter that its edges have not taken.
struct CentreContact {
    double share = 0.0;     // of the leg
    Vec3 place = Vec3(0.0); // of the tool's face there, in the stock's frame
};

/// How far the face of such a tool stands back from its edges, mm. With it the steepest ramp that
/// is still taken for cutting falls by recess / (2 * centre_radius): some 7 degrees.
double centre_recess(const ToolDescription& tool);

/// Follows a feed along one leg; `stock` is as it is before the leg. Call it for every leg of such
/// a tool, in order.
///
/// Proof: a tool that goes down meets a point at the height of its face for the first time when its
/// tip passes there. If the point has been under the centre ever since, no edge has come by.
std::optional<CentreContact> follow(CentreWatch& watch, const ToolDescription& tool,
                                    const RelativeLeg& leg, const CutModel& stock);

/// The finding `singular-orientation` about a feed on which rotary axes turn: near the pole, where
/// an axis turns far while the tool hardly leans and its tip hardly moves; or, where the control
/// does not follow the tip, a block of several rotary axes that is so long that the tip swings off
/// its line by more than 0.5 mm. Severity and block are left open.
std::optional<Finding> singular_orientation(const Machine& machine, const Motion& motion,
                                            double tool_length);

} // namespace core
