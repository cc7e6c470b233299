#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/units.h"
#include "gcode/contour/flat_path.h"
#include "gcode/exec/frame_codes.h"
#include "gcode/klartext/klartext.h"
#include "gcode/klartext/klartext_parser.h"
#include "gcode/language/error_rules.h"
#include "gcode/text/source.h"

namespace gcode {
namespace {

using enum CommandKind;

constexpr double shortest = 1e-9; // mm: anything shorter has no direction

/// A motion of the contour: its end and its shape.
struct PathElement {
    Position end;
    PlanePoint centre{};
    int turn = 0;  // 0 for a straight line
    int turns = 1; // of an arc, as in ArcFeed but without sign
};

PlaneAxes plane_of(const Execution& execution) { return axes_of(execution.modal().plane); }

/// The position to which incremental words refer.
Position base_of(const Execution& execution) {
    const auto& corner = klartext_of(execution.state).corner;
    return corner ? corner->point : execution.modal().position;
}

core::Result<PlanePoint> known_point(const Execution& execution, const Position& position) {
    const PlaneAxes axes = plane_of(execution);
    for (const size_t axis : {axes.first, axes.second})
        if (!position[axis])
            return refuse_statement(execution,
                                    fmt::format("the {} position is unknown: move there first, or "
                                                "set [program] start in the set-up",
                                                axis_letters[axis]));
    return PlanePoint{*position[axes.first], *position[axes.second]};
}

core::Result<PlanePoint> known_pole(const Execution& execution) {
    const auto& pole = klartext_of(execution.state).pole;
    if (!pole[0] || !pole[1]) return refuse_statement(execution, "no CC has been programmed yet");
    return PlanePoint{*pole[0], *pole[1]};
}

/// The target of the axis words, relative to the programmed corner if there is one.
core::Result<Position> klartext_target(Execution& execution) {
    ModalState& modal = execution.modal();
    const Position before = modal.position;
    modal.position = base_of(execution);
    auto target = target_of(execution);
    modal.position = before;
    return target;
}

/// The target of PR and PA; a missing one keeps its current value.
core::Result<Position> polar_target(Execution& execution, double* turned_deg) {
    const PlaneAxes axes = plane_of(execution);
    FEELER_TRY(Position target, klartext_target(execution));
    FEELER_TRY(const PlanePoint pole, known_pole(execution));
    const Word* radius_word = execution.statement.word('P');
    const Word* angle_word = execution.statement.word('H');
    const auto relative = [](const Word* word) {
        return !word || word->addressing == Addressing::incremental;
    };
    double radius = 0.0, angle = 0.0;
    if (relative(radius_word) || relative(angle_word)) {
        FEELER_TRY(const PlanePoint from, known_point(execution, base_of(execution)));
        const double along = from[0] - pole[0], across = from[1] - pole[1];
        if (relative(radius_word)) radius = core::hypot(along, across);
        if (relative(angle_word)) angle = core::atan2(across, along) * core::degrees_per_radian;
    }
    if (radius_word) radius += length_of(execution, *radius_word);
    if (angle_word) angle += angle_word->value;
    if (turned_deg && angle_word && relative(angle_word)) *turned_deg = angle_word->value;
    target[axes.first] = pole[0] + radius * core::cos(angle / core::degrees_per_radian);
    target[axes.second] = pole[1] + radius * core::sin(angle / core::degrees_per_radian);
    return target;
}

core::Result<int> turn_of(const Execution& execution) {
    const int turn = klartext_of(execution.block).turn;
    if (turn == 0) return refuse_statement(execution, "DR+ or DR- is missing");
    return turn;
}

/// The error for an arc that is geometrically impossible.
tl::unexpected<core::Error> refuse_arc(const Execution& execution, std::string_view why) {
    tl::unexpected<core::Error> error = refuse_statement(execution, why);
    error.value().code = wrong_arc;
    return error;
}

/// Checks that the radii at start and end of an arc differ by no more than the control allows.
core::Result<void> check_radii(Execution& execution, const PlanePoint& start, const PlanePoint& end,
                               const PlanePoint& centre) {
    const double to_start = core::hypot(start[0] - centre[0], start[1] - centre[1]);
    const double to_end = core::hypot(end[0] - centre[0], end[1] - centre[1]);
    if (to_start < shortest)
        return refuse_arc(execution, "the arc has no radius: its centre is its start point");
    const double difference = std::abs(to_start - to_end);
    const ArcTolerance& allowed = execution.dialect.arc;
    if (difference <= allowed.absolute_mm) return {};
    const std::string message =
        fmt::format("the radius of the arc is {:.4f} mm at its start and {:.4f} mm at its end",
                    to_start, to_end);
    if (difference > allowed.warned_mm) return refuse_arc(execution, message);
    execution.warn(klartext_of(execution.block).span, message);
    return {};
}

core::Result<PathElement> around_pole(Execution& execution) {
    PathElement contour;
    double turned_deg = 0.0;
    FEELER_TRY(contour.turn, turn_of(execution));
    if (klartext_of(execution.block).kind == arc_polar) {
        FEELER_TRY(contour.end, polar_target(execution, &turned_deg));
    } else {
        FEELER_TRY(contour.end, klartext_target(execution));
    }
    FEELER_TRY(contour.centre, known_pole(execution));
    FEELER_TRY(const PlanePoint start, known_point(execution, execution.modal().position));
    FEELER_TRY(const PlanePoint end, known_point(execution, contour.end));
    if (turned_deg != 0.0) {
        if ((turned_deg > 0.0) != (contour.turn > 0))
            return refuse_statement(execution, "IPA and DR have different signs");
        contour.turns = std::max(
            1, static_cast<int>(std::ceil(std::min(std::abs(turned_deg), 1e8) / 360.0 - 1e-9)));
    }
    if (auto checked = check_radii(execution, start, end, contour.centre); !checked)
        return tl::unexpected(std::move(checked).error());
    return contour;
}

/// CR: R+ is the shorter arc, R- the longer one.
core::Result<PathElement> of_radius(Execution& execution) {
    PathElement contour;
    FEELER_TRY(contour.turn, turn_of(execution));
    FEELER_TRY(contour.end, klartext_target(execution));
    FEELER_TRY(const PlanePoint start, known_point(execution, execution.modal().position));
    FEELER_TRY(const PlanePoint end, known_point(execution, contour.end));
    const Word* word = execution.statement.word('R');
    if (!word) return refuse_statement(execution, "the radius R is missing");
    const double radius = length_of(execution, *word);
    const double chord[2] = {end[0] - start[0], end[1] - start[1]};
    const double half = 0.5 * core::hypot(chord[0], chord[1]);
    if (half < shortest)
        return refuse_statement(
            execution,
            "an arc with a radius cannot end where it starts: program a full circle with CC and C");
    if (half - std::abs(radius) > execution.dialect.arc.absolute_mm)
        return refuse_arc(execution, fmt::format("the radius {:.4f} mm is too small to reach the "
                                                 "end point: half the distance is {:.4f} mm",
                                                 std::abs(radius), half));
    const double height = std::sqrt(std::max(0.0, radius * radius - half * half));
    const double side = (radius > 0.0 ? contour.turn : -contour.turn) * height / (2.0 * half);
    contour.centre = {0.5 * (start[0] + end[0]) - side * chord[1],
                      0.5 * (start[1] + end[1]) + side * chord[0]};
    return contour;
}

/// The arc that continues the previous motion tangentially.
core::Result<PathElement> tangent(Execution& execution) {
    PathElement contour;
    if (klartext_of(execution.block).kind == tangent_polar) {
        FEELER_TRY(contour.end, polar_target(execution, nullptr));
    } else {
        FEELER_TRY(contour.end, klartext_target(execution));
    }
    const auto& direction = klartext_of(execution.state).direction;
    if (!direction)
        return refuse_statement(execution,
                                "there is no previous move in the plane to continue tangentially");
    FEELER_TRY(const PlanePoint start, known_point(execution, execution.modal().position));
    FEELER_TRY(const PlanePoint end, known_point(execution, contour.end));
    const double way[2] = {end[0] - start[0], end[1] - start[1]};
    const double left[2] = {-(*direction)[1], (*direction)[0]};
    const double aside = way[0] * left[0] + way[1] * left[1];
    const double ahead = way[0] * (*direction)[0] + way[1] * (*direction)[1];
    const double squared = way[0] * way[0] + way[1] * way[1];
    if (std::abs(aside) <= 1e-9 * std::sqrt(squared)) {
        if (ahead > 0.0) return contour; // straight on
        return refuse_statement(
            execution, "no arc that continues the previous move tangentially ends at this point");
    }
    const double radius = squared / (2.0 * aside); // positive to the left
    contour.turn = radius > 0.0 ? 1 : -1;
    contour.centre = {start[0] + radius * left[0], start[1] + radius * left[1]};
    return contour;
}

core::Result<PathElement> contour_of(Execution& execution) {
    PathElement contour;
    switch (klartext_of(execution.block).kind) {
    case straight_polar: {
        FEELER_TRY(contour.end, polar_target(execution, nullptr));
        return contour;
    }
    case arc:
    case arc_polar:
        return around_pole(execution);
    case arc_of_radius:
        return of_radius(execution);
    case tangent_arc:
    case tangent_polar:
        return tangent(execution);
    default: {
        FEELER_TRY(contour.end, klartext_target(execution));
        return contour;
    }
    }
}

/// Stores the direction at the end of a motion.
void remember_direction(Execution& execution, const Position& start, const PathElement& contour,
                        const Position& end) {
    const PlaneAxes axes = plane_of(execution);
    KlartextState& klartext = writable_klartext(execution.state);
    const auto known = [&](const Position& position) {
        return position[axes.first] && position[axes.second];
    };
    if (!known(end) || (contour.turn == 0 && !known(start))) {
        klartext.direction.reset();
        return;
    }
    PlanePoint way;
    if (contour.turn == 0)
        way = {*end[axes.first] - *start[axes.first], *end[axes.second] - *start[axes.second]};
    else
        way = {-contour.turn * (*end[axes.second] - contour.centre[1]),
               contour.turn * (*end[axes.first] - contour.centre[0])};
    const double length = core::hypot(way[0], way[1]);
    if (length > shortest) klartext.direction = PlanePoint{way[0] / length, way[1] / length};
}

core::Result<void> go_along(Execution& execution, const PathElement& contour) {
    ModalState& modal = execution.modal();
    const bool rapid = klartext_of(execution.block).rapid;
    if (contour.turn == 0 && rapid) {
        execution.traverse(contour.end);
        return {};
    }
    if (rapid)
        execution.warn(klartext_of(execution.block).span,
                       "FMAX on an arc is checked as a move at feed rate F");
    FEELER_TRY(const double feed, klartext_feed(execution));
    if (contour.turn == 0) {
        execution.feed(contour.end, feed);
        return {};
    }
    modal.position = contour.end;
    execution.emit(ArcFeed{.end = contour.end,
                           .plane = modal.plane,
                           .centre = {contour.centre[0], contour.centre[1]},
                           .turns = contour.turn * contour.turns,
                           .feed = feed});
    return {};
}

/// CC: sets the pole; without axis words, to the current position.
core::Result<void> set_pole(Execution& execution) {
    const PlaneAxes axes = plane_of(execution);
    const Statement& statement = execution.statement;
    if (const Word* word = statement.word(axis_letters[axes.normal]))
        return refuse_statement(
            execution,
            fmt::format("{}: arcs outside the working plane are not supported yet: use short lines",
                        written(*word)));
    const Position base = base_of(execution);
    std::array<std::optional<double>, 2> pole = klartext_of(execution.state).pole;
    const size_t plane_axes[] = {axes.first, axes.second};
    const bool here =
        !statement.word(axis_letters[axes.first]) && !statement.word(axis_letters[axes.second]);
    for (size_t i = 0; i < 2; ++i) {
        const Word* word = statement.word(axis_letters[plane_axes[i]]);
        const std::optional<double>& from = base[plane_axes[i]];
        if (here) pole[i] = from;
        if (!word) continue;
        const double value = axis_value(execution, plane_axes[i], *word);
        if (word->addressing != Addressing::incremental)
            pole[i] = value;
        else
            pole[i] = from ? std::optional(*from + value) : std::nullopt;
    }
    writable_klartext(execution.state).pole = pole;
    return {};
}

} // namespace

/// Source: Heidenhain, User's Manual Cycle Programming, "Calling a cycle with CYCL CALL POS": from
///         above the surface the tool first moves in the plane, from below it first along its axis.
core::Result<void> go_to_cycle(Execution& execution, double surface, double above) {
    const PlaneAxes axes = plane_of(execution);
    FEELER_TRY(const Position target, klartext_target(execution));
    writable_klartext(execution.state).corner.reset();
    const auto go = [&](const Position& end) {
        return end == execution.modal().position ? core::Result<void>{}
                                                 : go_along(execution, {.end = end});
    };
    Position over = execution.modal().position;
    if (over[axes.normal] && *over[axes.normal] < surface) over[axes.normal] = above;
    if (auto done = go(over); !done) return done;
    over[axes.first] = target[axes.first];
    over[axes.second] = target[axes.second];
    if (auto done = go(over); !done) return done;
    over[axes.normal] = above;
    return go(over);
}

core::Result<void> move_in_klartext(Execution& execution) {
    const KlartextLine& command = klartext_of(execution.block);
    const Statement& statement = execution.statement;
    if (command.kind == pole) return set_pole(execution);
    const bool still = (command.kind == straight || command.kind == cycle_call)
                       && !statement.has_axis_word() && !tool_direction(execution);
    if (still || command.calls_at_point) return {};
    const Position start = execution.modal().position;
    FEELER_TRY(PathElement contour, contour_of(execution));
    writable_klartext(execution.state).corner.reset();
    FEELER_TRY(contour.end,
               end_before_corner(execution, contour.end, contour.centre, contour.turn));
    if (auto done = go_along(execution, contour); !done) return done;
    remember_direction(execution, start, contour, contour.end);
    return {};
}

namespace {

using core::ErrorCode;

constexpr int most_blocks_ahead = 1000;

/// The next block, if it is a rounding or chamfer.
core::Result<std::optional<Block>> corner_after(const Execution& execution) {
    const Program& program = execution.library.program(execution.state.next.source);
    Block block;
    for (uint32_t line = execution.state.next.line; line <= program.line_count();) {
        const std::string_view text = klartext_block(program, line);
        const size_t keyword = text.find_first_not_of("0123456789 \t/");
        const bool may_be =
            keyword != std::string_view::npos
            && (text.substr(keyword).starts_with("RND") || text.substr(keyword).starts_with("CHF"));
        const bool says_nothing =
            keyword == std::string_view::npos || text[keyword] == ';' || text[keyword] == '*';
        if (!may_be && !says_nothing) return std::optional<Block>{};
        if (may_be) {
            block.clear();
            block.line = line;
            block.text = text;
            auto parsed = parse_klartext(text, line, execution.dialect, block);
            if (!parsed) return tl::unexpected(std::move(parsed).error());
            return std::optional<Block>(std::move(block));
        }
        line += lines_of(text);
    }
    return std::optional<Block>{};
}

/// The size of the corner: a radius, or the leg of the chamfer.
core::Result<double> size_of_corner(Execution& execution, const Block& block) {
    const ProgramParameters parameters(execution.state, execution.environment);
    for (const Word& word : block.words) {
        if (word.letter != 'R') continue;
        double value = word.value;
        if (word.expression) {
            FEELER_TRY(const Value found, evaluate(block.pool, word.expression, block.line,
                                                   parameters, execution.dialect.arithmetic));
            value = found.value_or(0.0);
        }
        if (value < 0.0)
            return core::fail(
                ErrorCode::invalid_value,
                fmt::format("{:.12g}: the size of a corner must not be negative", value),
                word.span);
        return to_mm(value, execution.modal().unit);
    }
    return core::fail(ErrorCode::missing_value, "RND needs R with a radius, CHF a length",
                      klartext_of(block).span);
}

PlanePoint plane_point(FlatPoint point) { return {point.u, point.v}; }

FlatPoint flat(const Position& position, const PlaneAxes& axes) {
    return {position[axes.first].value_or(0.0), position[axes.second].value_or(0.0)};
}

bool is_known(const Position& position, const PlaneAxes& axes) {
    return position[axes.first] && position[axes.second];
}

/// The motion after the corner, found by running the program ahead on a copy of the state.
core::Result<std::optional<CornerSide>> motion_ahead(Execution& execution, const Position& end,
                                                     const CornerSide& before) {
    InterpreterState ahead = execution.state;
    ahead.modal.position = end;
    writable_klartext(ahead).looks_ahead = true;
    writable_klartext(ahead).corner.reset();
    if (has_length(before))
        writable_klartext(ahead).direction = plane_point(heading_at(before, before.end));
    Interpreter interpreter(execution.library, execution.environment);
    const PlaneAxes axes = axes_of(execution.modal().plane);
    for (int count = 0; count < most_blocks_ahead; ++count) {
        FEELER_TRY(const BlockCommands* const found, interpreter.next(ahead));
        if (!found) break;
        for (const CanonicalCommand& command : found->commands) {
            const auto* arc = std::get_if<ArcFeed>(&command);
            const auto* straight = std::get_if<StraightFeed>(&command);
            if (!arc && !straight) continue;
            const Position& to = arc ? arc->end : straight->end;
            if (!is_known(to, axes) || to[axes.normal] != end[axes.normal])
                return std::optional<CornerSide>{};
            CornerSide side{.start = flat(end, axes), .end = flat(to, axes)};
            if (arc) side.arc = FlatArc{{arc->centre[0], arc->centre[1]}, arc->turns};
            return std::optional(side);
        }
    }
    return std::optional<CornerSide>{};
}

core::Error refusal(const Block& corner, std::string_view why) {
    const bool rounds = klartext_of(corner).kind == CommandKind::rounding;
    return {ErrorCode::invalid_value, klartext_of(corner).span,
            fmt::format("{}: {}", rounds ? "RND" : "CHF", why)};
}

/// Why a corner is impossible; empty when it is possible or not needed.
std::string_view fault_of(const CornerCut& cut, CornerKind kind) {
    switch (cut.fit) {
    case CornerFit::no_length:
        return "the move before or after it has no length";
    case CornerFit::none:
        return kind == CornerKind::rounding
                   ? "no rounding of this size fits between the two moves"
                   : "a chamfer is only possible between two straight lines";
    case CornerFit::too_large:
        return "it is too large for the moves before and after it";
    default:
        return {};
    }
}

/// Fits the corner between two motions and stores it.
core::Result<Position> lay_corner(Execution& execution, const Block& block, const Position& end,
                                  const CornerSide& first, double corner_size) {
    FEELER_TRY(const auto second, motion_ahead(execution, end, first));
    if (!second)
        return tl::unexpected(
            refusal(block, "it must be followed by a feed move in the plane at the same height"));
    const CornerKind kind = klartext_of(block).kind == CommandKind::rounding ? CornerKind::rounding
                                                                             : CornerKind::chamfer;
    CornerCut cut = cut_corner(first, *second, kind, corner_size);
    const bool curved = first.arc || second->arc;
    if (kind == CornerKind::chamfer && curved && cut.fit != CornerFit::no_length)
        cut.fit = CornerFit::none;
    if (const std::string_view fault = fault_of(cut, kind); !fault.empty())
        return tl::unexpected(refusal(block, fault));
    if (cut.fit == CornerFit::straight_on) return end; // no corner to round
    const PlaneAxes axes = axes_of(execution.modal().plane);
    Position from = end, to = end;
    from[axes.first] = cut.from.u;
    from[axes.second] = cut.from.v;
    to[axes.first] = cut.to.u;
    to[axes.second] = cut.to.v;
    Corner corner{.point = end, .end = to, .direction = plane_point(cut.heading)};
    if (cut.arc) {
        corner.centre = plane_point(cut.arc->centre);
        corner.turn = cut.arc->turns;
    }
    writable_klartext(execution.state).corner = corner;
    return from;
}

} // namespace

core::Result<Position> end_before_corner(Execution& execution, const Position& end,
                                         const PlanePoint& centre, int turn) {
    if (klartext_of(execution.state).looks_ahead) return end;
    FEELER_TRY(const std::optional<Block> block, corner_after(execution));
    if (!block) return end;
    FEELER_TRY(const double corner_size, size_of_corner(execution, *block));
    if (corner_size == 0.0) return end;
    const PlaneAxes axes = axes_of(execution.modal().plane);
    const Position& start = execution.modal().position;
    if (!is_known(start, axes) || !is_known(end, axes))
        return tl::unexpected(
            refusal(*block, "the start position of the move before it is unknown"));
    if (start[axes.normal] != end[axes.normal])
        return tl::unexpected(refusal(*block, "the move before it changes height"));
    CornerSide before{.start = flat(start, axes), .end = flat(end, axes)};
    if (turn != 0) before.arc = FlatArc{{centre[0], centre[1]}, turn};
    return lay_corner(execution, *block, end, before, corner_size);
}

/// RND, CHF: makes the corner that end_before_corner has stored.
core::Result<void> make_corner(Execution& execution) {
    const KlartextState& before = klartext_of(execution.state);
    if (before.looks_ahead || !before.corner || before.corner->is_done) return {};
    const Corner corner = *before.corner;
    std::optional<double> feed = execution.modal().feed;
    if (const Word* word = execution.statement.word('F')) feed = length_of(execution, *word);
    if (!feed || *feed <= 0.0) return refuse_statement(execution, no_feed_yet);
    if (corner.turn == 0) {
        execution.feed(corner.end, *feed);
    } else {
        execution.modal().position = corner.end;
        execution.emit(ArcFeed{.end = corner.end,
                               .plane = execution.modal().plane,
                               .centre = {corner.centre[0], corner.centre[1]},
                               .turns = corner.turn,
                               .feed = *feed});
    }
    KlartextState& klartext = writable_klartext(execution.state);
    klartext.corner->is_done = true;
    // CT continues in the direction of the motion into which the rounding leads.
    klartext.direction = corner.direction;
    return {};
}

} // namespace gcode
