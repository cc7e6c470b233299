#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/base/math.h"
#include "gcode/contour/flat_path.h"
#include "gcode/exec/execution.h"
#include "gcode/exec/frame_codes.h"
#include "gcode/exec/readings.h"
#include "gcode/language/control.h"
#include "gcode/language/error_rules.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// An arc in its plane: coordinates along the plane's first and second axis.
struct SeenArc {
    core::SourceSpan where;
    std::string code; // G2 or G3, for messages
    bool clockwise;
    double start[2], end[2];
};

/// By how much R may be less than half the distance to the end, mm (LinuxCNC: RADIUS_TOLERANCE).
constexpr double reach_tolerance = 0.00127;

core::Result<void> check_radii(Execution& execution, const SeenArc& arc, const double* centre) {
    const double to_start = core::hypot(arc.start[0] - centre[0], arc.start[1] - centre[1]);
    const double to_end = core::hypot(arc.end[0] - centre[0], arc.end[1] - centre[1]);
    if (to_start < reach_tolerance || to_end < reach_tolerance)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: the arc has no radius: its centre is on its {}",
                                      arc.code, to_start < reach_tolerance ? "start" : "end"),
                          arc.where);
    ArcTolerance allowed = execution.dialect.arc;
    const ControlSettings& control = execution.environment.control;
    const bool inch = execution.modal().unit == LengthUnit::inch;
    if (const auto stated = control.number(ControlQuestion::arc_tolerance)) {
        allowed.absolute_mm = *stated;
        allowed.absolute_inch = from_mm(*stated, LengthUnit::inch);
        allowed.warned_mm = 0.0;
    }
    if (const auto stated = control.number(ControlQuestion::arc_tolerance_inch))
        allowed.absolute_inch = *stated;
    const double absolute =
        inch ? to_mm(allowed.absolute_inch, LengthUnit::inch) : allowed.absolute_mm;
    const double difference = std::abs(to_start - to_end);
    const bool relative = difference <= absolute * allowed.limit
                          && difference <= allowed.relative * std::max(to_start, to_end);
    if (difference <= absolute || relative) return {};
    const std::string message =
        fmt::format("{}: the radius of the arc is {:.4f} mm at its start and {:.4f} mm at its end",
                    arc.code, to_start, to_end);
    if (difference > allowed.warned_mm)
        return core::fail(ErrorCode::invalid_value, message, arc.where);
    execution.warn(arc.where, message);
    return {};
}

/// The centre words of the plane's axes: I for X, J for Y, K for Z.
struct CentreWords {
    const Word* first;
    const Word* second;
};

bool fits_as_coordinates(const Execution& execution, const SeenArc& arc, const CentreWords& words) {
    if (!words.first || !words.second) return false;
    const double centre[2] = {length_of(execution, *words.first),
                              length_of(execution, *words.second)};
    const double to_start = core::hypot(arc.start[0] - centre[0], arc.start[1] - centre[1]);
    const double to_end = core::hypot(arc.end[0] - centre[0], arc.end[1] - centre[1]);
    return to_start > reach_tolerance && std::abs(to_start - to_end) < reach_tolerance;
}

core::Result<void> centre_from_offsets(Execution& execution, const SeenArc& arc,
                                       const CentreWords& words, double* centre) {
    const bool absolute = execution.modal().arc_distance == DistanceMode::absolute;
    const auto origin = [&](const Word* word, double start) {
        const bool own = word && word->addressing != Addressing::modal;
        return (own ? is_absolute(word->addressing) : absolute) ? 0.0 : start;
    };
    if (absolute && !(words.first && words.second))
        return core::fail(
            ErrorCode::missing_value,
            fmt::format("{}: with G90.1 an arc needs both words of its centre", arc.code),
            arc.where);
    centre[0] = origin(words.first, arc.start[0])
                + (words.first ? length_of(execution, *words.first) : 0.0);
    centre[1] = origin(words.second, arc.start[1])
                + (words.second ? length_of(execution, *words.second) : 0.0);
    auto checked = check_radii(execution, arc, centre);
    if (!checked && !absolute && fits_as_coordinates(execution, arc, words))
        checked.error().message += "; it would fit if the centre words were absolute coordinates "
                                   "(G90.1) rather than distances from the start";
    return checked;
}

