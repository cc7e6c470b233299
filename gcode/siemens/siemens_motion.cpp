#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/units.h"
#include "gcode/contour/flat_path.h"
#include "gcode/exec/frame_codes.h"
#include "gcode/iso/iso.h"
#include "gcode/language/error_rules.h"
#include "gcode/siemens/siemens.h"

namespace gcode {
namespace {

using core::ErrorCode;
using Point = std::array<double, 2>;

// Modal motions that are started by keywords, not G codes.
constexpr MotionCode by_point = MotionCode::arc_through_point;
constexpr MotionCode by_tangent = MotionCode::tangent_arc;

tl::unexpected<core::Error> refuse(const Execution& execution, std::string_view why,
                                   ErrorCode code = ErrorCode::invalid_value) {
    const Word& mover = moving_word(execution);
    const std::string_view word =
        execution.block.text.substr(mover.span.column - 1, mover.span.length);
    return core::fail(code, fmt::format("{}: {}", word, why), mover.span);
}

core::Result<Point> plane_point(const Execution& execution, const Position& position) {
    const PlaneAxes axes = axes_of(execution.modal().plane);
    for (const size_t axis : {axes.first, axes.second})
        if (!position[axis])
            return refuse(execution,
                          fmt::format("the {} position is unknown: move there first, or set "
                                      "[program] start in the set-up",
                                      axis_letters[axis]),
                          ErrorCode::missing_value);
    return Point{*position[axes.first], *position[axes.second]};
}

/// Emits an arc in the plane and moves to its end.
core::Result<void> go_along_arc(Execution& execution, const Position& end, const Point& centre,
                                int turns) {
    ModalState& modal = execution.modal();
    const PlaneAxes axes = axes_of(modal.plane);
    FEELER_TRY(const Point from, plane_point(execution, modal.position));
    FEELER_TRY(const Point to, plane_point(execution, end));
    const double start_point[2] = {from[0], from[1]}, end_point[2] = {to[0], to[1]};
    const double centre_point[2] = {centre[0], centre[1]};
    const double radius = core::hypot(from[0] - centre[0], from[1] - centre[1]);
    const double end_radius = core::hypot(to[0] - centre[0], to[1] - centre[1]);
    const ArcTolerance& allowed = execution.dialect.arc;
    if (radius < 1e-9
        || std::abs(radius - end_radius) > std::max(allowed.absolute_mm, allowed.relative * radius))
        return refuse(
            execution,
            fmt::format("the radius of the arc is {:.4f} mm at its start and {:.4f} mm at "
                        "its end",
                        radius, end_radius),
            wrong_arc);
    const double angle = arc_angle(start_point, end_point, centre_point, turns);
    std::optional<double> path;
    const auto &rise_from = modal.position[axes.normal], &rise_to = end[axes.normal];
    if (rise_from && rise_to) path = core::hypot(radius * angle, *rise_to - *rise_from);
    FEELER_TRY(const double feed, feed_rate(execution, path));
    modal.position = end;
    modal.leaves_contour = false;
    execution.emit(ArcFeed{.end = end,
                           .plane = modal.plane,
                           .centre = {centre[0], centre[1]},
                           .turns = turns,
                           .feed = feed});
    return {};
}

core::Result<void> go_straight(Execution& execution, const Position& end) {
    if (execution.modal().motion == MotionCode::rapid) {
        execution.traverse(end);
        return {};
    }
    FEELER_TRY(const double rate,
               feed_rate(execution, distance_between(execution.modal().position, end)));
    execution.feed(end, rate);
    return {};
}

/// The target of RP and AP about the pole; a missing one keeps its last value.
core::Result<Position> polar_target(Execution& execution) {
    const Statement& statement = execution.statement;
    const PlaneAxes axes = axes_of(execution.modal().plane);
    if (statement.word(axis_letters[axes.first]) || statement.word(axis_letters[axes.second]))
        return refuse(execution, "use either RP= and AP= or the axes of the plane, not both",
                      ErrorCode::syntax);
    SiemensState& siemens = writable_siemens(execution.state);
    const bool incremental = execution.modal().distance == DistanceMode::incremental;
    const auto take = [&](const Word* word, std::optional<double>& value, double scale) {
        if (!word) return;
        const bool adds = word->addressing == Addressing::incremental
                          || (word->addressing == Addressing::modal && incremental);
        value = word->value * scale + (adds ? value.value_or(0.0) : 0.0);
    };
    const bool known = siemens.radius && siemens.angle_deg;
    if (!known && execution.modal().position[axes.first]
        && execution.modal().position[axes.second]) {
        const double along = *execution.modal().position[axes.first] - siemens.pole[0];
        const double across = *execution.modal().position[axes.second] - siemens.pole[1];
        if (!siemens.radius) siemens.radius = core::hypot(along, across);
        if (!siemens.angle_deg)
            siemens.angle_deg = core::atan2(across, along) * core::degrees_per_radian;
    }
    take(statement.polar_radius, siemens.radius, to_mm(1.0, execution.modal().unit));
    take(statement.polar_angle, siemens.angle_deg, 1.0);
    if (!siemens.radius || !siemens.angle_deg)
        return refuse(
            execution,
            "RP= or AP= is missing, and it cannot be taken from the position, which is unknown",
            ErrorCode::missing_value);
    if (*siemens.radius < 0.0) return refuse(execution, "RP= must not be negative");
    Statement without = statement;
    without.polar_radius = without.polar_angle = nullptr;
    const Execution shared{
        execution.library, execution.environment, execution.dialect, execution.block,
        without,           execution.state,       execution.result,  execution.column};
    FEELER_TRY(Position target, target_of(shared));
    target[axes.first] =
        siemens.pole[0]
        + *siemens.radius * core::cos(*siemens.angle_deg / core::degrees_per_radian);
    target[axes.second] =
        siemens.pole[1]
        + *siemens.radius * core::sin(*siemens.angle_deg / core::degrees_per_radian);
    return target;
}

core::Result<void> move_polar(Execution& execution) {
    FEELER_TRY(const Position end, polar_target(execution));
    const auto motion = execution.modal().motion;
    if (is_straight(motion)) return go_straight(execution, end);
    if (!is_arc(motion))
        return refuse(execution, "RP= and AP= can only be used with G0 to G3", ErrorCode::syntax);
    const Word* word = execution.statement.word('P');
    const int turns = word ? static_cast<int>(std::clamp(word->value, 1.0, 1000.0)) : 1;
    return go_along_arc(execution, end, siemens_of(execution.state).pole,
                        motion == MotionCode::arc_clockwise ? -turns : turns);
}

const Word* between_word(const Execution& execution, size_t axis) {
    for (const Word& word : execution.block.words)
        if (word.letter == "ijk"[axis]) return &word;
    return nullptr;
}

/// CIP: the circle through the current position, the point of I1, J1, K1 and the end point.
core::Result<void> move_by_point(Execution& execution) {
    ModalState& modal = execution.modal();
    const PlaneAxes axes = axes_of(modal.plane);
    FEELER_TRY(const Position end, target_of(execution));
    Position between = modal.position;
    for (size_t axis = 0; axis < 3; ++axis) {
        const Word* word = between_word(execution, axis);
        if (!word) continue;
        if (axis == axes.normal)
            return refuse(execution,
                          "arcs outside the plane are not supported yet: remove the third of I1=, "
                          "J1= and K1=",
                          ErrorCode::unsupported);
        const double value = to_mm(word->value, modal.unit);
        const bool absolute = word->addressing == Addressing::modal
                                  ? modal.distance == DistanceMode::absolute
                                  : is_absolute(word->addressing);
        between[axis] = value + (absolute ? 0.0 : between[axis].value_or(0.0));
    }
    FEELER_TRY(const Point a, plane_point(execution, modal.position));
    FEELER_TRY(const Point b, plane_point(execution, between));
    FEELER_TRY(const Point c, plane_point(execution, end));
    const double bx = b[0] - a[0], by = b[1] - a[1], cx = c[0] - a[0], cy = c[1] - a[1];
    const double cross = bx * cy - by * cx;
    if (std::abs(cross) < 1e-9)
        return refuse(execution, "CIP needs three points that are not on one line: give the "
                                 "intermediate point with I1=, J1= and K1=");
    const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
    const Point centre = {a[0] + (cy * b2 - by * c2) / (2.0 * cross),
                          a[1] + (bx * c2 - cx * b2) / (2.0 * cross)};
    return go_along_arc(execution, end, centre, cross > 0.0 ? 1 : -1);
}

/// CT: the arc that continues the previous motion tangentially.
core::Result<void> move_tangentially(Execution& execution) {
    FEELER_TRY(const Position end, target_of(execution));
    const Point& direction = execution.modal().direction;
    if (direction == Point{})
        return refuse(execution, "CT has no previous move in the plane to continue tangentially");
    FEELER_TRY(const Point from, plane_point(execution, execution.modal().position));
    FEELER_TRY(const Point to, plane_point(execution, end));
    const double way[2] = {to[0] - from[0], to[1] - from[1]};
    const double left[2] = {-direction[1], direction[0]};
    const double aside = way[0] * left[0] + way[1] * left[1];
    const double ahead = way[0] * direction[0] + way[1] * direction[1];
    const double squared = way[0] * way[0] + way[1] * way[1];
    if (std::abs(aside) <= 1e-9 * std::sqrt(squared)) {
        if (ahead <= 0.0)
            return refuse(
                execution,
                "no arc that continues the previous move tangentially ends at this point");
        FEELER_TRY(const double rate, feed_rate(execution, std::sqrt(squared)));
        execution.feed(end, rate);
        return {};
    }
    const double radius = squared / (2.0 * aside);
    const Point centre = {from[0] + radius * left[0], from[1] + radius * left[1]};
    return go_along_arc(execution, end, centre, radius > 0.0 ? 1 : -1);
}

/// AR=: the opening angle of the arc, with its end point or its centre.
core::Result<void> move_by_angle(Execution& execution, const Word& opening) {
    const ModalState& modal = execution.modal();
    const PlaneAxes axes = axes_of(modal.plane);
    const Statement& statement = execution.statement;
    const double angle = opening.value / core::degrees_per_radian;
    if (!(opening.value > 0.0 && opening.value < 360.0))
        return refuse(execution, "AR= must be between 0 and 360 degrees");
    const double sign = modal.motion == MotionCode::arc_clockwise ? -1.0 : 1.0;
    FEELER_TRY(Position end, target_of(execution));
    FEELER_TRY(const Point from, plane_point(execution, modal.position));
    const Word* words[] = {statement.word("IJK"[axes.first]), statement.word("IJK"[axes.second])};
    if (words[0] || words[1]) {
        Point centre = from;
        for (size_t i = 0; i < 2; ++i)
            if (words[i])
                centre[i] = length_of(execution, *words[i])
                            + (is_absolute(words[i]->addressing) ? 0.0 : from[i]);
        const double along = from[0] - centre[0], across = from[1] - centre[1];
        const double turn = sign * angle;
        end[axes.first] = centre[0] + along * core::cos(turn) - across * core::sin(turn);
        end[axes.second] = centre[1] + along * core::sin(turn) + across * core::cos(turn);
        return go_along_arc(execution, end, centre, static_cast<int>(sign));
    }
    FEELER_TRY(const Point to, plane_point(execution, end));
    const double chord[2] = {to[0] - from[0], to[1] - from[1]};
    if (core::hypot(chord[0], chord[1]) < 1e-9)
        return refuse(execution,
                      "an arc with AR= needs an end point different from its start, or a centre");
    const double height = sign / (2.0 * core::tan(angle / 2.0));
    const Point centre = {0.5 * (from[0] + to[0]) - height * chord[1],
                          0.5 * (from[1] + to[1]) + height * chord[0]};
    return go_along_arc(execution, end, centre, static_cast<int>(sign));
}

/// G331 and G332: synchronised with the spindle into the hole and out, with the pitch along the
/// tool axis.
core::Result<void> read_tapping(Execution& execution) {
    const ModalState& modal = execution.modal();
    const PlaneAxes axes = axes_of(modal.plane);
    const Word* pitch = execution.statement.word("IJK"[axes.normal]);
    if (!pitch)
        return refuse(execution, fmt::format("the pitch {} is missing", "IJK"[axes.normal]),
                      ErrorCode::missing_value);
    FEELER_TRY(const Position end, target_of(execution));
    const double rate = std::abs(length_of(execution, *pitch)) * modal.speed;
    if (!(rate > 0.0))
        return refuse(execution, "the spindle has no speed S", ErrorCode::missing_value);
    execution.feed(end, rate);
    return {};
}

/// G33: the pitch belongs to the axis with the longer travel.
core::Result<void> cut_thread(Execution& execution) {
    const Statement& statement = execution.statement;
    const Word* pitch = nullptr;
    for (const char letter : {'I', 'J', 'K'})
        if (const Word* word = statement.word(letter)) pitch = word;
    if (!pitch)
        return refuse(execution, "the pitch I, J or K is missing", ErrorCode::missing_value);
    FEELER_TRY(const Position end, target_of(execution));
    execution.emit(ThreadFeed{end, length_of(execution, *pitch), false});
    execution.modal().position = end;
    return {};
}

/// Stores the direction at the end of the block's last motion.
void remember_direction(Execution& execution, const Position& start) {
    if (execution.result.commands.empty()) return;
    const PlaneAxes axes = axes_of(execution.modal().plane);
    const Position& end = execution.modal().position;
    const auto known = [&](const Position& position) {
        return position[axes.first] && position[axes.second];
    };
    Point& direction = execution.modal().direction;
    if (!known(start) || !known(end)) {
        direction = {};
    } else {
        Point way = {*end[axes.first] - *start[axes.first],
                     *end[axes.second] - *start[axes.second]};
        if (const auto* arc = std::get_if<ArcFeed>(&execution.result.commands.back())) {
            const double turn = arc->turns > 0 ? 1.0 : -1.0;
            way = {-turn * (*end[axes.second] - arc->centre[1]),
                   turn * (*end[axes.first] - arc->centre[0])};
        }
        const double length = core::hypot(way[0], way[1]);
        if (length > 1e-9) direction = {way[0] / length, way[1] / length};
    }
}

core::Result<void> check_scaled_arc(const Execution& execution) {
    const ProgramFrame& frame = siemens_of(execution.state).frame;
    const PlaneAxes axes = axes_of(execution.modal().plane);
    if (!execution.modal().offsets.has_frame || axes.first > 2) return {};
    const double first = glm::length(frame.linear[static_cast<int>(axes.first)]);
    const double second = glm::length(frame.linear[static_cast<int>(axes.second)]);
    if (std::abs(first - second) < 1e-12) return {};
    return refuse(execution,
                  "SCALE uses different factors for the axes of the plane, so the result is not an "
                  "arc: use the same factor for both",
                  ErrorCode::unsupported);
}

core::Result<void> move_by_mode(Execution& execution) {
    const ModalState& modal = execution.modal();
    const Statement& statement = execution.statement;
    const MotionCode motion = modal.motion.value_or(MotionCode::straight);
    const bool arc = is_arc(motion) || motion == by_point || motion == by_tangent;
    if (arc)
        if (auto checked = check_scaled_arc(execution); !checked) return checked;
    if (statement.polar_radius || statement.polar_angle) return move_polar(execution);
    if (motion == by_point) return move_by_point(execution);
    if (motion == by_tangent) return move_tangentially(execution);
    if (motion == MotionCode::tap_in || motion == MotionCode::tap_out)
        return read_tapping(execution);
    if (motion == MotionCode::spindle_feed) return cut_thread(execution);
    if (motion == MotionCode::compensated_tap) {
        FEELER_TRY(const Position end, target_of(execution));
        return go_straight(execution, end);
    }
    if (const Word* opening = statement.word('E'); opening && arc)
        return move_by_angle(execution, *opening);
    return move(execution);
}

bool changes_frame(SiemensAction action) {
    switch (action) {
    case SiemensAction::shift:
    case SiemensAction::add_shift:
    case SiemensAction::turn:
    case SiemensAction::add_turn:
    case SiemensAction::space_turn:
    case SiemensAction::add_space_turn:
    case SiemensAction::scale:
    case SiemensAction::add_scale:
    case SiemensAction::mirror:
    case SiemensAction::add_mirror:
        return true;
    default:
        return false;
    }
}

bool has_frame_words(const Execution& execution) {
    for (const SiemensKeywordUse& use : siemens_of(execution.block).keywords)
        if (changes_frame(use.keyword->action)) return true;
    return false;
}

} // namespace

namespace {

/// Sets the motion code for the block.
void take_motion_code(Execution& execution) {
    ModalState& modal = execution.modal();
    const CodeWord* code = execution.statement.of(ModalGroup::motion);
    if (code) modal.motion = motion_of(code->code->number);
    if (use_of(execution, SiemensAction::arc_by_point)) modal.motion = by_point;
    if (use_of(execution, SiemensAction::tangent_arc)) modal.motion = by_tangent;
}

core::Result<void> make_motion(Execution& execution) {
    const Statement& statement = execution.statement;
    ModalState& modal = execution.modal();
    if (has_frame_words(execution) || statement.axis_word_owner()) return {};
    const bool circles = is_arc(modal.motion);
    const bool moves =
        statement.has_axis_word() || vector_words(execution.block, direction_letters)
        || vector_words(execution.block, angle_letters)
        || use_of(execution, SiemensAction::angle_to_path)
        || (circles && (statement.word('I') || statement.word('J') || statement.word('K')));
    if (!moves) return {};
    if (!modal.motion) modal.motion = MotionCode::straight; // default: G1 is active at the start
    if (auto prepared = prepare_orientation(execution); !prepared) return prepared;
    settle_length(execution, !circles && modal.motion != by_point && modal.motion != by_tangent);
    const Position start = modal.position;
    if (auto moved = move_by_mode(execution); !moved) return moved;
    const bool mixes = mixes_axes(modal.offsets) || statement.polar_radius || statement.polar_angle;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (statement.word(axis_letters[axis]) || (mixes && axis < 3))
            forget_travel(execution, axis);
    remember_direction(execution, start);
    return {};
}

} // namespace

/// Source: SINUMERIK 840D sl, Programming Manual Fundamentals, G63: it acts in its block only; then
///         the motion code before it is active again.
core::Result<void> move_in_siemens(Execution& execution) {
    const std::optional<MotionCode> before = execution.modal().motion;
    take_motion_code(execution);
    if (auto moved = make_motion(execution); !moved) return moved;
    if (execution.modal().motion == MotionCode::compensated_tap) execution.modal().motion = before;
    return {};
}

core::Result<void> set_pole(Execution& execution) {
    const CodeWord& entry = *execution.statement.of(ModalGroup::action);
    ModalState& modal = execution.modal();
    const PlaneAxes axes = axes_of(modal.plane);
    SiemensState& siemens = writable_siemens(execution.state);
    const CodeNumber code = entry.code->number;
    std::array<double, 2> pole{};
    const size_t plane_axes[] = {axes.first, axes.second};
    for (size_t i = 0; i < 2; ++i) {
        // G110 is relative to the current position, G111 to the program zero, G112 to the last
        // pole.
        if (code == g_code(110) && !modal.position[plane_axes[i]])
            return core::fail(ErrorCode::missing_value,
                              fmt::format("G110: the {} position is unknown: use G111",
                                          axis_letters[plane_axes[i]]),
                              entry.word->span);
        pole[i] = code == g_code(110)   ? *modal.position[plane_axes[i]]
                  : code == g_code(112) ? siemens.pole[i]
                                        : 0.0;
        if (const Word* word = execution.statement.word(axis_letters[plane_axes[i]]))
            pole[i] += length_of(execution, *word);
    }
    if (execution.statement.polar_radius && execution.statement.polar_angle) {
        const double radius = length_of(execution, *execution.statement.polar_radius);
        const double angle = execution.statement.polar_angle->value / core::degrees_per_radian;
        pole[0] += radius * core::cos(angle);
        pole[1] += radius * core::sin(angle);
    }
    siemens.pole = pole;
    siemens.radius.reset();
    siemens.angle_deg.reset();
    return {};
}

} // namespace gcode
