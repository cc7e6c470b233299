#include "core/distance/measurement.h"

#include <cassert>

#include "core/distance/body_side.h"
#include "core/distance/rounding.h"

namespace core {
namespace {

bool is_mesh(const MeasuredBody& body) {
    return !body.parts.empty() && std::holds_alternative<SolidMesh>(body.parts[0].body);
}

BodySide known_matter(const MeasuredBody& body) {
    if (body.scanned) return {{}, &body.scanned->lines};
    return {body.parts, nullptr};
}

BodySide possible_matter(const MeasuredBody& body) {
    if (body.scanned) return {{}, &*body.scanned->outer};
    return {body.parts, nullptr};
}

bool is_bounded(const MeasuredBody& body) { return !body.scanned || body.scanned->outer; }

std::string why_unbounded(const MeasuredBody& a, const MeasuredBody& b) {
    const char* which = is_bounded(b) ? "A is" : is_bounded(a) ? "B is" : "both bodies are";
    return std::string(which)
           + " known by scan lines only, without an outer model: matter may stand between the "
             "lines";
}

class RestMeasurement {
public:
    RestMeasurement(const MeasuredBody& a, const MeasuredBody& b, const BodyMotion& motion,
                    const MeasureGoal& goal)
        : a_(a),
          b_(b),
          motion_(motion),
          goal_(goal),
          reach_(a.reach + b.reach + glm::length(motion.a_from_b.translation)
                 + glm::length(motion.sweep)),
          rounding_(search_rounding(reach_) + 4.0 * distortion(motion.a_from_b.rotation) * reach_) {
    }

    Measurement run(const ClosestPair& scan) {
        result_.scan = scan;
        offer(scan.distance + rounding_ + scan_rounding(a_.reach) + scan_rounding(b_.reach),
              {0.0, scan.distance, scan.witness_a, scan.witness_b, scan.at});
        const bool exact = !a_.scanned && !b_.scanned;
        const SideSeparation found =
            separation(known_matter(a_), known_matter(b_), motion_, search_goal());
        take_upper(found, exact ? error_near(found) : scanned_error(found));
        if (exact)
            take_lower(found);
        else if (is_bounded(a_) && is_bounded(b_))
            take_lower(
                separation(possible_matter(a_), possible_matter(b_), motion_, search_goal()));
        else if (result_.upper > 0.0)
            result_.reason = why_unbounded(a_, b_);
        return within_limit();
    }

private:
    /// Nobody asks beyond the limit, and nothing farther than `upper` is the nearest.
    SeparationGoal search_goal() const {
        return {goal_.tolerance, std::min(goal_.limit, result_.upper)};
    }

    /// A mesh takes matter and gaps thinner than its scan resolves for rounding: they decide
    /// whether a point lies inside, so they count where the bodies are that near.
    double error_near(const SideSeparation& found) const {
        const double thin = scan_rounding(reach_);
        const bool counts = (is_mesh(a_) || is_mesh(b_)) && found.separation.lower <= thin;
        return counts ? rounding_ + thin : rounding_;
    }

    double scanned_error(const SideSeparation& found) const {
        return error_near(found) + scan_rounding(a_.reach) + scan_rounding(b_.reach);
    }

    void offer(double upper, const Separation& found) {
        if (!(upper < result_.upper)) return;
        result_.upper = upper;
        result_.witness_a = found.point_a;
        result_.witness_b = found.point_b;
        result_.at = found.time_a;
    }

    void take_upper(const SideSeparation& found, double error) {
        if (!found.separation.found()) return;
        offer(found.separation.upper + error, found.separation);
        if (found.separation.upper > goal_.tolerance + error) return;
        const auto shared =
            certainly_shared(known_matter(a_), known_matter(b_), motion_, found, error);
        if (shared) offer(0.0, {0.0, 0.0, shared->point, shared->point, shared->time});
    }

    void take_lower(const SideSeparation& found) {
        const double lower = found.separation.lower - error_near(found);
        result_.lower = std::max(0.0, std::min(lower, result_.upper));
    }

    Measurement within_limit() {
        if (result_.upper < goal_.limit) return result_;
        Measurement none;
        none.scan = result_.scan;
        none.lower = std::min(result_.lower, goal_.limit);
        none.reason = result_.reason;
        return none;
    }

    const MeasuredBody& a_;
    const MeasuredBody& b_;
    BodyMotion motion_;
    MeasureGoal goal_;
    double reach_;
    double rounding_;
    Measurement result_;
};

} // namespace

Result<Measurement> measure(const DistanceEngine& engine, const MeasuredBody& a,
                            const MeasuredBody& b, const Transform& a_from_b,
                            const MeasureGoal& goal) {
    assert(a.in_engine && b.in_engine);
    if (!(goal.tolerance >= 0.0))
        return fail(ErrorCode::invalid_value, "the tolerance must be a length of 0 mm or more");
    const PairGoal points{.limit = goal.limit, .sweep = goal.sweep, .first = goal.first};
    FEELER_TRY(const ClosestPair scan,
               engine.closest_pair(*a.in_engine, *b.in_engine, a_from_b, points));
    return RestMeasurement(a, b, {a_from_b, goal.sweep}, goal).run(scan);
}

} // namespace core