/// The centre lies on the perpendicular bisector of the chord, on the side given by the sign of R
/// and the direction of the arc.
core::Result<void> centre_from_radius(const SeenArc& arc, const Word& word, double radius,
                                      double* centre) {
    const double chord[2] = {arc.end[0] - arc.start[0], arc.end[1] - arc.start[1]};
    const double half = 0.5 * core::hypot(chord[0], chord[1]);
    if (half == 0.0)
        return core::fail(
            ErrorCode::invalid_value,
            fmt::format(
                "{}: an arc with R cannot end where it starts; give the centre with I, J, K",
                written(word)),
            word.span);
    if (half - std::abs(radius) > reach_tolerance)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: the radius {:.4f} mm is too small to reach the end "
                                      "point: half the distance is {:.4f} mm",
                                      written(word), std::abs(radius), half),
                          word.span);
    const double height = std::sqrt(std::max(0.0, radius * radius - half * half));
    const bool right_of_chord = arc.clockwise == (radius > 0.0);
    const double side = (right_of_chord ? -height : height) / (2.0 * half);
    centre[0] = 0.5 * (arc.start[0] + arc.end[0]) - side * chord[1];
    centre[1] = 0.5 * (arc.start[1] + arc.end[1]) + side * chord[0];
    return {};
}

/// The end of a message about an arc without a centre: what the control may do instead.
std::string_view straight_instead(const Execution& execution) {
    constexpr ControlQuestion question = ControlQuestion::lone_arc_is_straight;
    if (!find_parameter(question, execution.environment.dialect)) return {};
    return "; with parameter 3403#5 (CIR) = 0 the control goes straight instead, otherwise it "
           "stops "
           "with an alarm: state it under [control] in the set-up";
}

core::Result<void> centre_of_words(Execution& execution, const SeenArc& arc, const PlaneAxes& axes,
                                   double* centre) {
    constexpr char offset_letters[] = {'I', 'J', 'K', 0, 0, 0, 'I', 'J', 'K'};
    const Statement& statement = execution.statement;
    const CentreWords words = {statement.word(offset_letters[axes.first]),
                               statement.word(offset_letters[axes.second])};
    const Word* other = statement.word(offset_letters[axes.normal]);
    const Word* radius = statement.word('R');
    const bool is_ignored = other && !radius && execution.dialect.third_offset_is_ignored;
    if (is_ignored && other->value != 0.0)
        execution.warn(other->span, fmt::format("{}: the control ignores this word in {} here",
                                                written(*other), arc.code));
    const Word* surplus = other && !is_ignored ? other
                          : radius             ? (words.first ? words.first : words.second)
                                               : nullptr;
    if (surplus) {
        const std::string message =
            fmt::format("{}: {} does not use this word here", written(*surplus), arc.code);
        if (execution.dialect.unused_words_are_errors)
            return core::fail(ErrorCode::syntax, message, surplus->span);
        if (surplus->value != 0.0) execution.warn(surplus->span, message);
    }
    if (radius) return centre_from_radius(arc, *radius, length_of(execution, *radius), centre);
    if (words.first || words.second) return centre_from_offsets(execution, arc, words, centre);
    return core::fail(ErrorCode::missing_value,
                      fmt::format("{} has no centre: it needs {}, {} or {}{}", arc.code,
                                  offset_letters[axes.first], offset_letters[axes.second],
                                  execution.dialect.radius_word, straight_instead(execution)),
                      arc.where);
}

/// Finds the centre and checks that the arc ends at the programmed point.
core::Result<void> find_centre(Execution& execution, const SeenArc& arc, const PlaneAxes& axes,
                               double* centre) {
    auto found = centre_of_words(execution, arc, axes, centre);
    // A word that is not used says nothing about the arc.
    if (!found && found.error().code != ErrorCode::syntax) found.error().code = wrong_arc;
    return found;
}

core::Result<SeenArc> flat_arc(const Execution& execution, const PlaneAxes& axes,
                               const Position& end) {
    const bool clockwise = execution.modal().motion == MotionCode::arc_clockwise;
    SeenArc arc{.where = moving_word(execution).span,
                .code = clockwise ? "G2" : "G3",
                .clockwise = clockwise,
                .start = {},
                .end = {}};
    const Position& start = execution.modal().position;
    for (int i = 0; i < 2; ++i) {
        const size_t axis = i == 0 ? axes.first : axes.second;
        if (!start[axis] || !end[axis])
            return core::fail(ErrorCode::missing_value,
                              fmt::format("{}: the start position of the arc is unknown in {}: "
                                          "move there first, or set [program] start in the set-up",
                                          arc.code, axis_letters[axis]),
                              arc.where);
        arc.start[i] = *start[axis];
        arc.end[i] = *end[axis];
    }
    return arc;
}

