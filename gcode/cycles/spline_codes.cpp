#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/result.h"
#include "gcode/contour/spline.h"
#include "gcode/cycles/cycles.h"

namespace gcode {

namespace {

using core::ErrorCode;

/// Largest distance of a chord from its curve, mm.
constexpr double spline_chord_error = 0.001;

core::Result<SplinePoint> start_of(const Execution& execution) {
    const Position& place = execution.modal().position;
    if (!place[0] || !place[1])
        return core::fail(ErrorCode::missing_value,
                          "the start position of the spline is unknown: move X and Y first, or set "
                          "[program] start in the set-up",
                          moving_word(execution).span);
    return SplinePoint{*place[0], *place[1]};
}

core::Result<void> refuse_compensation(const Execution& execution) {
    if (execution.modal().compensation == Side::none) return {};
    const Word& mover = moving_word(execution);
    return core::fail(ErrorCode::syntax,
                      fmt::format("{}: no spline is allowed while cutter radius compensation is "
                                  "on: cancel it with G40 first",
                                  written(mover)),
                      mover.span);
}

/// G5 and G5.1 are curves of X and Y only.
core::Result<void> check_plane_spline(const Execution& execution) {
    const Word& mover = moving_word(execution);
    if (execution.modal().plane != Plane::xy)
        return core::fail(
            ErrorCode::syntax,
            fmt::format("{} works in the XY plane only: program G17 first", written(mover)),
            mover.span);
    if (!execution.statement.has_axis_word())
        return core::fail(ErrorCode::missing_value,
                          fmt::format("{} has no end point: it needs X or Y", written(mover)),
                          mover.span);
    for (const char letter : {'Z', 'A', 'B', 'C'})
        if (const Word* word = execution.statement.word(letter))
            return core::fail(
                ErrorCode::syntax,
                fmt::format("{}: a spline moves X and Y only: move {} in a separate block",
                            written(*word), letter),
                word->span);
    return refuse_compensation(execution);
}

double length_of_chords(SplinePoint from, const std::vector<SplinePoint>& ends) {
    double length = 0.0;
    for (const SplinePoint end : ends) {
        length += core::hypot(end.x - from.x, end.y - from.y);
        from = end;
    }
    return length;
}

core::Result<void> follow(Execution& execution, const NurbsCurve& curve) {
    const core::SourceSpan where = moving_word(execution).span;
    FEELER_TRY(const std::vector<SplinePoint> ends,
               placed(chords_within(curve, spline_chord_error), where));
    const double length = length_of_chords(curve.points.front().at, ends);
    FEELER_TRY(const double rate, feed_rate(execution, length));
    execution.result.is_cycle = true;
    Position place = execution.modal().position;
    for (const SplinePoint end : ends) {
        place[0] = end.x, place[1] = end.y;
        execution.feed(place, rate);
    }
    return {};
}

core::Result<void> cubic(Execution& execution) {
    FEELER_TRY(const SplinePoint start, start_of(execution));
    FEELER_TRY(const Position end, target_of(execution));
    const CubicWords words = {length_word(execution, 'I'),
                              length_word(execution, 'J'),
                              length_word(execution, 'P'),
                              length_word(execution, 'Q'),
                              {*end[0], *end[1]}};
    FEELER_TRY(const CubicSpline spline,
               placed(cubic_spline(start, execution.state.spline->next_tangent, words),
                      moving_word(execution).span));
    execution.state.spline.write().next_tangent = spline.next_tangent;
    return follow(execution, spline.curve);
}

core::Result<void> quadratic(Execution& execution) {
    FEELER_TRY(const SplinePoint start, start_of(execution));
    FEELER_TRY(const Position end, target_of(execution));
    FEELER_TRY(const NurbsCurve curve,
               placed(quadratic_spline(start, length_word(execution, 'I'),
                                       length_word(execution, 'J'), {*end[0], *end[1]}),
                      moving_word(execution).span));
    return follow(execution, curve);
}

} // namespace

core::Result<void> follow_spline(Execution& execution) {
    if (auto checked = check_plane_spline(execution); !checked) return checked;
    const bool is_cubic = execution.statement.of(ModalGroup::motion)->code->number == g_code(5);
    return is_cubic ? cubic(execution) : quadratic(execution);
}

core::Result<void> gather_control_point(Execution& execution) {
    if (auto checked = refuse_compensation(execution); !checked) return checked;
    const Statement& statement = execution.statement;
    if (execution.modal().feed_mode != FeedMode::inverse_time)
        if (auto rate = feed_rate(execution, std::nullopt); !rate)
            return tl::unexpected(std::move(rate).error());
    FEELER_TRY(const SplinePoint start, start_of(execution));
    FEELER_TRY(const Position end, target_of(execution));
    const bool is_polar = statement.polar_radius || statement.polar_angle;
    ControlPointWords words;
    if (statement.word('X') || is_polar) words.x = end[0];
    if (statement.word('Y') || is_polar) words.y = end[1];
    if (const Word* word = statement.word('P')) words.weight = word->value;
    if (const Word* word = statement.word('L')) {
        FEELER_TRY(words.order, whole_number(*word));
    }
    NurbsGathering& gathering = execution.state.spline.write().gathering;
    if (gathering.points.empty() && words.x && !words.weight)
        execution.warn(moving_word(execution).span,
                       "the first control point has no P: the control uses the weight -1, and the "
                       "curve leaves its control points; add P1");
    return placed(add_control_point(gathering, start, words), moving_word(execution).span);
}

core::Result<void> finish_spline(Execution& execution) {
    ModalState& modal = execution.modal();
    const Word& mover = moving_word(execution);
    if (execution.statement.has_axis_word())
        return core::fail(
            ErrorCode::syntax,
            fmt::format(
                "{} takes no axis words: program the last control point in the block before it",
                written(mover)),
            mover.span);
    if (modal.motion != MotionCode::spline_control_point)
        return core::fail(
            ErrorCode::syntax,
            fmt::format("{} ends a curve, but none was started with G5.2", written(mover)),
            mover.span);
    FEELER_TRY(const NurbsCurve curve,
               placed(finish_nurbs(execution.state.spline->gathering), mover.span));
    modal.motion.reset();
    execution.state.spline.write().gathering = {};
    return follow(execution, curve);
}

namespace {

constexpr int most_chords_of_span = 1 << 20;

bool is_finite(SplinePoint place) { return std::isfinite(place.x) && std::isfinite(place.y); }

double distance_from_chord(SplinePoint place, SplinePoint from, SplinePoint to) {
    const double x = to.x - from.x, y = to.y - from.y;
    const double squared = x * x + y * y;
    const double along =
        squared > 0.0 ? ((place.x - from.x) * x + (place.y - from.y) * y) / squared : 0.0;
    const double share = std::fmin(std::fmax(along, 0.0), 1.0);
    return core::hypot(place.x - from.x - share * x, place.y - from.y - share * y);
}

/// The curve between two knots in equal steps of its parameter.
std::vector<SplinePoint> chords_of_span(const NurbsCurve& curve, int span, int count) {
    std::vector<SplinePoint> ends;
    for (int i = 1; i <= count; ++i)
        ends.push_back(point_at(curve, span + static_cast<double>(i) / count));
    return ends;
}

/// Whether chords stay within the tolerance of the curve. Between knots a curve of this order bends
/// only a few times, so testing each of many chords at its quarter points is enough; half of the
/// tolerance is reserved for deviations between these points.
bool are_near(const NurbsCurve& curve, int span, SplinePoint from,
              const std::vector<SplinePoint>& ends, double tolerance) {
    const auto count = static_cast<double>(ends.size());
    for (size_t i = 0; i < ends.size(); ++i) {
        for (const double share : {0.25, 0.5, 0.75}) {
            const double parameter = span + (static_cast<double>(i) + share) / count;
            if (distance_from_chord(point_at(curve, parameter), from, ends[i]) > tolerance / 2.0)
                return false;
        }
        from = ends[i];
    }
    return true;
}

} // namespace

core::Result<std::vector<SplinePoint>> chords_within(const NurbsCurve& curve, double tolerance) {
    std::vector<SplinePoint> all;
    SplinePoint from = curve.points.front().at;
    for (int span = 0; span < curve.spans(); ++span) {
        std::vector<SplinePoint> ends;
        for (int count = 4 * curve.order;; count *= 2) {
            if (count > most_chords_of_span)
                return core::fail(core::ErrorCode::invalid_value,
                                  "this spline bends too sharply: its weights nearly cancel out");
            ends = chords_of_span(curve, span, count);
            for (const SplinePoint end : ends)
                if (!is_finite(end))
                    return core::fail(core::ErrorCode::invalid_value,
                                      "the weights of this spline cancel out and it runs to "
                                      "infinity: make each weight P positive");
            if (are_near(curve, span, from, ends, tolerance)) break;
        }
        all.insert(all.end(), ends.begin(), ends.end());
        from = all.back();
    }
    all.back() = curve.points.back().at;
    return all;
}

} // namespace gcode
