#include "gcode/contour/contour.h"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include "core/base/rule_table.h"
#include "core/base/units.h"
#include "gcode/language/canonical.h"

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
                   fmt::format("the next motion must be a G1, G2 or G3 in the plane, but {}; the "
                               "control stops with an alarm (PS0051 on Fanuc)",
                               what));
}

/// The geometry of a feed move in the plane; empty when it leaves the plane.
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

Position moved_in_plane(Position position, Plane plane, FlatPoint to) {
    const PlaneAxes axes = axes_of(plane);
    position[axes.first] = to.u;
    position[axes.second] = to.v;
    return position;
}

/// The motion of a block that follows a corner; empty when the block has none and the corner must
/// wait for a later one.
core::Result<std::optional<CornerSide>> motion_after(const Corners& corners,
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
                                    : "only a dwell is allowed between the two motions"));
        if (!end_of_feed(command)) return tl::unexpected(no_motion(word, "a rapid follows"));
        const bool same_modes = block.after.plane == first.plane
                                && block.after.compensation == first.compensation
                                && block.after.offsets == first.offsets;
        if (!same_modes)
            return tl::unexpected(no_motion(
                word, "the plane, the offsets or the cutter radius compensation change first"));
        const auto side = side_of(command, block.before.position, first.plane);
        if (!side || !has_length(*side))
            return tl::unexpected(no_motion(word, "the next motion leaves the plane"));
        return side;
    }
    return std::optional<CornerSide>{};
}

core::Result<CornerCut> cut_between(const CornerWord& word, const CornerSide& first,
                                    const CornerSide& second) {
    CornerCut cut;
    cut.fit = CornerFit::straight_on;
    if (!has_length(first))
        return tl::unexpected(
            refusal(word, ErrorCode::invalid_value, "the motion in this block has no length"));
    if (bend_between(first, second) <= core::radians_per_degree) return cut;
    cut = cut_corner(first, second, word.kind, word.size);
    if (cut.fit == CornerFit::none)
        return tl::unexpected(refusal(
            word, ErrorCode::invalid_value,
            "no corner of this size touches both motions; the control stops with an alarm"));
    if (cut.fit == CornerFit::too_large)
        return tl::unexpected(refusal(word, ErrorCode::invalid_value,
                                      "the corner is too large for the motions before and after "
                                      "it; the control stops with an alarm (PS0055 on Fanuc)"));
    return cut;
}

/// Adds the corner at the end of the block.
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
    // The first motion vanishes. As an arc it would end where it starts, which means a full circle.
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

/// Moves the start of the block's first motion to the end of the corner.
void begin_after_corner(ExecutedBlock& block, const CornerCut& cut) {
    block.before.position = moved_in_plane(block.before.position, block.after.plane, cut.to);
    if (!cut.takes_second) return;
    for (CanonicalCommand& command : block.result.commands)
        if (const auto* arc = std::get_if<ArcFeed>(&command)) {
            command = StraightFeed{arc->end, arc->feed};
            return;
        }
}

/// Holds back a block until the motion after its corner is known.
core::Result<void> wait_for_motion(Corners& corners, const CornerWord& word, ExecutedBlock block) {
    Position start = block.before.position;
    const std::vector<CanonicalCommand>& commands = block.result.commands;
    for (size_t i = 0; i + 1 < commands.size(); ++i)
        if (const Position* end = end_of_feed(commands[i])) start = *end;
    const auto side = side_of(commands.back(), start, block.after.plane);
    if (!side)
        return tl::unexpected(refusal(
            word, ErrorCode::invalid_value,
            "a corner needs a motion that stays in the plane and starts at a known position"));
    corners.first = *side;
    corners.word = word;
    corners.waiting.push_back(std::move(block));
    return {};
}

} // namespace