/// Ends that are neither the same nor clearly apart: a control may make a full circle or next to
/// nothing. Grbl decides by the angle, in single floats.
core::Result<void> check_ends(const Execution& execution, const SeenArc& arc,
                              const double (&centre)[2]) {
    constexpr double least_angle = 1e-6; // radians
    const double gap = core::hypot(arc.end[0] - arc.start[0], arc.end[1] - arc.start[1]);
    const double radius = core::hypot(arc.start[0] - centre[0], arc.start[1] - centre[1]);
    if (gap < same_end) return {};
    const bool is_grbl = execution.dialect.id == DialectId::grbl;
    if (gap > other_end && !(is_grbl && gap < least_angle * radius)) return {};
    return core::fail(
        ErrorCode::unsupported,
        fmt::format("{}: the arc ends {:.3g} mm from its start, so the control may "
                    "make a full circle or none; let it end where it starts, or leave "
                    "it out",
                    arc.code, gap),
        arc.where);
}

core::Result<int> turns_of(const Execution& execution, bool clockwise) {
    const Word* word = execution.statement.word('P');
    if (!word) return clockwise ? -1 : 1;
    FEELER_TRY(const int turns, whole_number(*word, 1, 1000000));
    return clockwise ? -turns : turns;
}

/// Where LinuxCNC joins feeds, it takes small arcs of the XY plane for lines, and does not count
/// their full turns.
///
/// Source: emccanon.cc of LinuxCNC 2.9, ARC_FEED and chord_deviation.
core::Result<void> check_full_turns(const Execution& execution, const SeenArc& arc,
                                    const double (&centre)[2], int turns) {
    const ModalState& modal = execution.modal();
    if (execution.dialect.id != DialectId::linuxcnc || std::abs(turns) < 2
        || modal.plane != Plane::xy || modal.path != PathMode::continuous
        || modal.naive_tolerance == 0.0)
        return {};
    const double angle = arc_angle(arc.start, arc.end, centre, turns < 0 ? -1 : 1);
    const double radius = core::hypot(arc.start[0] - centre[0], arc.start[1] - centre[1]);
    constexpr double slack = 1e-6; // mm
    if (radius * (1.0 - core::cos(0.5 * angle)) >= modal.naive_tolerance + slack) return {};
    return core::fail(ErrorCode::unsupported,
                      fmt::format("{}: LinuxCNC leaves out the full turns of this arc, because its "
                                  "end is so near to its start that G64 Q{:g} makes lines of it; "
                                  "program it under G61, or each turn in a block of its own",
                                  arc.code, modal.naive_tolerance),
                      arc.where);
}

constexpr double chord_tolerance = 0.001; // mm

double& along(Position& position, size_t axis) { return *position[axis]; }

/// Moves along an R arc whose axes G51 scales unequally. On the machine it is an arc between the
/// scaled ends with the larger of the scale factors. It is emitted as chords, because the frame
/// would turn an arc into an ellipse.
///
/// Source: Fanuc 0i and 30i user's manuals, "Scaling of circular interpolation".
core::Result<void> move_along_scaled_arc(Execution& execution, const PlaneAxes& axes,
                                         const Word& radius) {
    FEELER_TRY(const Position end, target_of(execution));
    FEELER_TRY(SeenArc arc, flat_arc(execution, axes, end));
    const core::Vec3& factors = execution.modal().transforms.scaling->factors;
    const double scale[2] = {factors[static_cast<int>(axes.first)],
                             factors[static_cast<int>(axes.second)]};
    for (int i = 0; i < 2; ++i) {
        arc.start[i] *= scale[i];
        arc.end[i] *= scale[i];
    }
    if (scale[0] * scale[1] < 0.0) arc.clockwise = !arc.clockwise;
    const double larger = std::max(std::abs(scale[0]), std::abs(scale[1]));
    const double size = larger * length_of(execution, radius);
    double centre[2];
    if (auto found = centre_from_radius(arc, radius, size, centre); !found) {
        found.error().code = wrong_arc;
        return found;
    }
    const double angle = arc_angle(arc.start, arc.end, centre, arc.clockwise ? -1 : 1);
    FEELER_TRY(const double rate, feed_rate(execution, std::abs(size * angle)));
    execution.warn(arc.where, fmt::format("{}: G51 scales {} by {:.6g} and {} by {:.6g}; the "
                                          "control moves along an arc of radius {:.6g} mm",
                                          arc.code, axis_letters[axes.first], scale[0],
                                          axis_letters[axes.second], scale[1], std::abs(size)));
    const double step = 2.0 * core::acos(std::max(0.0, 1.0 - chord_tolerance / std::abs(size)));
    constexpr double most_chords = 1e6;
    if (!(std::abs(angle) <= most_chords * step))
        return core::fail(wrong_arc, fmt::format("{}: a radius of {:.6g} mm is too large for G51",
                                                 arc.code, std::abs(size)));
    const int chords = std::max(1, static_cast<int>(std::ceil(std::abs(angle) / step)));
    const double from = core::atan2(arc.start[1] - centre[1], arc.start[0] - centre[0]);
    const Position start = execution.modal().position;
    for (int chord = 1; chord < chords; ++chord) {
        const double fraction = double(chord) / chords, at = from + fraction * angle;
        Position position = end;
        along(position, axes.first) = (centre[0] + std::abs(size) * core::cos(at)) / scale[0];
        along(position, axes.second) = (centre[1] + std::abs(size) * core::sin(at)) / scale[1];
        if (const size_t axis = axes.normal; start[axis] && end[axis])
            along(position, axis) = *start[axis] + fraction * (*end[axis] - *start[axis]);
        execution.feed(position, rate);
    }
    execution.feed(end, rate);
    return {};
}

} // namespace

