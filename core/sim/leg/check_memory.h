#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/dbm/cut_model.h"
#include "core/distance/stock_distance.h"
#include "core/sim/clearance.h"

namespace core {

/// What a pair keeps apart at least, where the machine stands now.
struct PairBound {
    Pair pair;
    double apart = 0.0;
    double drift = 0.0; // the way since the pair was measured
};

/// What a check keeps from leg to leg. All but `cuts` is there to be faster, and no verdict depends
/// on it.
struct CheckMemory {
    /// Cutting takes nothing nearer, and a motion no more than it is long: so bounds hold from
    /// block to block, until a tool or a fixture is changed.
    std::vector<PairBound> bounds;
    std::optional<Pair> deciding; // the pair that decided the last block: likely the next one, too
    double margin = 0.0;          // of that pair

    double off_path = 0.0; // that is taken off every lower bound behind the block, mm

    /// Where each kind of body last met the stock most nearly: a good place to look first.
    std::array<std::optional<LineId>, 5> hints;
    /// Cutters made ready, by the tool's number and the path error they allow for.
    std::map<std::pair<ToolNumber, double>, std::shared_ptr<const Cutter>> cutters;
    /// What flutes that feed have cut of expendable fixtures, by the fixture's index, in the
    /// stock's frame. Without it a rapid in its own cut is an alarm.
    std::map<size_t, SweepLog> cuts;
};

} // namespace core
