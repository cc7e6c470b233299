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
class TrackedPairs;

/// Flutes farther than this from the stock are in air, mm; nearer ones may be on a spring pass.
constexpr double air_gap = 0.5;

/// Consecutive feeds of one tool through air only; rapids between them do not count. A plain value.
struct AirSeries {
    std::optional<BlockIndex> begin;
    double way = 0.0; // mm
    size_t blocks = 0;
    std::optional<BlockIndex> last;
};

/// Adds a feed of length `way`, mm, away from the stock.
void add_air(AirSeries& series, BlockIndex block, double way);

/// Ends a series. Returns the finding `air-cut` with its first block if the series is longer than
/// approach and retract of a cut with a tool of this diameter. The caller sets its severity.
std::optional<Finding> end_air(AirSeries& series, double diameter);

/// By how much a tool is too short, over all blocks so far. A plain value.
struct ToolReach {
    std::optional<BlockIndex> holder_block; // first block in which the holder meets the stock
    double more_stick_out = 0.0;            // required additional stick-out, mm
    std::optional<BlockIndex> shank_block;  // first block in which the shank meets the stock
    double more_flute = 0.0;                // required additional flute length, mm
    std::optional<BlockIndex> rub_block;    // first block in which the shank only rubs
    size_t blocks = 0;       // number of blocks in which holder or shank meet the stock
    size_t computations = 0; // number of computations of the required length, which is limited
    std::optional<BlockIndex> last;
};

using ToolReaches = std::map<ToolNumber, ToolReach>;

/// A leg of the run, with the data to check it again with a changed tool or at another height.
struct ExecutedLeg {
    const Setup& setup;
    const ToolAssembly& tool;
    BlockIndex block;
    const Leg& leg;
    const std::vector<bool>& mounted_fixtures;
    const CutModel& stock; // note_reach: after the leg; low_retract: before it
};

/// Records whether holder and shank met the stock on a leg that the flutes cut, and how much higher
/// on the tool they would have to be to keep every allowance on it.
///
/// Cost: none for a leg on which they are clear; about ten checks of the leg if they must be higher
/// than for any leg before.
void note_reach(ToolReaches& reaches, const ExecutedLeg& cut, const TrackedPairs& pairs);

/// The findings `stick-out-short` and `over-engagement`, at most one of each per tool, with the
/// first block concerned and the length that is enough for all blocks. The caller sets severities,
/// except that a shank that only rubs is a note.
std::vector<Finding> findings_of(const ToolReaches& reaches, const Setup& setup);

/// State of the rules that span several blocks. A plain value.
struct RunRules {
    AirSeries air;
    ToolReaches reaches;
    bool has_fed = false;           // since the last tool change
    bool singular_reported = false; // `singular-orientation`, since the last tool change
    // The control's length of the tool differs from the real one, so the tool's depth says nothing
    // about its stick-out. Set by the caller that runs the blocks.
    bool length_in_doubt = false;
};

/// Whether a leg moves far enough sideways to be a link between two features.
bool goes_across(const Leg& leg);

/// The finding `low-retract`: the tool is clear at the start and end of the rapid but not between
/// them, or passes over the stock there by less than half a millimetre. `known` are the clearances
/// on the leg. The caller sets its severity.
///
/// Cost: none if the rapid is well clear; else about twenty checks of the leg.
std::optional<Finding> low_retract(const ExecutedLeg& link, const TrackedPairs& known);

/// The pieces of a stock while it is cut. A plain value.
struct PieceTracker {
    PieceMap map;
    size_t known = 1; // number of pieces, without crumbs
};

/// The pieces of a stock at the start of a run.
PieceTracker piece_tracker(const CutModel& stock);

/// Checks whether the cuts from number `first` in the log on have parted the stock.
/// `mounted_fixtures` says which fixtures are mounted.
///
/// Result: a finding `loose-piece`, without its block, for each new piece but the largest: its
///         size, its position, and whether a fixture touches it, to within a mesh size.
/// Cost:   some microseconds for cuts above solid material, else that of PieceMap::pieces().
std::vector<Finding> track_pieces(const Setup& setup, const std::vector<bool>& mounted_fixtures,
                                  const CutModel& stock, size_t first, PieceTracker& tracker);

/// State of a tool that does not cut at its centre, while it goes down: the stock before that, and
/// the positions of the tool since.
///
/// Frame: positions are those of the tip, with axes fixed to the tool, Z along its axis.
struct CentreTracker {
    std::optional<CutModel> before;
    Mat3 orientation = Mat3(1.0);
    double top = 0.0;        // height at which the descent began
    std::vector<Vec3> trail; // latest positions, up to one recess above the lowest
};

/// First contact on a leg of a tool's centre with material that its edges have not removed.
struct CentreContact {
    double fraction = 0.0;     // fraction of the leg
    Vec3 position = Vec3(0.0); // of the tool's face, in the stock's frame
};

/// Assumed recess of the face of such a tool behind its edges, mm. With it, the steepest ramp that
/// still counts as cutting has a slope of recess / (2 * centre_radius), about 7 degrees.
double centre_recess(const ToolDescription& tool);

/// Follows a feed along one leg; `stock` is the stock before the leg. Call it for every leg of such
/// a tool, in order.
///
/// `certain`: only material that is certainly there counts. Otherwise all that may be there does,
/// for simulations that must hold for a range of set-ups.
///
/// Proof: a tool that goes down meets a point at the height of its face for the first time when its
/// tip passes there. If the point has been under the centre ever since, no edge has passed it.
std::optional<CentreContact> follow(CentreTracker& tracker, const ToolDescription& tool,
                                    const RelativeLeg& leg, const CutModel& stock,
                                    bool certain = true);

/// The finding `singular-orientation` about a feed in which rotary axes turn: either an
/// axis turns far while the tool hardly tilts and its tip hardly moves; or, without tool centre
/// point control, a block that turns several rotary axes is so long that the tip deviates from its
/// straight line by more than 0.5 mm. The caller sets severity and block.
std::optional<Finding> singular_orientation(const Machine& machine, const Motion& motion,
                                            double tool_length);

} // namespace core
