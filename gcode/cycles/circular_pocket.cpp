#include <fmt/format.h>

#include "gcode/exec/execution.h"
#include "gcode/exec/frame_codes.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// The evaluated words of G12 or G13: radii of the tool centre, mm.
struct CircularPocket {
    double first = 0.0, last = 0.0, step = 0.0;
    int turn = 1;
    int loops = 1;
    double feed = 0.0;
};

tl::unexpected<core::Error> refusal(const Word& word, ErrorCode code, std::string_view why) {
    return core::fail(code, fmt::format("{}: {}", written(word), why), word.span);
}

core::Result<void> check_radii(const Execution& execution, const CodeWord& entry,
                               double tool_radius) {
    const Word* first = execution.statement.word('I');
    const Word* last = execution.statement.word('K');
    const Word* step = execution.statement.word('Q');
    if (!first) return refusal(*entry.word, ErrorCode::missing_value, "the radius I is missing");
    if (length_of(execution, *first) <= tool_radius)
        return refusal(
            *first, ErrorCode::invalid_value,
            fmt::format("the circle must be larger than the tool radius of {:g} mm", tool_radius));
    if (last && !step)
        return refusal(*last, ErrorCode::missing_value,
                       "K also needs Q, the step from circle to circle");
    if (step && !last)
        return refusal(*step, ErrorCode::missing_value,
                       "Q also needs K, the radius of the last circle");
    if (step && step->value <= 0.0)
        return refusal(*step, ErrorCode::invalid_value, "the step must be greater than 0");
    if (last && last->value <= first->value)
        return refusal(*last, ErrorCode::invalid_value, "K must be greater than I");
    return {};
}

core::Result<CircularPocket> pocket_of(Execution& execution, const CodeWord& entry) {
    FEELER_TRY(const double diameter, offset_diameter(execution, entry));
    const double tool_radius = diameter / 2.0;
    if (auto checked = check_radii(execution, entry, tool_radius); !checked)
        return tl::unexpected(std::move(checked).error());
    const Statement& statement = execution.statement;
    CircularPocket pocket{.turn = entry.code->number == g_code(12) ? -1 : 1};
    pocket.first = pocket.last = length_of(execution, *statement.word('I')) - tool_radius;
    if (const Word* last = statement.word('K')) {
        pocket.last = length_of(execution, *last) - tool_radius;
        pocket.step = length_of(execution, *statement.word('Q'));
    }
    if (const Word* loops = statement.word('L')) {
        FEELER_TRY(pocket.loops, whole_number(*loops, 1, 10000));
    }
    FEELER_TRY(pocket.feed, feed_rate(execution, std::nullopt));
    return pocket;
}

void add_arc(Execution& execution, const CircularPocket& pocket, double centre_x, double end_x,
             double y) {
    Position end = execution.modal().position;
    end[0] = end_x;
    execution.modal().position = end;
    execution.emit(ArcFeed{end, Plane::xy, {centre_x, y}, pocket.turn, pocket.feed});
}

/// Spiral of half circles: out, a full circle, out to the next circle, and finally back.
void mill_circles(Execution& execution, const CircularPocket& pocket) {
    const double x = *execution.modal().position[0], y = *execution.modal().position[1];
    double side = 1.0, before = 0.0;
    for (double radius = pocket.first;;) {
        add_arc(execution, pocket, x + 0.5 * side * (radius - before), x + side * radius, y);
        add_arc(execution, pocket, x, x + side * radius, y);
        if (radius >= pocket.last) break;
        before = radius;
        radius = std::min(radius + pocket.step, pocket.last);
        side = -side;
    }
    const double reached = side * pocket.last;
    add_arc(execution, pocket, x + 0.5 * reached, x, y);
}

/// The control takes X, Y and Z only.
core::Result<void> check_axes(const Execution& execution, const CodeWord& entry) {
    for (size_t axis = 3; axis < axis_count; ++axis)
        if (const Word* word = execution.statement.word(axis_letters[axis]))
            return refusal(*word, ErrorCode::syntax,
                           fmt::format("{} moves X, Y and Z only: move {} in an earlier block",
                                       written(*entry.word), word->letter));
    return {};
}

core::Result<void> check_place(const Execution& execution, const CodeWord& entry) {
    const Position& place = execution.modal().position;
    if (execution.modal().plane != Plane::xy)
        return refusal(*entry.word, ErrorCode::syntax,
                       "circular pockets work in the G17 plane only");
    if (place[0] && place[1]) return {};
    return refusal(*entry.word, ErrorCode::missing_value,
                   "the centre of the circle is unknown: move there first, or add X and Y");
}

} // namespace

core::Result<void> mill_circular_pocket(Execution& execution) {
    const CodeWord& entry = *execution.statement.of(ModalGroup::action);
    if (auto checked = check_arc_in_frame(execution, axes_of(Plane::xy)); !checked) return checked;
    if (auto checked = check_axes(execution, entry); !checked) return checked;
    FEELER_TRY(const CircularPocket pocket, pocket_of(execution, entry));
    FEELER_TRY(const Position target, target_of(execution));
    Position middle = execution.modal().position;
    middle[0] = target[0];
    middle[1] = target[1];
    if (middle != execution.modal().position) {
        if (execution.modal().motion == MotionCode::rapid)
            execution.traverse(middle);
        else
            execution.feed(middle, pocket.feed);
    }
    if (auto checked = check_place(execution, entry); !checked) return checked;
    execution.result.is_cycle = true;
    std::optional<double> depth = target[2];
    const auto& height = execution.modal().position[2];
    const double deeper = depth && height ? *depth - *height : 0.0;
    const bool deepens = execution.modal().distance == DistanceMode::incremental;
    for (int loop = 0; loop < pocket.loops; ++loop) {
        if (execution.statement.word('Z')) {
            Position down = execution.modal().position;
            down[2] = loop > 0 && deepens && down[2] ? std::optional(*down[2] + deeper) : depth;
            execution.feed(down, pocket.feed);
        }
        mill_circles(execution, pocket);
    }
    return {};
}

} // namespace gcode
