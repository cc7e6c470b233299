#include "gcode/exec/probing.h"

#include <algorithm>
#include <cmath>

#include "gcode/contour/contour.h"
#include "gcode/exec/execution.h"
#include "gcode/language/dialect.h"
#include "gcode/language/environment.h"

namespace gcode {
namespace {

/// Two positions of an axis that are closer than this are the same, mm. Rounding of coordinates is
/// far below, every real uncertainty far above.
constexpr double same = 1e-6;

bool is_same(double a, double b) { return std::abs(a - b) < same; }

/// The farther end of the range that two ways from a position span in the worst case.
double added(double known, double way) {
    if (known * way >= 0.0) return known + way;
    return std::abs(way) > std::abs(known) ? way : known;
}

Position displaced(Position position, const AxisValues& by) {
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (position[axis]) *position[axis] += by[axis];
    return position;
}

/// The difference of two positions; empty if only one of them is known in an axis.
std::optional<AxisValues> difference(const Position& a, const Position& b) {
    AxisValues by{};
    for (size_t axis = 0; axis < axis_count; ++axis) {
        if (a[axis].has_value() != b[axis].has_value()) return std::nullopt;
        if (a[axis]) by[axis] = *b[axis] - *a[axis];
    }
    return by;
}

/// The end of a command that moves axes.
const Position* end_of(const CanonicalCommand& command) {
    return std::visit(
        [](const auto& motion) -> const Position* {
            if constexpr (requires { motion.end; })
                return &motion.end;
            else
                return nullptr;
        },
        command);
}

/// A block, command by command, as run from two positions.
class Comparison {
public:
    explicit Comparison(const ModalState& before) : offsets_(before.offsets) {
        const Position here = machine_from_program(offsets_, before.position);
        const Position there =
            machine_from_program(offsets_, displaced(before.position, before.spread));
        deviation_ = difference(here, there).value_or(AxisValues{});
    }

    /// Takes the next command of both; false if more than its end depends on the position.
    bool take(const CanonicalCommand& here, const CanonicalCommand& there) {
        settled.push_back(0);
        if (here.index() != there.index() || is_fixed_to_work(offsets_)) return false;
        if (const Position* end = end_of(here))
            return is_alike(here, there) && ends_alike(*end, *end_of(there));
        if (!(here == there)) return false;
        if (const auto* set = std::get_if<SetOffset>(&here)) offsets_ = set->offsets;
        if (const auto* length = std::get_if<UseToolLengthOffset>(&here)) {
            offsets_.tool = length->offset;
            offsets_.follows_tip = length->follows_tip;
        }
        return true;
    }

    std::vector<core::AxisSet> settled; // BlockCommands::settled

private:
    /// Whether two motions are equal except for their ends, and for feeds that follow from lengths.
    bool is_alike(const CanonicalCommand& here, const CanonicalCommand& there) const {
        if (const auto* arc = std::get_if<ArcFeed>(&here)) {
            const auto& other = std::get<ArcFeed>(there);
            const PlaneAxes axes = axes_of(arc->plane);
            // The plane of an arc is known in the machine only if no transform mixes axes.
            const bool is_in_plane = mixes_axes(offsets_) || deviation_[axes.first] != 0.0
                                     || deviation_[axes.second] != 0.0;
            return !is_in_plane && arc->plane == other.plane && arc->turns == other.turns
                   && is_same(arc->centre[0], other.centre[0])
                   && is_same(arc->centre[1], other.centre[1]);
        }
        const auto* thread = std::get_if<ThreadFeed>(&here);
        return !thread
               || (!thread->back_again && thread->pitch == std::get<ThreadFeed>(there).pitch);
    }

    bool ends_alike(const Position& here, const Position& there) {
        const auto by =
            difference(machine_from_program(offsets_, here), machine_from_program(offsets_, there));
        if (!by) return false;
        for (size_t axis = 0; axis < axis_count; ++axis) {
            if (is_same((*by)[axis], 0.0)) {
                settled.back() |= static_cast<core::AxisSet>(1U << axis);
                deviation_[axis] = 0.0;
            } else if (!is_same((*by)[axis], deviation_[axis])) {
                return false;
            }
        }
        return true;
    }

