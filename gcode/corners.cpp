#include "gcode/corners.h"

#include <numbers>

#include <fmt/format.h>

#include "core/base/units.h"
#include "gcode/canonical.h"
#include "gcode/execution.h"
#include "gcode/frame_codes.h"

namespace gcode {
namespace {

using core::ErrorCode;

constexpr size_t most_waiting = 1000;

const Position* end_of_feed(const CanonicalCommand& command) {
    if (const auto* move = std::get_if<StraightFeed>(&command)) return &move->end;
    if (const auto* move = std::get_if<ArcFeed>(&command)) return &move->end;
    return nullptr;
}

core::Error refusal(const CornerWord& word, ErrorCode code, std::string_view why) {
    return {code, word.where, fmt::format("{}: {}", word.written, why)};
}

core::Error no_motion(const CornerWord& word, std::string_view what) {
    return refusal(word, ErrorCode::missing_value,
                   fmt::format("the next block must be a G1, G2 or G3 in the plane, and {}; the "
                               "control stops with an alarm (PS0051 on Fanuc)",
                               what));
}

/// A feed as the plane sees it; empty where it does not stay in the plane.
std::optional<CornerSide> side_of(const CanonicalCommand& command, const Position& start,
                                  Plane plane) {
    const PlaneAxes axes = axes_of(plane);
    const Position& end = *end_of_feed(command);
    for (size_t axis = 0; axis < axis_count; ++axis) {
        const bool in_plane = axis == axes.first || axis == axes.second;
        if (in_plane ? !start[axis] || !end[axis] : start[axis] != end[axis]) return std::nullopt;
    }
    CornerSide side{.start = {*start[axes.first], *start[axes.second]},
                    .end = {*end[axes.first], *end[axes.second]}};
    if (const auto* arc = std::get_if<ArcFeed>(&command)) {
        if (arc->plane != plane) return std::nullopt;
        side.arc = FlatArc{{arc->centre[0], arc->centre[1]}, arc->turns};
    }
    return side;
}

Position moved_in_plane(Position place, Plane plane, FlatPoint to) {
    const PlaneAxes axes = axes_of(plane);
    place[axes.first] = to.u;
    place[axes.second] = to.v;
    return place;
}

/// The motion of a block that stands behind a corner; empty where the corner goes on waiting.
core::Result<std::optional<CornerSide>> motion_behind(const Corners& corners,
                                                      const ExecutedBlock& block) {
    const CornerWord& word = *corners.word;
    const ModalState& first = corners.waiting.front().after;
    for (const CanonicalCommand& command : block.result.commands) {
        if (std::holds_alternative<Dwell>(command) || std::holds_alternative<Message>(command))
            continue;
        if (!is_motion(command))
            return tl::unexpected(
                no_motion(word, std::holds_alternative<ProgramEnd>(command)
                                    ? "the program ends"
                                    : "only a dwell may stand between the two motions"));
        if (!end_of_feed(command))
            return tl::unexpected(no_motion(word, "a motion without feed follows"));
        const bool same_modes = block.after.plane == first.plane
                                && block.after.compensation == first.compensation
                                && block.after.offsets == first.offsets;
        if (!same_modes)
            return tl::unexpected(no_motion(
                word, "the plane, the offsets or cutter radius compensation change before it"));
        const auto side = side_of(command, block.before.position, first.plane);
        if (!side || !has_length(*side))
            return tl::unexpected(no_motion(word, "the motion behind it leaves the plane"));
        return side;
    }
    return std::optional<CornerSide>{};
}

core::Result<CornerCut> cut_between(const CornerWord& word, const CornerSide& first,
                                    const CornerSide& second) {
    CornerCut cut;
    cut.fit = CornerFit::straight_on;
    if (!has_length(first))
        return tl::unexpected(refusal(word, ErrorCode::invalid_value,
                                      "the motion it is written behind goes nowhere"));
    if (bend_between(first, second) <= core::radians_per_degree) return cut;
    cut = cut_corner(first, second, word.kind, word.size);
    if (cut.fit == CornerFit::none)
        return tl::unexpected(
            refusal(word, ErrorCode::invalid_value,
                    "nothing of this size touches both motions; the control stops with an alarm"));
    if (cut.fit == CornerFit::too_large)
        return tl::unexpected(
            refusal(word, ErrorCode::invalid_value,
                    "the corner is too large for the motions before and behind it; the control "
                    "stops with an alarm (PS0055 on Fanuc)"));
    return cut;
}

/// Lets the block end in the corner.
void add_corner(ExecutedBlock& block, const CornerWord& word, const CornerCut& cut) {
    std::vector<CanonicalCommand>& commands = block.result.commands;
    const Plane plane = block.after.plane;
    CanonicalCommand& motion = commands.back();
    const Position corner = *end_of_feed(motion);
    const double feed = std::visit(
        [](const auto& command) {
            if constexpr (requires { command.feed; })
                return command.feed;
            else
                return 0.0;
        },
        motion);
    const Position from = moved_in_plane(corner, plane, cut.from);
    const Position to = moved_in_plane(corner, plane, cut.to);
    if (auto* arc = std::get_if<ArcFeed>(&motion)) arc->end = from;
    if (auto* line = std::get_if<StraightFeed>(&motion)) line->end = from;
    // An arc that ends where it begins would be a whole turn.
    if (cut.takes_first) {
        commands.pop_back();
        block.result.columns.pop_back();
    }
    if (cut.arc)
        commands.push_back(
            ArcFeed{to, plane, {cut.arc->centre.u, cut.arc->centre.v}, cut.arc->turns, feed});
    else
        commands.push_back(StraightFeed{to, feed});
    block.result.columns.push_back(word.where.column);
}

/// Makes the first motion of the block begin where the corner ends.
void begin_behind_corner(ExecutedBlock& block, const CornerCut& cut) {
    block.before.position = moved_in_plane(block.before.position, block.after.plane, cut.to);
    if (!cut.takes_second) return;
    for (CanonicalCommand& command : block.result.commands)
        if (const auto* arc = std::get_if<ArcFeed>(&command)) {
            command = StraightFeed{arc->end, arc->feed};
            return;
        }
}

/// Lets a block wait for the motion behind its corner.
core::Result<void> wait_for_motion(Corners& corners, const CornerWord& word, ExecutedBlock block) {
    Position start = block.before.position;
    const std::vector<CanonicalCommand>& commands = block.result.commands;
    for (size_t i = 0; i + 1 < commands.size(); ++i)
        if (const Position* end = end_of_feed(commands[i])) start = *end;
    const auto side = side_of(commands.back(), start, block.after.plane);
    if (!side)
        return tl::unexpected(refusal(word, ErrorCode::invalid_value,
                                      "a corner lies in the plane, and the motion before it "
                                      "leaves the plane or begins at an unknown place"));
    corners.first = *side;
    corners.word = word;
    corners.waiting.push_back(std::move(block));
    return {};
}

core::Result<std::vector<ExecutedBlock>> take(Corners& corners, ExecutedBlock block) {
    const std::optional<CornerWord> asked = std::exchange(corners.asked, std::nullopt);
    std::vector<ExecutedBlock> ready;
    if (corners.word) {
        FEELER_TRY(const auto second, motion_behind(corners, block));
        if (!second) {
            if (corners.waiting.size() >= most_waiting)
                return tl::unexpected(no_motion(*corners.word, "none comes for too long"));
            corners.waiting.push_back(std::move(block));
            return ready;
        }
        FEELER_TRY(const CornerCut cut, cut_between(*corners.word, corners.first, *second));
        if (cut.fit == CornerFit::fits) {
            add_corner(corners.waiting.front(), *corners.word, cut);
            begin_behind_corner(block, cut);
        }
        ready = give_up_corners(corners);
    }
    if (asked) {
        if (auto waits = wait_for_motion(corners, *asked, std::move(block)); !waits)
            return tl::unexpected(waits.error());
    } else {
        ready.push_back(std::move(block));
    }
    return ready;
}

} // namespace

bool Corners::operator==(const Corners& other) const {
    return asked.has_value() == other.asked.has_value()
           && word.has_value() == other.word.has_value() && first == other.first
           && waiting.size() == other.waiting.size();
}

core::Result<std::vector<ExecutedBlock>> take_for_corners(Corners& corners, ExecutedBlock block) {
    auto ready = take(corners, std::move(block));
    if (!ready) (void)give_up_corners(corners);
    return ready;
}

core::Result<void> end_corners(Corners& corners) {
    if (!corners.word) return {};
    const core::Error error = no_motion(*corners.word, "the program ends");
    (void)give_up_corners(corners);
    return tl::unexpected(error);
}

std::vector<ExecutedBlock> give_up_corners(Corners& corners) {
    std::vector<ExecutedBlock> blocks = std::move(corners.waiting);
    corners.waiting.clear();
    corners.word.reset();
    corners.asked.reset();
    return blocks;
}

core::Result<void> ask_for_corner(Execution& execution) {
    const Word* word = execution.statement.corner;
    if (!word) return {};
    const double size = length_of(execution, *word);
    if (size < 0.0)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: the size of a corner is not negative", written(*word)),
                          word->span);
    const auto& commands = execution.result.commands;
    const bool feeds =
        !commands.empty() && end_of_feed(commands.back()) != nullptr && !execution.modal().cycle;
    if (!feeds)
        return core::fail(
            ErrorCode::syntax,
            fmt::format("{}: a corner is written in the block of a G1, G2 or G3", written(*word)),
            word->span);
    if (size == 0.0) return {};
    const PlaneAxes axes = axes_of(execution.modal().plane);
    if (auto checked = check_arc_in_frame(execution, axes); !checked) return checked;
    execution.state.contour.corners.asked =
        CornerWord{.kind = word->letter == 'r' ? CornerKind::rounding : CornerKind::chamfer,
                   .size = size,
                   .where = word->span,
                   .written = written(*word)};
    return {};
}

} // namespace gcode
