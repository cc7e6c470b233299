#include "core/distance/measurement.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "core/distance/box_tree_distance.h"
#include "core/distance/motion_search.h"
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

namespace {

/// A convex part made smaller towards the middle of the ball that it holds, so that every point of
/// what is left lies at least `by` inside; by must be less than its depth.
ConvexShape shrunk(const ExactPart& part, double by) {
    ConvexShape shape = std::get<ConvexShape>(part.body);
    const double left = 1.0 - by / part.depth;
    for (size_t i = 0; i < shape.point_count; ++i)
        shape.points[i] = part.centre + left * (shape.points[i] - part.centre);
    shape.cone.r0 *= left;
    shape.cone.r1 *= left;
    shape.cone.z0 = part.centre.z + left * (shape.cone.z0 - part.centre.z);
    shape.cone.z1 = part.centre.z + left * (shape.cone.z1 - part.centre.z);
    shape.margin *= left;
    return shape;
}

/// A point of B that is in the part, if one is nearer than the error to what shrinking by twice as
/// much leaves of it.
std::optional<SharedPoint> shared_with(const ExactPart& a, const BodySide& b,
                                       const BodyMotion& motion, double error) {
    if (!(a.depth > 2.0 * error)) return std::nullopt;
    const std::array part = {ExactPart{shrunk(a, 2.0 * error), {}, 0.0}};
    const SeparationGoal goal{.tolerance = 0.0, .limit = 2.0 * error};
    const Separation found = separation({part}, b, motion, goal).separation;
    if (!(found.upper <= error)) return std::nullopt;
    return SharedPoint{found.point_b, found.time_a};
}

std::optional<SharedPoint> shared_with(const BodySide& a, const ExactPart& b,
                                       const BodyMotion& motion, double error) {
    if (!(b.depth > 2.0 * error)) return std::nullopt;
    const std::array part = {ExactPart{shrunk(b, 2.0 * error), {}, 0.0}};
    const SeparationGoal goal{.tolerance = 0.0, .limit = 2.0 * error};
    const Separation found = separation(a, {part}, motion, goal).separation;
    if (!(found.upper <= error)) return std::nullopt;
    return SharedPoint{found.point_a, found.time_a};
}

double to_surface(const SolidMesh& mesh, const Vec3& p, double limit) {
    return separation(convex_segment(p, p), *mesh.bvh, {0.0, limit}).lower;
}

bool lies_deep(const SolidMesh& mesh, const Vec3& p, double error) {
    return holds(mesh, p) && to_surface(mesh, p, 4.0 * error) >= 4.0 * error;
}

bool lies_in_or_on(const SolidMesh& mesh, const Vec3& p, double error) {
    return holds(mesh, p)
           || separation(convex_segment(p, p), *mesh.bvh, {0.0, 2.0 * error}).upper <= error;
}

/// Calls `prove` with places round the witness until it finds a shared point: at the moments and
/// steps given, from wide ones to those that the error drowns.
template <typename Prove>
std::optional<SharedPoint> any_place(const BodyMotion& motion, const Separation& near,
                                     double widest, double error, const Prove& prove) {
    const bool moves = motion.sweep != Vec3(0.0);
    for (const double later : {0.0, 0.015, -0.015, 0.125, -0.125}) {
        if (later != 0.0 && !moves) break;
        const double time = std::clamp(near.time_a + later, 0.0, 1.0);
        const Transform then = translation(time * motion.sweep) * motion.a_from_b;
        const Vec3 place = near.point_a + 0.5 * (time - near.time_a) * motion.sweep;
        if (const std::optional<Vec3> p = prove(then, place, 0.0)) return SharedPoint{*p, time};
        for (double step = 0.25 * widest; step > 8.0 * error; step *= 0.25)
            if (const std::optional<Vec3> p = prove(then, place, step))
                return SharedPoint{*p, time};
    }
    return std::nullopt;
}

std::optional<SharedPoint> shared_deeply(const SolidMesh& a, const SolidMesh& b,
                                         const BodyMotion& motion, const Separation& near,
                                         double error) {
    const double widest =
        std::min(glm::length(a.mesh->bounds().size()), glm::length(b.mesh->bounds().size()));
    const auto both_hold = [&](const Transform& a_from_b, const Vec3& p) {
        const Vec3 in_b = a_from_b.inverse() * p;
        return (lies_deep(a, p, error) && lies_in_or_on(b, in_b, error))
               || (lies_deep(b, in_b, error) && lies_in_or_on(a, p, error));
    };
    const auto prove = [&](const Transform& then, const Vec3& place,
                           double step) -> std::optional<Vec3> {
        for (int i = 0; i < 27; ++i) {
            const Vec3 p = place + step * Vec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
            if ((i == 13) == (step == 0.0) && both_hold(then, p)) return p;
        }
        return std::nullopt;
    };
    return any_place(motion, near, widest, error, prove);
}

/// A point of a stretch of matter that lies deep in a mesh; the stretch is in the frame of B.
std::optional<SharedPoint> shared_deeply(const SolidMesh& a, const Aabb& stretch,
                                         const BodyMotion& motion, const Separation& near,
                                         double error) {
    const Vec3 along = stretch.size();
    const double length = glm::length(along);
    const auto prove = [&](const Transform& then, const Vec3& place,
                           double step) -> std::optional<Vec3> {
        const double at = glm::dot(then.inverse() * place - stretch.min, along) / length;
        for (const double sign : {-1.0, 1.0}) {
            const Vec3 p =
                then * (stretch.min + std::clamp(at + sign * step, 0.0, length) * (along / length));
            if (lies_deep(a, p, error)) return p;
        }
        return std::nullopt;
    };
    return any_place(motion, near, 4.0 * length, error, prove);
}

bool is_convex(const ExactPart& part) { return std::holds_alternative<ConvexShape>(part.body); }

BodyMotion seen_from_b(const BodyMotion& motion) {
    const Transform b_from_a = motion.a_from_b.inverse();
    return {b_from_a, -(b_from_a.rotation * motion.sweep)};
}

} // namespace

