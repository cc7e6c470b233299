#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/distance/closest_pair.h"

namespace bench {

using Points = std::vector<core::Vec3>;

/// The least distance between the two bodies for which the query was made.
///
/// Result: infinite when no pair of points is below the limit of the goal. If any pair will do, the
///         distance of some pair below the limit.
using Query = std::function<double(const core::Transform& a_from_b, const core::PairGoal& goal)>;

/// The structures of an engine for two bodies. The queries keep them alive.
struct Prepared {
    Query cold;
    std::function<Query()> follow; // a query that starts without data and uses its earlier results;
                                   // empty if the engine has none
};

/// An engine that finds the distance between two bodies given by their points.
struct Contestant {
    std::string name;
    double precision = 0.0; // mm: maximum error of its distances
    std::function<Prepared(const Points& a, const Points& b)> prepare;
    std::function<std::shared_ptr<const void>(const Points&)> build; // its structure over one body
};

/// All engines: ours first, starting with the paper's, then the libraries found at build time.
std::vector<Contestant> contestants();

/// The name of the engine to which the ratios refer.
std::string challenger();

} // namespace bench
