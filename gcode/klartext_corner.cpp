#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "gcode/klartext.h"
#include "gcode/klartext_parser.h"

namespace gcode {
namespace {

using core::ErrorCode;

constexpr double fuzz = 1e-9;
constexpr int most_blocks_ahead = 1000;

PlanePoint sum(const PlanePoint& a, const PlanePoint& b, double factor = 1.0) {
    return {a[0] + factor * b[0], a[1] + factor * b[1]};
}
double dot(const PlanePoint& a, const PlanePoint& b) { return a[0] * b[0] + a[1] * b[1]; }
double cross(const PlanePoint& a, const PlanePoint& b) { return a[0] * b[1] - a[1] * b[0]; }
double size(const PlanePoint& a) { return std::hypot(a[0], a[1]); }
PlanePoint left_of(const PlanePoint& a) { return {-a[1], a[0]}; }
PlanePoint scaled(const PlanePoint& a, double factor) { return {a[0] * factor, a[1] * factor}; }

/// A motion that meets another in the corner: a line, or an arc around a centre.
struct Element {
    PlanePoint start, end;
    PlanePoint centre{};
    int turn = 0;

    /// The direction of the motion at one of its points.
    PlanePoint direction(const PlanePoint& at) const {
        const PlanePoint way =
            turn == 0 ? sum(end, start, -1.0) : scaled(left_of(sum(at, centre, -1.0)), turn);
        return scaled(way, 1.0 / size(way));
    }
    /// The point of the element that is nearest to another.
    PlanePoint nearest(const PlanePoint& to) const {
        if (turn == 0) {
            const PlanePoint along = direction(start);
            return sum(start, along, dot(sum(to, start, -1.0), along));
        }
        const PlanePoint out = sum(to, centre, -1.0);
        return sum(centre, out, size(sum(start, centre, -1.0)) / size(out));
    }
    /// How far along the element a point is: 0 at its start, 1 at its end.
    double share(const PlanePoint& at) const {
        if (turn == 0) {
            const PlanePoint way = sum(end, start, -1.0);
            return dot(sum(at, start, -1.0), way) / dot(way, way);
        }
        const auto angle_to = [&](const PlanePoint& to) {
            const PlanePoint a = sum(start, centre, -1.0), b = sum(to, centre, -1.0);
            const double angle = turn * std::atan2(cross(a, b), dot(a, b));
            return angle < -fuzz ? angle + 2.0 * std::numbers::pi : angle;
        };
        const double whole = angle_to(end);
        return angle_to(at) / (whole < fuzz ? 2.0 * std::numbers::pi : whole);
    }
};

/// The line or circle at a distance to the left of an element; to the right when it is negative.
struct Offset {
    bool is_line;
    PlanePoint point; // of the line, or the centre
    PlanePoint along; // of the line
    double radius;
};

Offset offset_of(const Element& element, double distance) {
    if (element.turn == 0) {
        const PlanePoint along = element.direction(element.start);
        return {true, sum(element.start, left_of(along), distance), along, 0.0};
    }
    const double radius = size(sum(element.start, element.centre, -1.0));
    return {false, element.centre, {}, radius - element.turn * distance};
}

/// The common point of a line and a circle, or of two, that is nearest to the corner.
std::optional<PlanePoint> nearest_of(const PlanePoint& middle, const PlanePoint& along,
                                     double squared, const PlanePoint& corner) {
    if (squared < 0.0) return std::nullopt;
    const PlanePoint a = sum(middle, along, std::sqrt(squared));
    const PlanePoint b = sum(middle, along, -std::sqrt(squared));
    return size(sum(a, corner, -1.0)) <= size(sum(b, corner, -1.0)) ? a : b;
}

std::optional<PlanePoint> meeting_point(const Offset& a, const Offset& b,
                                        const PlanePoint& corner) {
    if (a.is_line && b.is_line) {
        const double sine = cross(a.along, b.along);
        if (std::abs(sine) < fuzz) return std::nullopt;
        return sum(a.point, a.along, cross(sum(b.point, a.point, -1.0), b.along) / sine);
    }
    if (!a.is_line && b.is_line) return meeting_point(b, a, corner);
    if (a.radius < 0.0 || b.radius < 0.0) return std::nullopt;
    const PlanePoint way = sum(b.point, a.point, -1.0);
    if (a.is_line) {
        const PlanePoint middle = sum(a.point, a.along, dot(way, a.along));
        const double away = size(sum(middle, b.point, -1.0));
        return nearest_of(middle, a.along, b.radius * b.radius - away * away, corner);
    }
    const double apart = size(way);
    if (apart < fuzz) return std::nullopt;
    const PlanePoint along = scaled(way, 1.0 / apart);
    const double to_middle =
        (apart * apart + a.radius * a.radius - b.radius * b.radius) / (2.0 * apart);
    return nearest_of(sum(a.point, along, to_middle), left_of(along),
                      a.radius * a.radius - to_middle * to_middle, corner);
}

/// Where the corner leaves the first element and reaches the second.
struct Cut {
    PlanePoint from, to, centre{};
    int turn = 0;
};

std::optional<Cut> rounding_of(const Element& first, const Element& second, double radius) {
    const PlanePoint in = first.direction(first.end), out = second.direction(second.start);
    const double sine = cross(in, out);
    if (std::abs(sine) < fuzz) return std::nullopt;
    const int turn = sine > 0.0 ? 1 : -1;
    const auto centre =
        meeting_point(offset_of(first, turn * radius), offset_of(second, turn * radius), first.end);
    if (!centre) return std::nullopt;
    return Cut{first.nearest(*centre), second.nearest(*centre), *centre, turn};
}

std::optional<Cut> chamfer_of(const Element& first, const Element& second, double length) {
    if (first.turn != 0 || second.turn != 0) return std::nullopt;
    return Cut{sum(first.end, first.direction(first.end), -length),
               sum(second.start, second.direction(second.start), length)};
}

/// The block behind this one, when it rounds or chamfers.
core::Result<std::optional<Block>> corner_behind(const Execution& execution) {
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

/// The size of the corner: a radius, or the length of the chamfer's legs.
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
            return core::fail(ErrorCode::invalid_value,
                              fmt::format("{:.12g}: the size of a corner is not negative", value),
                              word.span);
        return to_mm(value, execution.modal().unit);
    }
    return core::fail(ErrorCode::missing_value, "RND needs R and a radius, CHF a length",
                      block.command.span);
}

PlanePoint flat(const Position& place, const PlaneAxes& axes) {
    return {place[axes.first].value_or(0.0), place[axes.second].value_or(0.0)};
}

bool is_known(const Position& place, const PlaneAxes& axes) {
    return place[axes.first] && place[axes.second];
}

/// The motion behind the corner, found by running the program ahead on a copy of the state.
core::Result<std::optional<Element>> motion_ahead(Execution& execution, const Position& end,
                                                  const Element& before) {
    InterpreterState ahead = execution.state;
    ahead.modal.position = end;
    ahead.klartext.write().looks_ahead = true;
    ahead.klartext.write().corner.reset();
    if (before.turn != 0 || size(sum(before.end, before.start, -1.0)) > fuzz)
        ahead.klartext.write().direction = before.direction(before.end);
    Interpreter interpreter(execution.library, execution.environment);
    const PlaneAxes axes = axes_of(execution.modal().plane);
    for (int count = 0; count < most_blocks_ahead; ++count) {
        FEELER_TRY(const BlockResult* const found, interpreter.next(ahead));
        if (!found) break;
        for (const CanonicalCommand& command : found->commands) {
            const auto* arc = std::get_if<ArcFeed>(&command);
            const auto* straight = std::get_if<StraightFeed>(&command);
            if (!arc && !straight) continue;
            const Position& to = arc ? arc->end : straight->end;
            if (!is_known(to, axes) || to[axes.normal] != end[axes.normal])
                return std::optional<Element>{};
            Element element{.start = flat(end, axes), .end = flat(to, axes)};
            if (arc) {
                element.centre = {arc->centre[0], arc->centre[1]};
                element.turn = arc->turns > 0 ? 1 : -1;
            }
            return std::optional(element);
        }
    }
    return std::optional<Element>{};
}

core::Error refusal(const Block& corner, std::string_view why) {
    const bool rounds = corner.command.kind == CommandKind::rounding;
    return {ErrorCode::invalid_value, corner.command.span,
            fmt::format("{}: {}", rounds ? "RND" : "CHF", why)};
}

bool is_inside(double share) { return share > -fuzz && share < 1.0 + fuzz; }

/// Lays the corner between two motions, and remembers it.
core::Result<Position> lay_corner(Execution& execution, const Block& block, const Position& end,
                                  const Element& first, double corner_size) {
    FEELER_TRY(const auto second, motion_ahead(execution, end, first));
    if (!second)
        return tl::unexpected(refusal(block, "a motion with feed in the plane belongs behind it, "
                                             "at the same height"));
    const bool moves = size(sum(first.end, first.start, -1.0)) > fuzz || first.turn != 0;
    const bool goes_on = size(sum(second->end, second->start, -1.0)) > fuzz || second->turn != 0;
    if (!moves || !goes_on)
        return tl::unexpected(refusal(block, "the motion before or behind it has no length"));
    const bool rounds = block.command.kind == CommandKind::rounding;
    const auto cut =
        rounds ? rounding_of(first, *second, corner_size) : chamfer_of(first, *second, corner_size);
    const bool straight_on =
        cross(first.direction(first.end), second->direction(second->start)) < fuzz
        && cross(first.direction(first.end), second->direction(second->start)) > -fuzz;
    if (!cut && rounds && straight_on
        && dot(first.direction(first.end), second->direction(second->start)) > 0.0)
        return end; // no corner to round
    if (!cut)
        return tl::unexpected(refusal(block, rounds ? "there is no such rounding between the two "
                                                      "motions"
                                                    : "a chamfer lies between two straight lines"));
    if (!is_inside(first.share(cut->from)) || !is_inside(second->share(cut->to)))
        return tl::unexpected(refusal(block, "it is too large for the motions before and behind "
                                             "it"));
    const PlaneAxes axes = axes_of(execution.modal().plane);
    Position from = end, to = end;
    from[axes.first] = cut->from[0];
    from[axes.second] = cut->from[1];
    to[axes.first] = cut->to[0];
    to[axes.second] = cut->to[1];
    execution.state.klartext.write().corner = Corner{.point = end,
                                                     .end = to,
                                                     .centre = cut->centre,
                                                     .turn = cut->turn,
                                                     .direction = second->direction(cut->to)};
    return from;
}

} // namespace

