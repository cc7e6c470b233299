#include "gcode/lowering.h"

#include "gcode/arc_geometry.h"

namespace gcode {
namespace {

bool is_known(const core::AxisPosition& position) {
    return position[0] && position[1] && position[2];
}

core::ArcPath arc_path(const ArcFeed& command, const Offsets& offsets,
                       const core::AxisPosition& from, const core::AxisPosition& to) {
    const PlaneAxes axes = axes_of(command.plane);
    const auto first = static_cast<size_t>(axes.first);
    const auto second = static_cast<size_t>(axes.second);
    const Position shift = machine_minus_program(offsets);
    core::ArcPath path{.normal = axes.normal};
    path.centre[axes.first] = command.centre[0] + *shift[first];
    path.centre[axes.second] = command.centre[1] + *shift[second];
    const double start[2] = {*from[first], *from[second]};
    const double end[2] = {*to[first], *to[second]};
    const double centre[2] = {path.centre[axes.first], path.centre[axes.second]};
    path.angle = arc_angle(start, end, centre, command.turns);
    return path;
}

/// One overload per command that does something to the machine or to the offsets.
struct Visitor {
    Lowering& lowering;
    std::vector<core::Event> events;

    core::Motion motion_to(const Position& end, core::MotionKind kind, double feed) {
        core::Motion motion;
        motion.kind = kind;
        motion.from = lowering.machine;
        motion.to = machine_from_program(lowering.offsets, end);
        motion.feed = feed;
        // An axis that was not told to move is where it was, to the last bit.
        const Position here = program_from_machine(lowering.offsets, lowering.machine);
        for (size_t axis = 0; axis < 3; ++axis)
            if (here[axis] == end[axis] && here[axis]) motion.to[axis] = motion.from[axis];
        lowering.machine = motion.to;
        return motion;
    }

    void operator()(const StraightTraverse& command) {
        events.emplace_back(motion_to(command.end, core::MotionKind::rapid, 0.0));
    }
    void operator()(const StraightFeed& command) {
        events.emplace_back(motion_to(command.end, core::MotionKind::feed, command.feed));
    }
    void operator()(const ArcFeed& command) {
        core::Motion motion = motion_to(command.end, core::MotionKind::feed, command.feed);
        if (is_known(motion.from) && is_known(motion.to)) {
            motion.kind = core::MotionKind::arc;
            motion.arc = arc_path(command, lowering.offsets, motion.from, motion.to);
        }
        events.emplace_back(motion);
    }
    void operator()(const Dwell& command) { events.emplace_back(core::Dwell{command.seconds}); }
    void operator()(const ChangeTool& command) {
        events.emplace_back(core::ToolChange{command.tool});
    }
    void operator()(const Spindle& command) {
        events.emplace_back(core::SpindleChange{command.direction, command.speed});
    }
    void operator()(const UseToolLengthOffset& command) {
        lowering.offsets.tool_length = command.length;
        events.emplace_back(core::LengthOffsetChange{command.number, command.length});
    }
    void operator()(const SetOffset& command) { lowering.offsets = command.offsets; }
    void operator()(const SelectTool&) {}
    void operator()(const Coolant&) {}
    void operator()(const SelectPlane&) {}
    void operator()(const ProgramStop&) {}
    void operator()(const OptionalStop&) {}
    void operator()(const ProgramEnd&) {}
};

} // namespace

std::vector<core::Event> Lowering::lower(const CanonicalCommand& command) {
    Visitor visitor{*this, {}};
    std::visit(visitor, command);
    return std::move(visitor.events);
}

Lowering initial_lowering(const Environment& environment) {
    Lowering lowering;
    lowering.offsets.work = environment.work_offsets;
    lowering.machine = environment.start;
    return lowering;
}

std::vector<core::Event> lower(const BlockResult& block, Lowering& lowering) {
    std::vector<core::Event> events;
    for (const CanonicalCommand& command : block.commands)
        for (core::Event& event : lowering.lower(command)) events.push_back(event);
    return events;
}

} // namespace gcode
