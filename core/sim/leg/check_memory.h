#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "core/dbm/cut_model.h"
#include "core/sim/clearance.h"

namespace core {

struct TurningPart;

/// The order of pairs in reports and in the memory of a check: by fixture, the stock first.
inline bool is_before(const Pair& a, const Pair& b) {
    return std::tuple(a.fixture, a.part, a.carried) < std::tuple(b.fixture, b.part, b.carried);
}

/// Lower bound of a pair's distance at the machine's current position.
struct PairBound {
    Pair pair;
    double apart = 0.0;
    double drift = 0.0; // travel since the pair was measured, mm
};

/// State of a check that is carried from leg to leg. All but `cuts` and `passages` only saves time,
/// and no verdict depends on it, with one exception: with `near_places`, a search may find an
/// overlap that it would miss alone, or another one, at another moment of the leg.
struct CheckMemory {
    /// Cutting brings nothing nearer, and a motion brings a pair nearer by at most its length, so
    /// bounds hold from block to block until a tool or a fixture is changed. In order: is_before.
    std::vector<PairBound> bounds;
    std::optional<Pair> deciding; // of the last block; it probably decides the next one too
    double margin = 0.0;          // of the deciding pair

    double off_path = 0.0; // subtracted from every lower bound after the block, mm

    /// Scan line that was nearest to each kind of body in the last search; the next search starts
    /// there.
    std::array<std::optional<LineId>, 5> hints;
    /// Where material was last too near to a body of each kind, from where the body was at the end
    /// of that leg: on the next leg it often is there again.
    std::array<std::optional<Vec3>, 5> near_places;
    /// A tool with the spindle as it is, or stopped in its orientation: a boring bar has other
    /// flutes then.
    using ToolState = std::pair<ToolNumber, bool>;
    /// Prepared cutters, by tool, part of the flutes (0: the whole) and path error.
    std::map<std::tuple<ToolState, size_t, double>, std::shared_ptr<const Cutter>> cutters;
    /// The parts in which flutes cut, and a shank or holder is measured, while they turn; by what
    /// they are shrunk first. Valid for one set-up.
    using TurningParts = std::shared_ptr<const std::vector<TurningPart>>;
    std::map<std::tuple<ToolState, PartKind, double>, TurningParts> turning_parts;
    /// Feed sweeps of flutes through expendable fixtures, by the fixture's index, in the stock's
    /// frame. Without them a rapid within such a cut would be a false alarm.
    std::map<size_t, SweepLog> cuts;
    /// Straight motions of flutes that did not cut and of which it is undecided whether they met
    /// the stock. The same way back is not reported again.
    SweepLog passages;
};

} // namespace core
