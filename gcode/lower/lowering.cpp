#include "gcode/lower/lowering.h"

#include <algorithm>
#include <cmath>

#include "core/base/math.h"
#include "core/motion/kinematics.h"
#include "core/motion/machine.h"
#include "core/motion/plane_turn.h"
#include "gcode/contour/flat_path.h"
#include "gcode/exec/frame_codes.h"
#include "gcode/exec/probing.h"
#include "gcode/language/environment.h"

namespace gcode {
namespace {

bool is_known(const core::AxisPosition& position) {
    return position[0] && position[1] && position[2];
}

/// Largest distance of a chord from its arc, mm.
constexpr double chord_error = 0.001;

/// The axis of an arc in the machine (0 X, 1 Y, 2 Z) and whether the arc keeps its direction; empty
/// when the offsets tilt the arc out of these planes.
struct ArcAxis {
    int normal;
    bool is_mirrored;
};

std::optional<ArcAxis> arc_axis(const Offsets& offsets, const PlaneAxes& axes) {
    if (axes.first >= 3 || is_fixed_to_work(offsets)) return std::nullopt;
    const auto normal = static_cast<int>(axes.normal);
    if (!offsets.has_frame && (offsets.work.rotation_deg == 0.0 || normal == 2))
        return ArcAxis{normal, false};
    if (offsets.work.rotation_deg != 0.0 && normal != 2) return std::nullopt;
    const core::Mat3& linear = offsets.frame.linear;
    const int first = static_cast<int>(axes.first), second = static_cast<int>(axes.second);
    for (const int axis : {first, second})
        if (linear[axis][normal] != 0.0 || linear[normal][axis] != 0.0) return std::nullopt;
    const double a = linear[first][first], b = linear[second][first];
    const double c = linear[first][second], d = linear[second][second];
    // A circle stays a circle if both directions stay perpendicular and have the same scale.
    if (std::abs(a * b + c * d) > 1e-12 || std::abs(a * a + c * c - b * b - d * d) > 1e-12)
        return std::nullopt;
    return ArcAxis{normal, a * d - b * c < 0.0};
}

/// The angle of an arc command, in program coordinates.
double angle_of(const ArcFeed& command, const Position& from) {
    const PlaneAxes axes = axes_of(command.plane);
    const double start[2] = {*from[axes.first], *from[axes.second]};
    const double end[2] = {*command.end[axes.first], *command.end[axes.second]};
    return arc_angle(start, end, command.centre, command.turns);
}

core::ArcPath arc_path(const ArcFeed& command, const Offsets& offsets, ArcAxis axis,
                       const Position& from) {
    const PlaneAxes axes = axes_of(command.plane);
    Position centre = from;
    centre[axes.first] = command.centre[0];
    centre[axes.second] = command.centre[1];
    const Position there = machine_from_program(offsets, centre);
    core::ArcPath path{.normal = axis.normal};
    path.centre[static_cast<int>(axes.first)] = *there[axes.first];
    path.centre[static_cast<int>(axes.second)] = *there[axes.second];
    path.angle = angle_of(command, from) * (axis.is_mirrored ? -1.0 : 1.0);
    return path;
}

/// The factor by which distances in program coordinates grow at most in those of the machine.
double largest_scale(const Offsets& offsets) {
    if (!offsets.has_frame) return 1.0;
    const core::Mat3& linear = offsets.frame.linear;
    double apart = 0.0, sum = 0.0;
    const core::Mat3 square = glm::transpose(linear) * linear;
    for (int i = 0; i < 3; ++i) {
        sum += glm::dot(linear[i], linear[i]);
        for (int j = 0; j < 3; ++j)
            apart = std::max(apart, std::abs(square[i][j] - (i == j ? 1.0 : 0.0)));
    }
    return apart < 1e-9 ? 1.0 + 1e-9 : std::sqrt(sum);
}

/// One overload for each command that affects the machine or the offsets.
struct Visitor {
    Lowering& lowering;
    core::AxisSet settles;
    std::vector<core::Event> events;