core::Result<void> add_to_corners(Corners& corners, ExecutedBlock block,
                                  std::vector<ExecutedBlock>& ready) {
    const std::optional<CornerWord> asked = std::exchange(corners.asked, std::nullopt);
    if (corners.word) {
        FEELER_TRY(const auto second, motion_after(corners, block));
        if (!second) {
            if (corners.waiting.size() >= most_waiting)
                return tl::unexpected(
                    no_motion(*corners.word, "too many blocks without a motion follow"));
            corners.waiting.push_back(std::move(block));
            return {};
        }
        FEELER_TRY(const CornerCut cut, cut_between(*corners.word, corners.first, *second));
        if (cut.fit == CornerFit::fits) {
            add_corner(corners.waiting.front(), *corners.word, cut);
            begin_after_corner(block, cut);
        }
        ready = give_up_corners(corners);
    }
    if (asked) return wait_for_motion(corners, *asked, std::move(block));
    ready.push_back(std::move(block));
    return {};
}

core::Result<void> end_corners(const Corners& corners) {
    if (!corners.word) return {};
    return tl::unexpected(no_motion(*corners.word, "the program ends"));
}

std::vector<ExecutedBlock> give_up_corners(Corners& corners) {
    std::vector<ExecutedBlock> blocks = std::move(corners.waiting);
    corners.waiting.clear();
    corners.word.reset();
    corners.asked.reset();
    return blocks;
}

