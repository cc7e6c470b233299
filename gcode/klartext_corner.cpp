#include <fmt/format.h>

#include "gcode/corner_geometry.h"
#include "gcode/klartext.h"
#include "gcode/klartext_parser.h"

namespace gcode {
namespace {

using core::ErrorCode;

constexpr int most_blocks_ahead = 1000;

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

PlanePoint plane_point(FlatPoint point) { return {point.u, point.v}; }

FlatPoint flat(const Position& place, const PlaneAxes& axes) {
    return {place[axes.first].value_or(0.0), place[axes.second].value_or(0.0)};
}

bool is_known(const Position& place, const PlaneAxes& axes) {
    return place[axes.first] && place[axes.second];
}

/// The motion behind the corner, found by running the program ahead on a copy of the state.
core::Result<std::optional<CornerSide>> motion_ahead(Execution& execution, const Position& end,
                                                     const CornerSide& before) {
    InterpreterState ahead = execution.state;
    ahead.modal.position = end;
    ahead.klartext.write().looks_ahead = true;
    ahead.klartext.write().corner.reset();
    if (has_length(before))
        ahead.klartext.write().direction = plane_point(heading_at(before, before.end));
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
                return std::optional<CornerSide>{};
            CornerSide side{.start = flat(end, axes), .end = flat(to, axes)};
            if (arc) side.arc = FlatArc{{arc->centre[0], arc->centre[1]}, arc->turns};
            return std::optional(side);
        }
    }
    return std::optional<CornerSide>{};
}

core::Error refusal(const Block& corner, std::string_view why) {
    const bool rounds = corner.command.kind == CommandKind::rounding;
    return {ErrorCode::invalid_value, corner.command.span,
            fmt::format("{}: {}", rounds ? "RND" : "CHF", why)};
}

/// Why a corner cannot be laid; empty when it can, or need not be.
std::string_view fault_of(const CornerCut& cut, CornerKind kind) {
    switch (cut.fit) {
    case CornerFit::no_length:
        return "the motion before or behind it has no length";
    case CornerFit::none:
        return kind == CornerKind::rounding ? "there is no such rounding between the two motions"
                                            : "a chamfer lies between two straight lines";
    case CornerFit::too_large:
        return "it is too large for the motions before and behind it";
    default:
        return {};
    }
}

/// Lays the corner between two motions, and remembers it.
core::Result<Position> lay_corner(Execution& execution, const Block& block, const Position& end,
                                  const CornerSide& first, double corner_size) {
    FEELER_TRY(const auto second, motion_ahead(execution, end, first));
    if (!second)
        return tl::unexpected(refusal(block, "a motion with feed in the plane belongs behind it, "
                                             "at the same height"));
    const CornerKind kind =
        block.command.kind == CommandKind::rounding ? CornerKind::rounding : CornerKind::chamfer;
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
    execution.state.klartext.write().corner = corner;
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
    CornerSide before{.start = flat(start, axes), .end = flat(end, axes)};
    if (turn != 0) before.arc = FlatArc{{centre[0], centre[1]}, turn};
    return lay_corner(execution, *block, end, before, corner_size);
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
    klartext.direction = corner.direction;
    return {};
}

} // namespace gcode