    /// LinuxCNC waits for the end of a motion before most commands that are not motions.
    ///
    /// Source: emctaskmain.cc, emcTaskCheckPreconditions.
    void come_to_rest() {
        if (lowering.blends_like_linuxcnc) events.emplace_back(core::Dwell{});
    }

    void note_axis(size_t axis) {
        const core::Machine* machine = lowering.offsets.machine;
        const bool is_there = machine ? machine->axes[axis].present : axis < 3;
        if (!is_there && !lowering.other_axis) lowering.other_axis = axis;
    }

    void turn_the_short_way(Position& there) const {
        if (!lowering.offsets.machine) return;
        for (size_t axis = 3; axis < 6; ++axis) {
            if (!lowering.offsets.machine->axes[axis].shortest_way) continue;
            const auto& here = lowering.machine[axis];
            if (here && there[axis])
                there[axis] = *here + std::remainder(*there[axis] - *here, 360.0);
        }
    }

    /// Adds the path of the tip relative to the work, if both of its ends are known.
    void follow_tip(core::Motion& motion) const {
        const Offsets& offsets = lowering.offsets;
        if (!offsets.machine) return;
        AxisValues from{}, to{};
        for (size_t axis = 0; axis < axis_count; ++axis) {
            if (offsets.machine->axes[axis].present && (!motion.from[axis] || !motion.to[axis]))
                return;
            from[axis] = motion.from[axis].value_or(0.0);
            to[axis] = motion.to[axis].value_or(0.0);
        }
        // While the controlled length changes, the path is straight if no rotary axis turns; with
        // one, it is not measured (gcode/exec/following.cpp).
        const double length = offsets.machine->controlled_length(offsets.tool[2], to);
        if (length != offsets.machine->controlled_length(offsets.tool[2], from)) return;
        motion.tip = core::TipPath{core::tip_position(*offsets.machine, from, length),
                                   core::tip_position(*offsets.machine, to, length), length};
    }

    core::Motion motion_to(const Position& end, core::MotionKind kind, double feed) {
        core::Motion motion;
        motion.kind = kind;
        motion.from = lowering.machine;
        Position there = machine_from_program(lowering.offsets, end);
        // An axis that does not move must keep its exact value.
        const Position here = program_from_machine(lowering.offsets, lowering.machine);
        for (size_t axis = 0; axis < axis_count; ++axis) {
            const bool stays = here[axis] == end[axis] || is_fixed_to_work(lowering.offsets);
            if (stays && here[axis] && there[axis]
                && std::abs(*there[axis] - *lowering.machine[axis]) < 1e-9)
                there[axis] = lowering.machine[axis];
            if (there[axis] != lowering.machine[axis]) note_axis(axis);
        }
        turn_the_short_way(there);
        lowering.moved_tilted |=
            lowering.offsets.frame.tilts_tool && !is_fixed_to_work(lowering.offsets);
        motion.to = there;
        motion.feed = feed;
        motion.settles = settles;
        if (lowering.offsets.follows_tip) follow_tip(motion);
        lowering.machine = there;
        return motion;
    }

    /// Adds a motion whose rotary axes turn the tool in a plane, in parts with even turns.
    void add_in_plane(const core::Motion& whole) {
        const core::Machine& machine = *lowering.offsets.machine;
        const auto turn = core::turn_in_plane(machine, values_or_zero(whole.from),
                                              values_or_zero(whole.to), core::turn_error);
        if (!turn) {
            events.emplace_back(whole);
            return;
        }
        core::Motion part = whole;
        part.tip->turn_error = turn->error;
        const size_t count = turn->positions.size();
        const size_t first = turn->begins_in_place ? 1 : 0;
        const size_t moving = count - first - (turn->ends_in_place ? 1 : 0);
        for (size_t i = 1; i < count; ++i) {
            const size_t done = std::min(i - std::min(i, first), moving);
            const double along = static_cast<double>(done) / static_cast<double>(moving);
            part.tip->to = whole.tip->from + along * (whole.tip->to - whole.tip->from);
            AxisValues there = turn->positions[i - 1];
            for (size_t axis = 6; axis < axis_count; ++axis)
                there[axis] += along * (whole.to[axis].value_or(0.0) - there[axis]);
            const AxisValues reached =
                core::reach_tip(machine, there, part.tip->to, part.tip->tool_length)
                    .value_or(there);
            for (size_t axis = 0; axis < axis_count; ++axis)
                if (whole.to[axis]) part.to[axis] = reached[axis];
            events.emplace_back(part);
            part.from = part.to;
            part.tip->from = part.tip->to;
        }
        part.to = whole.to;
        part.tip->to = whole.tip->to;
        events.emplace_back(part);
    }

