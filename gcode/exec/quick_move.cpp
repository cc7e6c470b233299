#include "gcode/exec/quick_move.h"

#include <cmath>

#include "gcode/contour/contour.h"
#include "gcode/exec/execution.h"
#include "gcode/exec/following.h"
#include "gcode/exec/probing.h"
#include "gcode/language/codes.h"

namespace gcode {
namespace {

constexpr MotionCode rapid = MotionCode::rapid;
constexpr MotionCode straight = MotionCode::straight;

/// The index of an axis by its letter; axis_count for other letters.
constexpr std::array<uint8_t, 26> axes_by_letter = [] {
    std::array<uint8_t, 26> axes{};
    axes.fill(axis_count);
    for (size_t axis = 0; axis < axis_count; ++axis)
        axes[static_cast<size_t>(axis_letters[axis] - 'A')] = static_cast<uint8_t>(axis);
    return axes;
}();

/// Larger positions are left to the general implementation, mm or degrees.
constexpr double largest_quick_value = 1e7;

/// The changes that a block makes, collected while it is read.
struct Move {
    MotionCode motion = rapid;
    std::optional<double> feed{}; // mm/min
    LengthUnit feed_unit{};
    Position end{};
    bool has_code = false, has_axis = false;

    bool take(const Word& word, const ModalState& modal) {
        if (word.letter == 'N') return true;
        if (word.letter == 'F') {
            feed = to_mm(word.value, modal.unit);
            feed_unit = modal.unit;
            return true;
        }
        if (word.letter == 'G') {
            const bool known = !has_code && (word.value == 0.0 || word.value == 1.0);
            motion = word.value == 0.0 ? rapid : straight;
            has_code = true;
            return known;
        }
        const size_t axis = axes_by_letter[static_cast<size_t>(word.letter - 'A')];
        if (axis == axis_count) return false;
        const Offsets& offsets = modal.offsets;
        const bool is_plain =
            !modal.following.may_be_on && !offsets.follows_tip && !offsets.tilted_plane;
        if (is_rotary(axis) && !is_plain) return false;
        has_axis = true;
        if (std::abs(word.value) > largest_quick_value) return false;
        const double value = is_rotary(axis) ? word.value : to_mm(word.value, modal.unit);
        if (modal.distance == DistanceMode::absolute)
            end[axis] = value;
        else if (end[axis])
            *end[axis] += value;
        return std::abs(end[axis].value_or(0.0)) <= largest_quick_value;
    }
};

} // namespace

bool moves_quickly(const InterpreterState& state) {
    const ModalState& modal = state.modal;
    const ProgramTransforms& transforms = modal.transforms;
    return is_straight(modal.motion) && !modal.cycle && modal.compensation == Side::none
           && modal.feed_mode == FeedMode::per_minute && !modal.diameter_mode && modal.distance_said
           && modal.work_said && modal.incremental_stays && !modal.length_left
           && (modal.unit_said || state.said_unit) && !transforms.polar && !is_uncertain(modal)
           && !is_stopped_somewhere(modal) && !transforms.before_rotation && !state.rules.waits()
           && state.modal_macros.empty() && state.contour->is_idle() && !state.is_iso_mode
           && !state.after_end;
}

bool run_quick_move(const Block& block, InterpreterState& state, BlockCommands& result) {
    ModalState& modal = state.modal;
    Move move{.motion = *modal.motion,
              .feed = modal.feed,
              .feed_unit = modal.feed_unit,
              .end = modal.position};
    for (const Word& word : block.words)
        if (!move.take(word, modal)) return false;
    const bool lacks_feed = move.motion == straight && !(move.feed && *move.feed > 0.0);
    if (!move.has_axis || lacks_feed || (move.feed && *move.feed < 0.0)) return false;
    modal.motion = move.motion;
    modal.feed = move.feed;
    modal.feed_unit = move.feed_unit;
    if (move.motion == rapid)
        result.commands.emplace_back(StraightTraverse{move.end});
    else
        result.commands.emplace_back(StraightFeed{move.end, rate_to(modal, move.end, *move.feed)});
    modal.position = move.end;
    modal.leaves_contour = false;
    state.rules.has_moved = true;
    if (modal.doubt) result.path = core::PathCertainty::doubtful;
    result.columns.push_back(1);
    return true;
}

} // namespace gcode