namespace {

/// Whether an arc with R ends where it starts, on a control that takes it as an arc of 0 degrees.
///
/// Source: Fanuc B-63944EN, 4.4, circular interpolation: without a motion for an arc by R whose end
///         is its start.
bool vanishes(Execution& execution, const Position& end) {
    const Word* radius = execution.statement.word('R');
    if (!radius || !execution.dialect.radius_arc_may_vanish || end != execution.modal().position)
        return false;
    execution.warn(radius->span,
                   fmt::format("{}: this arc ends where it starts and moves nothing: give the "
                               "centre with I, J, K if a full circle is meant",
                               written(*radius)));
    return true;
}

/// Whether the control goes straight instead of along an arc that has neither a centre nor a
/// radius.
bool goes_straight(Execution& execution) {
    for (const char letter : {'I', 'J', 'K', 'R'})
        if (execution.statement.word(letter)) return false;
    return answer_to(execution.state, execution.environment, ControlQuestion::lone_arc_is_straight,
                     execution.block.line);
}

core::Result<void> go_straight(Execution& execution, const Position& end) {
    const Word& mover = moving_word(execution);
    FEELER_TRY(const double rate,
               feed_rate(execution, distance_between(execution.modal().position, end)));
    execution.warn(mover.span, fmt::format("{}: without a centre and a radius the control goes "
                                           "straight (parameter 3403#5 (CIR) = 0)",
                                           written(mover)));
    execution.feed(end, rate);
    return {};
}

} // namespace

core::Result<void> move_along_arc(Execution& execution) {
    ModalState& modal = execution.modal();
    const PlaneAxes axes = axes_of(modal.plane);
    if (is_secondary(axes.first))
        return core::fail(ErrorCode::syntax,
                          fmt::format("{}: arcs are not possible in the G17.1, G18.1 and G19.1 "
                                      "planes: program G17, G18 or G19 first",
                                      written(moving_word(execution))),
                          moving_word(execution).span);
    if (auto checked = check_arc_in_frame(execution, axes); !checked) {
        const Word* radius = execution.statement.word('R');
        return radius ? move_along_scaled_arc(execution, axes, *radius) : checked;
    }
    if (modal.leaves_contour && execution.dialect.arc_after_contour_is_error)
        return core::fail(ErrorCode::syntax,
                          "the first move after G40 must be straight: an arc would not start at "
                          "the tool position",
                          moving_word(execution).span);
    FEELER_TRY(const Position end, target_of(execution));
    if (vanishes(execution, end)) return {};
    if (goes_straight(execution)) return go_straight(execution, end);
    FEELER_TRY(const SeenArc arc, flat_arc(execution, axes, end));
    ArcFeed command{.end = end, .plane = modal.plane, .centre = {}, .turns = 0, .feed = 0.0};
    if (auto found = find_centre(execution, arc, axes, command.centre); !found) return found;
    if (auto checked = check_ends(execution, arc, command.centre); !checked) return checked;
    FEELER_TRY(command.turns, turns_of(execution, arc.clockwise));
    if (auto checked = check_full_turns(execution, arc, command.centre, command.turns); !checked)
        return checked;
    const size_t normal = axes.normal;
    std::optional<double> rise;
    if (modal.position[normal] && end[normal]) rise = *end[normal] - *modal.position[normal];
    if (modal.position[normal] == end[normal]) rise = 0.0;
    const double radius =
        core::hypot(arc.start[0] - command.centre[0], arc.start[1] - command.centre[1]);
    const double angle = arc_angle(arc.start, arc.end, command.centre, command.turns);
    std::optional<double> path;
    if (rise) path = core::hypot(radius * angle, *rise);
    FEELER_TRY(command.feed, feed_rate(execution, path));
    modal.position = end;
    execution.emit(command);
    return {};
}

} // namespace gcode
