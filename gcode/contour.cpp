#include "gcode/contour.h"

#include <algorithm>

#include <fmt/format.h>

namespace gcode {
namespace {

constexpr size_t most_pending = 100000;

/// The end of a motion; null for anything else.
const Position* end_of(const CanonicalCommand& command) {
    if (const auto* move = std::get_if<StraightTraverse>(&command)) return &move->end;
    if (const auto* move = std::get_if<StraightFeed>(&command)) return &move->end;
    if (const auto* move = std::get_if<ArcFeed>(&command)) return &move->end;
    return nullptr;
}

std::optional<FlatPoint> flat(const Position& place, Plane plane) {
    const PlaneAxes axes = axes_of(plane);
    if (!place[axes.first] || !place[axes.second]) return std::nullopt;
    return FlatPoint{*place[axes.first], *place[axes.second]};
}

Position moved(Position place, Plane plane, FlatPoint to) {
    const PlaneAxes axes = axes_of(plane);
    place[axes.first] = to.u;
    place[axes.second] = to.v;
    return place;
}

double feed_of(const CanonicalCommand& command) {
    if (const auto* move = std::get_if<StraightFeed>(&command)) return move->feed;
    if (const auto* move = std::get_if<ArcFeed>(&command)) return move->feed;
    return 0.0;
}

/// A move of the tool's centre as a command of the point that is controlled, which is `tip` away.
/// Round a corner the other axes stand still.
CanonicalCommand command_of(const CompensatedMove& move, const CanonicalCommand& programmed,
                            const Position& start, Plane plane, FlatPoint tip) {
    const Position end =
        moved(move.rounds_corner ? start : *end_of(programmed), plane, move.end + tip);
    if (move.rapid) return StraightTraverse{end};
    if (!move.arc) return StraightFeed{end, feed_of(programmed)};
    const FlatPoint centre = move.arc->centre + tip;
    return ArcFeed{end, plane, {centre.u, centre.v}, move.arc->turns, feed_of(programmed)};
}

/// Identifies a command by its block, counted from the start of the run, and its place there.
constexpr size_t commands_of_a_block = size_t(1) << 20;

void place_move(Contour& contour, const CompensatedMove& move) {
    PendingBlock& block = contour.pending[move.id / commands_of_a_block - contour.first_pending];
    const size_t index = move.id % commands_of_a_block;
    PendingBlock::Slot& slot = block.slots[index];
    const FlatPoint tip = contour.path->entered ? contour.tip : FlatPoint{};
    slot.moves.push_back(
        command_of(move, block.result.commands[index], slot.start, contour.plane, tip));
    if (!move.rounds_corner) slot.is_waiting = false;
    if (move.turned_round)
        block.result.warnings.push_back(
            {Severity::warning,
             {.line = block.result.line, .column = block.result.columns[index]},
             "the tool does not fit between this move and the one before it: its centre runs "
             "backwards here and cuts into the contour"});
}

/// Blocks that wait for nothing more are ready, in order.
void release(Contour& contour) {
    while (!contour.pending.empty()) {
        PendingBlock& block = contour.pending.front();
        const auto waits = [](const PendingBlock::Slot& slot) { return slot.is_waiting; };
        if (std::any_of(block.slots.begin(), block.slots.end(), waits)) return;
        BlockResult result = std::move(block.result);
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

core::Result<void> end_path(Contour& contour) {
    if (!contour.path) return {};
    FEELER_TRY(const CompensatedMoves moves, end_compensation(*contour.path));
    for (const CompensatedMove& move : moves) place_move(contour, move);
    contour.path.reset();
    return {};
}

/// Fanuc controls look a few blocks ahead. Where too many of them do not move in the plane, the
/// tool ends beside the end of the move before them, and cuts into an inside corner.
void warn_of_blocks_between(Contour& contour, size_t number, const ContourMove& move) {
    constexpr size_t harmless = 1;
    const RadiusCompensation& path = *contour.path;
    const bool stays = !move.arc && move.end == path.programmed;
    if (!path.extends_corners || path.waiting.empty() || stays) return;
    const size_t before = path.waiting.front().id / commands_of_a_block;
    if (number <= before + 1 + harmless) return;
    contour.pending.back().result.warnings.push_back(
        {Severity::warning, move.where,
         fmt::format("{} blocks without a move in the plane stand before this one: a control that "
                     "looks no farther ahead than that cuts into an inside corner here",
                     number - before - 1)});
}

/// One motion of the block that was pushed last.
core::Result<void> take_motion(Contour& contour, size_t index) {
    PendingBlock& block = contour.pending.back();
    const CanonicalCommand& command = block.result.commands[index];
    const core::SourceSpan where{
        .line = block.result.line, .column = block.result.columns[index], .length = 1};
    const auto end = flat(*end_of(command), contour.plane);
    if (!end)
        return core::fail(core::ErrorCode::missing_value,
                          "cutter radius compensation needs a known place in its plane", where);
    const size_t number = contour.first_pending + contour.pending.size() - 1;
    ContourMove move{.id = number * commands_of_a_block + index,
                     .rapid = std::holds_alternative<StraightTraverse>(command),
                     .end = *end,
                     .where = where};
    if (const auto* arc = std::get_if<ArcFeed>(&command))
        move.arc = FlatArc{{arc->centre[0], arc->centre[1]}, arc->turns};
    warn_of_blocks_between(contour, number, move);
    FEELER_TRY(const CompensatedMoves moves, add_move(*contour.path, move));
    block.slots[index].is_waiting = true;
    for (const CompensatedMove& done : moves) place_move(contour, done);
    return {};
}

/// Where the controlled point of a turning tool lies, seen from the centre of its nose of radius 1:
/// the crossing of the lines along X and Z that touch the nose on the side the tool points to.
FlatPoint tip_of(int orientation, Plane plane) {
    constexpr int along_x[] = {0, -1, -1, 1, 1, 0, -1, 0, 1, 0};
    constexpr int along_z[] = {0, 1, -1, -1, 1, 1, 0, -1, 0, 0};
    if (plane != Plane::zx) return {};
    const double x = along_x[orientation], z = along_z[orientation];
    return axes_of(plane).first == 0 ? FlatPoint{x, z} : FlatPoint{z, x};
}

core::Result<void> begin_path(Contour& contour, const ModalState& before, const ModalState& after,
                              const BlockResult& block) {
    contour.plane = after.plane;
    const auto at = flat(before.position, after.plane);
    if (!at)
        return core::fail(core::ErrorCode::missing_value,
                          "cutter radius compensation begins at an unknown place: move there "
                          "first, or say where the machine starts",
                          {.line = block.line, .column = 1});
    const ContourSide side =
        after.compensation == Side::left ? ContourSide::left : ContourSide::right;
    contour.path = begin_compensation(side, after.compensation_radius, *at);
    contour.path->extends_corners = contour.style == ContourStyle::fanuc;
    contour.tip = contour.path->radius * tip_of(after.turning_orientation, after.plane);
    return {};
}

core::Result<void> take_commands(Contour& contour, const BlockResult& block,
                                 const ModalState& before) {
    contour.pending.push_back({block, std::vector<PendingBlock::Slot>(block.commands.size())});
    Position place = before.position;
    for (size_t i = 0; i < block.commands.size(); ++i) {
        PendingBlock::Slot& slot = contour.pending.back().slots[i];
        slot.start = place;
        if (std::holds_alternative<ProgramEnd>(block.commands[i]))
            if (auto ended = end_path(contour); !ended) return ended;
        const Position* end = end_of(block.commands[i]);
        if (!end) continue;
        if (contour.path)
            if (auto taken = take_motion(contour, i); !taken) return taken;
        place = *end;
    }
    return {};
}

core::Result<void> take_with_corners(Contour& contour, const BlockResult& block,
                                     const ModalState& before, const ModalState& after) {
    const bool on = after.compensation != Side::none && after.compensation_radius != 0.0;
    const bool changed = before.compensation != after.compensation
                         || before.compensation_radius != after.compensation_radius;
    const bool pauses = std::exchange(contour.pauses, false);
    if (contour.path && (!on || changed || pauses))
        if (auto ended = end_path(contour); !ended) return ended;
    if (on && !contour.path && !pauses)
        if (auto begun = begin_path(contour, before, after, block); !begun) return begun;
    if (contour.pending.size() >= most_pending)
        return core::fail(core::ErrorCode::invalid_value,
                          "cutter radius compensation waits for a move in its plane for too long: "
                          "switch it off with G40",
                          {.line = block.line, .column = 1});
    if (auto taken = take_commands(contour, block, before); !taken) {
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

bool Contour::operator==(const Contour& other) const {
    const auto place = [](const Contour& contour) {
        return contour.path ? std::optional(contour.path->tool) : std::nullopt;
    };
    return corners == other.corners && place(*this) == place(other)
           && pending.size() == other.pending.size() && ready.size() == other.ready.size()
           && failure.has_value() == other.failure.has_value();
}

core::Result<void> take_block(Contour& contour, const BlockResult& block, const ModalState& before,
                              const ModalState& after) {
    if (contour.corners.is_idle()) return take_with_corners(contour, block, before, after);
    FEELER_TRY(const std::vector<ExecutedBlock> ready,
               take_for_corners(contour.corners, {block, before, after}));
    return take_all(contour, ready);
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