core::Result<Position> end_before_corner(Execution& execution, const Position& end,
                                         const PlanePoint& centre, int turn) {
    if (execution.state.klartext->looks_ahead) return end;
    FEELER_TRY(const std::optional<Block> block, corner_behind(execution));
    if (!block) return end;
    FEELER_TRY(const double corner_size, size_of_corner(execution, *block));
    if (corner_size == 0.0) return end;
    const PlaneAxes axes = axes_of(execution.modal().plane);
    const Position& start = execution.modal().position;
    if (!is_known(start, axes) || !is_known(end, axes))
        return tl::unexpected(refusal(*block, "where the motion before it begins is not known"));
    if (start[axes.normal] != end[axes.normal])
        return tl::unexpected(refusal(*block, "the motion before it leaves its height"));
    return lay_corner(execution, *block, end, {flat(start, axes), flat(end, axes), centre, turn},
                      corner_size);
}

/// RND, CHF: what end_before_corner has laid.
core::Result<void> make_corner(Execution& execution) {
    const KlartextState& before = *execution.state.klartext;
    if (before.looks_ahead || !before.corner || before.corner->is_done) return {};
    const Corner corner = *before.corner;
    std::optional<double> feed = execution.modal().feed;
    if (const Word* word = execution.statement.word('F')) feed = length_of(execution, *word);
    if (!feed || *feed <= 0.0) return refuse_statement(execution, "no feed F came before it");
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
    KlartextState& klartext = execution.state.klartext.write();
    klartext.corner->is_done = true;
    // CT goes on in the direction of the motion that the rounding leads into.
    const double length = size(corner.direction);
    klartext.direction = scaled(corner.direction, 1.0 / length);
    return {};
}

} // namespace gcode
