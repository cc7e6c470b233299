#include "core/distance/pair_tracker.h"

#include <cmath>
#include <limits>

#include "core/distance/point_search.h"
#include "core/geom/rigid_motion.h"

namespace core {
namespace {

double reach(const Aabb& box) {
    return glm::length(glm::max(glm::abs(box.min), glm::abs(box.max)));
}

/// How much of the distance to what is asked a search need not settle: the rest of it is kept for
/// the poses to come.
constexpr double share_left_open = 0.5;

} // namespace

PairTracker::PairTracker(const DistanceEngine& engine, PointBody a, PointBody b)
    : engine_(engine),
      a_(a),
      b_(b),
      box_of_a_(engine.box_of(a)),
      box_of_b_(engine.box_of(b)),
      memory_(std::make_unique<SearchMemory>()) {}

PairTracker::~PairTracker() = default;

double PairTracker::lower_bound(const Transform& a_from_b) const {
    if (known_lower_ == 0.0) return 0.0;
    // The distances of two poses take some ten roundings of numbers of this size each.
    const double lengths = reach(box_of_a_) + reach(box_of_b_) + glm::length(a_from_b.translation)
                           + glm::length(known_pose_.translation);
    // Squares of less than 1e-150 mm have lost their digits.
    const double rounding = 1e-150 + 64.0 * std::numeric_limits<double>::epsilon() * lengths;
    const double moved = displacement(known_pose_, a_from_b, box_of_b_) + rounding;
    return known_lower_ > moved ? known_lower_ - moved : 0.0;
}

Result<ClosestPair> PairTracker::closest_pair(const Transform& a_from_b, const PairGoal& goal) {
    if (auto checked = engine_.check(a_, b_, a_from_b, goal); !checked)
        return tl::unexpected(std::move(checked).error());
    if (goal.sweep == Vec3(0.0) && !goal.end && lower_bound(a_from_b) >= goal.limit)
        return ClosestPair{.lower = goal.limit};
    return search(a_from_b, goal);
}

Result<bool> PairTracker::is_nearer(const Transform& a_from_b, double distance) {
    if (auto checked = engine_.check(a_, b_, a_from_b); !checked)
        return tl::unexpected(std::move(checked).error());
    if (std::isnan(distance))
        return fail(ErrorCode::invalid_value, "the distance asked about is no number");
    if (lower_bound(a_from_b) >= distance) return false;
    if (!nearest_) {
        FEELER_TRY(const ClosestPair found, search(a_from_b, {}));
        return found.distance < distance;
    }
    FEELER_TRY(ClosestPair known, engine_.pair_at(a_, b_, *nearest_, a_from_b));
    // Each search leaves open no more than half of what lies between its pair and the question, and
    // either settles it or finds a nearer pair.
    while (known.distance >= distance) {
        const double open = share_left_open * (known.distance - distance);
        FEELER_TRY(const ClosestPair found, search(a_from_b, {.tolerance = open}));
        if (found.lower >= distance) return false;
        known = found;
    }
    return true;
}

Result<ClosestPair> PairTracker::search(const Transform& a_from_b, const PairGoal& goal) {
    PairGoal seeded = goal;
    if (!seeded.first) seeded.first = nearest_;
    ++searches_;
    FEELER_TRY(const ClosestPair found,
               engine_.closest_pair(a_, b_, a_from_b, seeded, memory_.get()));
    if (found.found()) nearest_ = found.points;
    // Of a motion, the bound holds for its start among others.
    if (found.lower >= lower_bound(a_from_b)) {
        known_pose_ = a_from_b;
        known_lower_ = found.lower;
    }
    return found;
}

} // namespace core