namespace {

constexpr size_t most_pending = 100000;

/// The end of a motion; null for other commands.
const Position* end_of(const CanonicalCommand& command) {
    if (const auto* move = std::get_if<StraightTraverse>(&command)) return &move->end;
    if (const auto* move = std::get_if<StraightFeed>(&command)) return &move->end;
    if (const auto* move = std::get_if<ArcFeed>(&command)) return &move->end;
    return nullptr;
}

std::optional<FlatPoint> flat(const Position& position, Plane plane) {
    const PlaneAxes axes = axes_of(plane);
    if (!position[axes.first] || !position[axes.second]) return std::nullopt;
    return FlatPoint{*position[axes.first], *position[axes.second]};
}

double feed_of(const CanonicalCommand& command) {
    if (const auto* move = std::get_if<StraightFeed>(&command)) return move->feed;
    if (const auto* move = std::get_if<ArcFeed>(&command)) return move->feed;
    return 0.0;
}

/// Converts a move of the tool centre to a command for the controlled point, which is `tip` away
/// from it. Axes outside the plane do not move while the tool rounds a corner.
CanonicalCommand command_of(const CompensatedMove& move, const CanonicalCommand& programmed,
                            const Position& start, Plane plane, FlatPoint tip) {
    const Position end =
        moved_in_plane(move.rounds_corner ? start : *end_of(programmed), plane, move.end + tip);
    if (move.rapid) return StraightTraverse{end};
    if (!move.arc) return StraightFeed{end, feed_of(programmed)};
    const FlatPoint centre = move.arc->centre + tip;
    return ArcFeed{end, plane, {centre.u, centre.v}, move.arc->turns, feed_of(programmed)};
}

/// A move's id encodes the block, counted from the start of the run, and the index of the command
/// in it.
constexpr size_t commands_of_a_block = size_t(1) << 20;

void place_move(Contour& contour, const CompensatedMove& move) {
    PendingBlock& block = contour.pending[move.id / commands_of_a_block - contour.first_pending];
    const size_t index = move.id % commands_of_a_block;
    PendingBlock::Slot& slot = block.slots[index];
    const FlatPoint tip = contour.path->entered ? contour.tip : FlatPoint{};
    slot.moves.push_back(
        command_of(move, block.result.commands[index], slot.start, contour.plane, tip));
    if (!move.rounds_corner) slot.is_waiting = false;
    if (move.is_in_doubt) {
        block.result.path = std::max(block.result.path, core::PathCertainty::doubtful);
        block.result.warnings.push_back(
            {Severity::warning,
             {.line = block.result.line, .column = block.result.columns[index]},
             "how the control passes the outside corner at the start of this move is not known in "
             "detail; the move is not proven clear",
             core::rule_id("undecided"),
             "Round the corner in the program, or pass it with G450 in a feed."});
    }
    if (move.turned_round)
        block.result.warnings.push_back(
            {Severity::warning,
             {.line = block.result.line, .column = block.result.columns[index]},
             "the tool does not fit between this move and the previous one: its centre moves "
             "backwards here and cuts into the contour"});
}

/// Moves leading blocks without waiting motions to the ready ones.
void release(Contour& contour) {
    while (!contour.pending.empty()) {
        PendingBlock& block = contour.pending.front();
        const auto waits = [](const PendingBlock::Slot& slot) { return slot.is_waiting; };
        if (std::any_of(block.slots.begin(), block.slots.end(), waits)) return;
        BlockCommands result = std::move(block.result);
        std::vector<CanonicalCommand> commands;
        std::vector<uint32_t> columns;
        for (size_t i = 0; i < block.slots.size(); ++i) {
            if (block.slots[i].moves.empty()) block.slots[i].moves.push_back(result.commands[i]);
            for (CanonicalCommand& command : block.slots[i].moves) {
                commands.push_back(std::move(command));
                columns.push_back(result.columns[i]);
            }
        }
        result.commands = std::move(commands);
        result.columns = std::move(columns);
        contour.ready.push_back(std::move(result));
        contour.pending.pop_front();
        ++contour.first_pending;
    }
}

/// Ends the compensation and returns its last moves that belong to the exit, if there is one.
core::Result<CompensatedMoves> end_path(Contour& contour, const ContourMove* exit = nullptr) {
    CompensatedMoves around;
    if (!contour.path) return around;
    FEELER_TRY(const CompensatedMoves moves, end_compensation(*contour.path, exit));
    for (const CompensatedMove& move : moves)
        if (exit && move.id == exit->id)
            around.push_back(move);
        else
            place_move(contour, move);
    contour.path.reset();
    return around;
}

/// The first motion of the block with G40, if it is straight.
std::optional<ContourMove> exit_of(const Contour& contour, const BlockCommands& block) {
    for (size_t i = 0; i < block.commands.size(); ++i) {
        const Position* end = end_of(block.commands[i]);
        if (!end) continue;
        const auto to = flat(*end, contour.plane);
        if (!to || std::holds_alternative<ArcFeed>(block.commands[i])) return std::nullopt;
        const size_t number = contour.first_pending + contour.pending.size();
        return ContourMove{.id = number * commands_of_a_block + i,
                           .rapid = std::holds_alternative<StraightTraverse>(block.commands[i]),
                           .end = *to,
                           .where = {.line = block.line, .column = block.columns[i]}};
    }
    return std::nullopt;
}

bool stops_reading(const CanonicalCommand& command) {
    return std::holds_alternative<ProgramStop>(command)
           || std::holds_alternative<OptionalStop>(command)
           || std::holds_alternative<WaitForInput>(command);
}

/// Why the control did not know the move of the last pending block when it ended the waiting one;
/// empty if it did. It reads a few blocks ahead, and none past a stop.
///
/// Source: Fanuc B-63944EN-2, 6.6, blocks without tool movement; B-63950EN, parameter 19625: with
///         3 blocks, one of them may have no move in the plane.
std::string reason_to_stop(const Contour& contour, size_t number) {
    const RadiusCompensation& path = *contour.path;
    if (!path.extends_corners || path.waiting.empty()) return {};
    const size_t before = path.waiting.front().id / commands_of_a_block;
    for (size_t at = before; at < number; ++at) {
        const auto& commands = contour.pending[at - contour.first_pending].result.commands;
        if (std::any_of(commands.begin(), commands.end(), stops_reading))
            return "the control does not read past the stop before this block";
    }
    const size_t without_move = number - before - 1;
    if (without_move + 2 <= contour.look_ahead) return {};
    return fmt::format(
        "{} blocks without a move in the plane come before this one, and the control "
        "reads {} blocks ahead",
        without_move, contour.look_ahead);
}

/// At a corner that the control does not know in time, it ends the move before at right angles to
/// its end. Inside corners are then cut into, and outside ones passed in another way: what is
/// executed from there to the end of the last pending block is not clear.
void doubt_corner(Contour& contour, size_t before, const std::string& reason,
                  core::SourceSpan where) {
    for (size_t at = before - contour.first_pending; at < contour.pending.size(); ++at) {
        core::PathCertainty& path = contour.pending[at].result.path;
        path = std::max(path, core::PathCertainty::doubtful);
    }
    contour.pending.back().result.warnings.push_back(
        {Severity::warning, where,
         fmt::format(
             "{}: where the corner of the compensated contour leads is not known; an inside "
             "corner is cut into",
             reason),
         core::rule_id("undecided"),
         "Move the blocks between the two moves to another place, or state \"19625\" under "
         "[control] in the set-up."});
}

/// Whether the waiting move ends elsewhere than at right angles to its programmed end.
bool has_corner(const CompensatedMoves& done, size_t waiting, FlatPoint upright) {
    constexpr double slack = 1e-6; // mm
    return std::any_of(done.begin(), done.end(), [&](const CompensatedMove& move) {
        return move.id != waiting || length(move.end - upright) > slack;
    });
}

/// Adds one motion of the last pending block to the contour.
core::Result<void> take_motion(Contour& contour, size_t index) {
    PendingBlock& block = contour.pending.back();
    const CanonicalCommand& command = block.result.commands[index];
    const core::SourceSpan where{
        .line = block.result.line, .column = block.result.columns[index], .length = 1};
    const auto end = flat(*end_of(command), contour.plane);
    if (!end)
        return core::fail(core::ErrorCode::missing_value,
                          "cutter radius compensation needs a known position in its plane", where);
    const size_t number = contour.first_pending + contour.pending.size() - 1;
    ContourMove move{.id = number * commands_of_a_block + index,
                     .rapid = std::holds_alternative<StraightTraverse>(command),
                     .end = *end,
                     .where = where};
    if (const auto* arc = std::get_if<ArcFeed>(&command))
        move.arc = FlatArc{{arc->centre[0], arc->centre[1]}, arc->turns};
    const bool stays = !move.arc && move.end == contour.path->programmed;
    const std::string reason = stays ? std::string() : reason_to_stop(contour, number);
    const size_t waiting = reason.empty() ? 0 : contour.path->waiting.front().id;
    const FlatPoint upright = contour.path->tool;
    FEELER_TRY(const CompensatedMoves moves, add_move(*contour.path, move));
    if (!reason.empty() && has_corner(moves, waiting, upright))
        doubt_corner(contour, waiting / commands_of_a_block, reason, where);
    block.slots[index].is_waiting = true;
    for (const CompensatedMove& done : moves) place_move(contour, done);
    return {};
}

/// The controlled point of a turning tool relative to the centre of its nose, for a nose radius of
/// 1. It is the intersection of the lines along X and Z that touch the nose on the side to which
/// the tool points.
FlatPoint tip_of(int orientation, Plane plane) {
    constexpr int along_x[] = {0, -1, -1, 1, 1, 0, -1, 0, 1, 0};
    constexpr int along_z[] = {0, 1, -1, -1, 1, 1, 0, -1, 0, 0};
    if (plane != Plane::zx) return {};
    const double x = along_x[orientation], z = along_z[orientation];
    return axes_of(plane).first == 0 ? FlatPoint{x, z} : FlatPoint{z, x};
}

core::Result<void> begin_path(Contour& contour, const ModalState& before, const ModalState& after,
                              const BlockCommands& block) {
    contour.plane = after.plane;
    const auto at = flat(before.position, after.plane);
    if (!at)
        return core::fail(core::ErrorCode::missing_value,
                          "cutter radius compensation starts at an unknown position: move in both "
                          "axes of the plane first, or set [program] start in the set-up",
                          {.line = block.line, .column = 1});
    const ContourSide side =
        after.compensation == Side::left ? ContourSide::left : ContourSide::right;
    contour.path = begin_compensation(side, after.compensation_radius, *at);
    contour.path->extends_corners = contour.style == ContourStyle::fanuc;
    contour.path->extends_ends = contour.extends_ends;
    contour.path->enters_upright = contour.enters_upright;
    contour.path->outside = contour.outside;
    contour.tip = contour.path->radius * tip_of(after.turning_orientation, after.plane);
    return {};
}

/// Takes the commands of a block. `around` are the moves that come before its exit.
core::Result<void> take_commands(Contour& contour, const BlockCommands& block,
                                 const ModalState& before, const CompensatedMoves& around) {
    contour.pending.push_back({block, std::vector<PendingBlock::Slot>(block.commands.size())});
    Position position = before.position;
    for (size_t i = 0; i < block.commands.size(); ++i) {
        PendingBlock::Slot& slot = contour.pending.back().slots[i];
        slot.start = position;
        if (std::holds_alternative<ProgramEnd>(block.commands[i]))
            if (auto ended = end_path(contour); !ended) return tl::unexpected(ended.error());
        for (const CompensatedMove& move : around)
            if (move.id % commands_of_a_block == i)
                slot.moves.push_back(
                    command_of(move, block.commands[i], position, contour.plane, contour.tip));
        if (!slot.moves.empty()) slot.moves.push_back(block.commands[i]);
        const Position* end = end_of(block.commands[i]);
        if (!end) continue;
        if (contour.path)
            if (auto taken = take_motion(contour, i); !taken) return taken;
        position = *end;
    }
    return {};
}

core::Result<void> take_with_corners(Contour& contour, const BlockCommands& block,
                                     const ModalState& before, const ModalState& after) {
    const bool on = after.compensation != Side::none && after.compensation_radius != 0.0;
    const bool changed = before.compensation != after.compensation
                         || before.compensation_radius != after.compensation_radius;
    const bool pauses = std::exchange(contour.pauses, false);
    CompensatedMoves around;
    if (contour.path && (!on || changed || pauses)) {
        const auto exit = on || pauses ? std::nullopt : exit_of(contour, block);
        FEELER_TRY(around, end_path(contour, exit ? &*exit : nullptr));
    }
    if (on && !contour.path && !pauses)
        if (auto begun = begin_path(contour, before, after, block); !begun) return begun;
    if (contour.pending.size() >= most_pending)
        return core::fail(core::ErrorCode::invalid_value,
                          "too many blocks without a move in the plane while cutter radius "
                          "compensation is on: cancel it with G40",
                          {.line = block.line, .column = 1});
    if (auto taken = take_commands(contour, block, before, around); !taken) {
        contour.pending.pop_back();
        return taken;
    }
    release(contour);
    return {};
}

core::Result<void> take_all(Contour& contour, const std::vector<ExecutedBlock>& blocks) {
    for (const ExecutedBlock& block : blocks)
        if (auto taken = take_with_corners(contour, block.result, block.before, block.after);
            !taken)
            return taken;
    return {};
}

} // namespace

core::Result<void> take_block(Contour& contour, const BlockCommands& block,
                              const ModalState& before, const ModalState& after) {
    if (contour.corners.is_idle()) return take_with_corners(contour, block, before, after);
    std::vector<ExecutedBlock> ready;
    const auto added = add_to_corners(contour.corners, {block, before, after}, ready);
    if (auto taken = take_all(contour, ready); !taken) return taken;
    return added;
}

core::Result<void> end_contour(Contour& contour) {
    auto ended = end_corners(contour.corners);
    give_up(contour);
    return ended;
}

void give_up(Contour& contour) {
    (void)take_all(contour, give_up_corners(contour.corners));
    if (contour.path) {
        for (const CompensatedMove& move : contour.path->waiting) place_move(contour, move);
        contour.path.reset();
    }
    release(contour);
}

} // namespace gcode