    Offsets offsets_;
    AxisValues deviation_{}; // of the machine between the two runs
};

bool probes(const BlockCommands& block) {
    for (const CanonicalCommand& command : block.commands)
        if (std::holds_alternative<StraightProbe>(command)) return true;
    return false;
}

/// Makes what may differ equal in two states: the ends of their motions, values that are unknown
/// anyway, and positions that are only remembered, which become unknown.
void equalise(InterpreterState& state, InterpreterState& elsewhere, bool probed) {
    ModalState &modal = state.modal, &other = elsewhere.modal;
    other.position = modal.position;
    other.spread = modal.spread;
    if (modal.way_home && other.way_home) {
        for (size_t axis = 0; axis < axis_count; ++axis) {
            const auto &here = (*modal.way_home)[axis], &there = (*other.way_home)[axis];
            if (here != there && !(here && there && is_same(*here, *there)))
                (*modal.way_home)[axis].reset();
        }
        other.way_home = modal.way_home;
    }
    if (other.direction != modal.direction) other.direction = modal.direction = {};
    const Parameters& known = *state.parameters;
    Parameters& there = elsewhere.parameters.write();
    const int last = static_cast<int>(known.numbered_count());
    for (int number = 1; number < last; ++number)
        if (known.is_unpredictable(number) || (probed && number >= 5061 && number <= 5069))
            there.set_numbered(number, known.numbered(number));
    for (const std::string& name : known.unpredictable_names())
        if (const auto value = known.named().find(name); value != known.named().end())
            there.set_named(name, value->second);
    for (size_t i = 0; i < std::min(state.frames.size(), elsewhere.frames.size()); ++i) {
        const Frame& frame = state.frames[i];
        Frame& other_frame = elsewhere.frames[i];
        for (size_t local = 1; local < frame.locals.size(); ++local)
            if (frame.unpredictable_locals >> local & 1U)
                other_frame.locals[local] = frame.locals[local];
        for (const std::string& name : frame.unpredictable_names)
            if (const auto value = frame.named.find(name); value != frame.named.end())
                other_frame.named.insert_or_assign(name, value->second);
    }
}

/// Leaves it to the blocks that position an axis to make its motions known again.
void lose_uncertain_axes(InterpreterState& state, BlockCommands& result, const AxisValues& spread) {
    ModalState& modal = state.modal;
    for (size_t axis = 0; axis < axis_count; ++axis) {
        if (spread[axis] == 0.0) continue;
        if (axis < 3)
            modal.following.unknown_axes |= static_cast<uint8_t>(1U << axis);
        else
            modal.position[axis].reset();
    }
    modal.spread = {};
    result.path = core::PathCertainty::unknown;
}

} // namespace

Position where_probing_ends(const Offsets& offsets, const Position& from, Position to) {
    bool moves = false;
    for (size_t axis = 0; axis < axis_count; ++axis) {
        const bool moves_here = from[axis] != to[axis];
        moves = moves || moves_here;
        if (moves_here && (is_rotary(axis) || !from[axis])) to[axis].reset();
    }
    for (size_t axis = 0; moves && is_fixed_to_work(offsets) && axis < 3; ++axis) to[axis].reset();
    return to;
}

void probe_to(Execution& execution, const StraightProbe& command) {
    ModalState& modal = execution.modal();
    const Position from = modal.position;
    execution.emit(command);
    modal.has_probed = true;
    modal.position = where_probing_ends(modal.offsets, from, command.end);
    for (size_t axis = 0; axis < axis_count; ++axis) {
        if (!modal.position[axis])
            modal.spread[axis] = 0.0;
        else if (from[axis])
            modal.spread[axis] = added(modal.spread[axis], *from[axis] - *command.end[axis]);
    }
}

bool is_stopped_somewhere(const ModalState& modal) { return modal.spread != AxisValues{}; }

void start_elsewhere(ModalState& modal) {
    modal.position = displaced(modal.position, modal.spread);
}

bool reads_unknown_position(const ModalState& modal, const Environment& environment, int number) {
    const SystemParameters parameters = dialect(environment.dialect).system_parameters;
    const auto axis_from = [&](int first) -> std::optional<size_t> {
        const bool is_axis = number >= first && number < first + static_cast<int>(axis_count);
        return is_axis ? std::optional(static_cast<size_t>(number - first)) : std::nullopt;
    };
    std::optional<size_t> axis;
    if (parameters == SystemParameters::rs274) axis = axis_from(5420);
    if (remembers_words(parameters))
        for (const int first : {5001, 5021, 5041})
            if (const auto one = axis_from(first)) axis = one;
    return axis && (is_stopped_somewhere(modal) || !modal.position[*axis]);
}

bool settle_positions(const ModalState& before, InterpreterState& state, BlockCommands& result,
                      InterpreterState& elsewhere, const BlockCommands& there) {
    const bool waits = before.compensation != Side::none || has_pending_blocks(state)
                       || state.modal.compensation != Side::none;
    if (waits) {
        lose_uncertain_axes(state, result, before.spread);
        return true;
    }
    if (result.commands.size() != there.commands.size()) return false;
    Comparison comparison(before);
    for (size_t i = 0; i < result.commands.size(); ++i)
        if (!comparison.take(result.commands[i], there.commands[i])) return false;
    const bool probed = probes(result);
    if (!probed) {
        const auto spread = difference(state.modal.position, elsewhere.modal.position);
        if (!spread) return false;
        state.modal.spread = *spread;
        for (double& width : state.modal.spread)
            if (is_same(width, 0.0)) width = 0.0;
    }
    equalise(state, elsewhere, probed);
    if (digest_of(state) != digest_of(elsewhere)) return false;
    result.settled = std::move(comparison.settled);
    return true;
}

Position known_position(const ModalState& modal) {
    Position known = modal.position;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (modal.spread[axis] != 0.0) known[axis].reset();
    return known;
}

void forget_uncertain_axes(ModalState& modal) {
    modal.position = known_position(modal);
    modal.spread = {};
}

} // namespace gcode