    void add(const core::Motion& motion, bool in_plane) {
        if (in_plane && motion.tip)
            add_in_plane(motion);
        else
            events.emplace_back(motion);
    }

    void operator()(const StraightTraverse& command) {
        core::Motion motion = motion_to(command.end, core::MotionKind::rapid, 0.0);
        motion.style = command.style;
        add(motion, command.in_plane);
    }
    void operator()(const StraightFeed& command) {
        add(motion_to(command.end, core::MotionKind::feed, command.feed), command.in_plane);
    }
    void operator()(const ArcFeed& command) {
        const Position from = program_from_machine(lowering.offsets, lowering.machine);
        const PlaneAxes axes = axes_of(command.plane);
        const bool known =
            is_known(from) && is_known(command.end) && from[axes.first] && from[axes.second];
        const auto axis = arc_axis(lowering.offsets, axes);
        if (known && !axis) {
            const ArcChords chords = chords_of_arc(from, command.end, axes, command.centre,
                                                   angle_of(command, from), chord_error);
            for (const Position& end : chords.ends) {
                core::Motion chord = motion_to(end, core::MotionKind::feed, command.feed);
                chord.path_error = chords.error * largest_scale(lowering.offsets);
                events.emplace_back(chord);
            }
            return;
        }
        core::Motion motion = motion_to(command.end, core::MotionKind::feed, command.feed);
        if (known) {
            motion.kind = core::MotionKind::arc;
            motion.arc = arc_path(command, lowering.offsets, *axis, from);
        }
        events.emplace_back(motion);
    }
    void operator()(const StraightProbe& command) {
        core::Motion motion = motion_to(command.end, core::MotionKind::feed, command.feed);
        motion.stops_at_contact = true;
        motion.leaves_contact = !command.towards;
        events.emplace_back(motion);
        lowering.machine = where_probing_ends(lowering.offsets, motion.from, motion.to);
    }
    void operator()(const ThreadFeed& command) {
        const Position from = program_from_machine(lowering.offsets, lowering.machine);
        const double feed = command.pitch * lowering.spindle_speed;
        events.emplace_back(motion_to(command.end, core::MotionKind::feed, feed));
        if (command.back_again) events.emplace_back(motion_to(from, core::MotionKind::feed, feed));
    }
    void operator()(const Dwell& command) { events.emplace_back(core::Dwell{command.seconds}); }
    void operator()(const ChangeTool& command) {
        events.emplace_back(core::ToolChange{command.tool});
    }
    void operator()(const NameTool& command) {
        events.emplace_back(core::ToolChange{command.tool});
    }
    void operator()(const Spindle& command) {
        lowering.spindle_speed = command.speed;
        events.emplace_back(core::SpindleChange{command.direction, command.speed});
        come_to_rest();
    }
    void operator()(const UseToolLengthOffset& command) {
        lowering.offsets.tool = command.offset;
        lowering.offsets.follows_tip = command.follows_tip;
        events.emplace_back(
            core::LengthOffsetChange{command.number, command.offset[2], command.is_assumed});
        come_to_rest();
    }
    void operator()(const SetOffset& command) {
        lowering.offsets = command.offsets;
        if (command.is_told) come_to_rest();
    }
    void operator()(const SelectTool&) {}
    void operator()(const Coolant&) { come_to_rest(); }
    void operator()(const SelectPlane&) {}
    void operator()(const UseSpindleMode&) {}
    void operator()(const SetPathMode& command) {
        core::PathModeChange change;
        if (command.mode == PathMode::exact_path) change.blending = core::Blending::exact_path;
        if (command.mode == PathMode::exact_stop) change.blending = core::Blending::exact_stop;
        if (command.tolerance > 0.0) change.tolerance = command.tolerance;
        change.joining = command.naive_tolerance;
        change.distance = command.corners.distance;
        change.rapid_tolerance = command.corners.rapid_tolerance;
        change.rapid_distance = command.corners.rapid_distance;
        change.blends = change.blends_at_arcs = command.corners.blends;
        change.rapids_keep_speed = command.corners.rapids_keep_speed;
        change.between_kinds = command.corners.between_kinds;
        lowering.blends_like_linuxcnc = change.blends || change.rapids_keep_speed;
        events.emplace_back(change);
    }
    void operator()(const EnableOverride&) {}
    void operator()(const SetOutput&) {}
    void operator()(const WaitForInput&) {}
    void operator()(const Message&) {}
    void operator()(const ProgramStop&) { events.emplace_back(core::Dwell{}); }
    void operator()(const OptionalStop&) { come_to_rest(); }
    void operator()(const ProgramEnd&) {}
};

} // namespace

ArcChords chords_of_arc(const Position& from, const Position& end, const PlaneAxes& axes,
                        const double (&centre)[2], double angle, double chord_error) {
    const double u = *from[axes.first] - centre[0];
    const double v = *from[axes.second] - centre[1];
    const double radius = core::hypot(u, v);
    const double end_radius =
        core::hypot(*end[axes.first] - centre[0], *end[axes.second] - centre[1]);
    const double step = std::sqrt(8.0 * chord_error / std::max({radius, end_radius, chord_error}));
    const int count = std::clamp(static_cast<int>(std::abs(angle) / step) + 1, 1, 100000);
    // An eighth of the second derivative by the angle, times the square of the step; 1 % for
    // rounding.
    const double drift = angle != 0.0 ? 2.0 * (end_radius - radius) / angle : 0.0;
    const double turned = angle / count;
    ArcChords chords;
    chords.error =
        1.01 * 0.125 * core::hypot(std::max(radius, end_radius), drift) * turned * turned;
    for (int i = 1; i < count; ++i) {
        const double fraction = static_cast<double>(i) / count;
        const double turn = angle * fraction;
        const double reach = (radius + fraction * (end_radius - radius)) / radius;
        Position position = end;
        for (size_t axis = 0; axis < axis_count; ++axis)
            if (from[axis] && position[axis])
                *position[axis] = *from[axis] + fraction * (*end[axis] - *from[axis]);
        position[axes.first] = centre[0] + reach * (u * core::cos(turn) - v * core::sin(turn));
        position[axes.second] = centre[1] + reach * (u * core::sin(turn) + v * core::cos(turn));
        chords.ends.push_back(position);
    }
    chords.ends.push_back(end);
    return chords;
}

std::vector<core::Event> Lowering::lower(const CanonicalCommand& command, core::AxisSet settles) {
    Visitor visitor{*this, settles, {}};
    std::visit(visitor, command);
    return std::move(visitor.events);
}

Lowering initial_lowering(const InterpreterState& state) {
    Lowering lowering;
    lowering.offsets = state.modal.offsets;
    lowering.machine = machine_from_program(state.modal.offsets, state.modal.position);
    const CornerTolerances& corners = state.modal.corner_tolerances;
    lowering.blends_like_linuxcnc = corners.blends || corners.rapids_keep_speed;
    return lowering;
}

Lowering initial_lowering(const Environment& environment) {
    return initial_lowering(initial_state(environment));
}

std::vector<core::Event> lower(const BlockCommands& block, Lowering& lowering) {
    std::vector<core::Event> events;
    for (size_t i = 0; i < block.commands.size(); ++i) {
        // Without an uncertain position, all ends are known.
        const core::AxisSet settles =
            block.settled.empty() ? core::AxisSet{0xffff} : block.settled[i];
        for (core::Event& event : lowering.lower(block.commands[i], settles))
            events.push_back(event);
    }
    return events;
}

} // namespace gcode
