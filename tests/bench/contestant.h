#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/distance/closest_pair.h"

namespace bench {

using Points = std::vector<core::Vec3>;

/// The least distance between the two bodies it was made for.
///
/// Result: infinite when no pair of points is below the goal's limit. If any pair will do, the
///         distance of some pair below the limit.
using Query = std::function<double(const core::Transform& a_from_b, const core::PairGoal& goal)>;

/// What a contestant has made of two bodies. The queries keep the structures alive.
struct Prepared {
    Query cold;
    std::function<Query()> follow; // a query that knows nothing yet, but then makes use of what it
                                   // was asked before; empty where a contestant cannot
};

/// A way to find the distance between two bodies given by their points.
struct Contestant {
    std::string name;
    double precision = 0.0; // mm: how far its distances may be from the true ones
    std::function<Prepared(const Points& a, const Points& b)> prepare;
    std::function<std::shared_ptr<const void>(const Points&)> build; // what it needs of one body
};

/// Everyone there is: our own engines first, the paper's in front, then the peers found when this
/// was built.
std::vector<Contestant> contestants();

/// The name of the engine that the ratios are for.
std::string challenger();

} // namespace bench