std::optional<SharedPoint> certainly_shared(const BodySide& a, const BodySide& b,
                                            const BodyMotion& motion, const SideSeparation& near,
                                            double error) {
    std::optional<SharedPoint> shared;
    if (a.is_exact() && is_convex(a.parts[near.part_a]))
        shared = shared_with(a.parts[near.part_a], b, motion, error);
    if (!shared && b.is_exact() && is_convex(b.parts[near.part_b]))
        shared = shared_with(a, b.parts[near.part_b], motion, error);
    if (shared) return shared;
    const auto mesh_of = [](const BodySide& side, size_t part) {
        return side.is_exact() ? std::get_if<SolidMesh>(&side.parts[part].body) : nullptr;
    };
    const SolidMesh* mesh_a = mesh_of(a, near.part_a);
    const SolidMesh* mesh_b = mesh_of(b, near.part_b);
    if (mesh_a && mesh_b) return shared_deeply(*mesh_a, *mesh_b, motion, near.separation, error);
    if (mesh_a && !b.is_exact())
        return shared_deeply(*mesh_a, b.boxes->boxes[near.part_b], motion, near.separation, error);
    if (!mesh_b || a.is_exact()) return std::nullopt;
    const BodyMotion back = seen_from_b(motion);
    Separation turned = near.separation;
    turned.point_a = motion.a_from_b.inverse()
                     * (near.separation.point_b - near.separation.time_a * motion.sweep);
    shared = shared_deeply(*mesh_b, a.boxes->boxes[near.part_a], back, turned, error);
    if (shared) shared->point = motion.a_from_b * shared->point + shared->time * motion.sweep;
    return shared;
}

} // namespace core
