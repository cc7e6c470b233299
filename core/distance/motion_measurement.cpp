#include <algorithm>
#include <cassert>

#include "core/distance/measurement.h"
#include "core/distance/motion_search.h"
#include "core/distance/rounding.h"
#include "core/distance/time_search.h"

namespace core {
namespace {

/// Measures parts of a motion and remembers the nearest pair.
class MotionMeasurement {
public:
    MotionMeasurement(const DistanceEngine& engine, const MeasuredBody& a, const MeasuredBody& b,
                      const RigidMotion& motion, const MeasureGoal& goal)
        : engine_(engine), a_(a), b_(b), motion_(motion), goal_(goal) {
        const Vec3 axis_in_b = glm::transpose(motion.start.rotation) * motion.axis;
        from_axis_ = b.reach + glm::length(glm::cross(axis_in_b, motion.centre));
        rounding_ = search_rounding(a.reach + b.reach
                                    + 2.0
                                          * (2.0 * glm::length(motion.centre)
                                             + glm::length(motion.start.translation)
                                             + glm::length(motion.end.translation)));
        rounding_ += gap_at_end(motion, {Vec3(-b.reach), Vec3(b.reach)});
    }

    Result<Measurement> run(const ClosestPair& scan) {
        const auto part = [&](double from, double to, double worth) {
            return measured(from, to, worth);
        };
        TimeGoal goal{.limit = goal_.limit, .tolerance = goal_.tolerance};
        if (scan.found()) {
            FEELER_TRY(goal.known, measured_at(scan.at));
        }
        FEELER_TRY(const StretchBound least, least_over_time(part, goal));
        if (!(best_.upper < goal_.limit)) best_ = Measurement{};
        best_.scan = scan;
        best_.lower = least.lower;
        best_.reason = reason_;
        return best_;
    }

private:
    /// The body keeps the orientation that it has half way and goes straight; by how much a point
    /// swings out of that is taken off.
    Result<StretchBound> measured(double from, double to, double worth) {
        const double allowance = swing(motion_, from_axis_, to - from) + rounding_;
        const Mat3 half_way = motion_.at(0.5 * (from + to)).rotation;
        const Transform start{half_way,
                              motion_.at(from) * motion_.centre - half_way * motion_.centre};
        const MeasureGoal goal{.sweep = (to - from) * motion_.travel(),
                               .limit = worth + allowance + 2.0 * rounding_, // it takes some off
                               .tolerance = goal_.tolerance / 16.0,
                               .first = first_};
        FEELER_TRY(const Measurement straight, measure(engine_, a_, b_, start, goal));
        if (straight.scan.found()) first_ = straight.scan.points;
        reason_ = straight.reason;
        StretchBound bound{std::max(straight.lower - allowance, 0.0), infinity, allowance};
        if (straight.lower == 0.0 && !straight.reason.empty()) bound.gain = 0.0;
        if (!(straight.upper < infinity)) return bound;
        FEELER_TRY(bound.upper, measured_at(from + straight.at * (to - from)));
        return bound;
    }

    Result<double> measured_at(double time) {
        const MeasureGoal goal{
            .limit = goal_.limit, .tolerance = goal_.tolerance / 16.0, .first = first_};
        FEELER_TRY(Measurement there, measure(engine_, a_, b_, motion_.at(time), goal));
        there.at = time;
        if (there.upper < best_.upper) best_ = there;
        return there.upper;
    }

    const DistanceEngine& engine_;
    const MeasuredBody& a_;
    const MeasuredBody& b_;
    const RigidMotion& motion_;
    const MeasureGoal goal_;
    double from_axis_ = 0.0, rounding_ = 0.0;
    std::optional<PointPair> first_;
    std::string reason_;
    Measurement best_;
};

} // namespace

Result<Measurement> measure(const DistanceEngine& engine, const MeasuredBody& a,
                            const MeasuredBody& b, const RigidMotion& motion,
                            const MeasureGoal& goal) {
    assert(a.in_engine && b.in_engine);
    if (goal.sweep != Vec3(0.0))
        return fail(ErrorCode::invalid_value,
                    "a goal with a way of its own does not go with a motion");
    if (motion.angle == 0.0 && motion.start.rotation == motion.end.rotation) {
        MeasureGoal straight = goal;
        straight.sweep = motion.end.translation - motion.start.translation;
        return measure(engine, a, b, motion.start, straight);
    }
    MeasureGoal turning = goal;
    if (goal.tolerance < least_turning_tolerance) turning.tolerance = least_turning_tolerance;
    const PairGoal points{.limit = goal.limit, .tolerance = turning.tolerance, .first = goal.first};
    FEELER_TRY(const ClosestPair scan,
               closest_pair(engine, *a.in_engine, *b.in_engine, motion, points));
    turning.first = scan.found() ? std::optional(scan.points) : goal.first;
    return MotionMeasurement(engine, a, b, motion, turning).run(scan);
}

} // namespace core
