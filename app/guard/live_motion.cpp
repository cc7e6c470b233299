#include "app/guard/live_motion.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "core/base/units.h"
#include "core/motion/kinematics.h"
#include "gcode/language/modal_state.h"

namespace app {
namespace {

/// The motion with lengths in mm, but for its joints.
feeler_segment in_mm(feeler_segment motion, double unit) {
    const auto scale = [&](double& length) { length *= unit; };
    for (double(*values)[core::axis_count] : {&motion.from, &motion.to, &motion.stopped_at})
        for (size_t i = 0; i < core::axis_count; ++i)
            if (!core::is_rotary(i)) scale((*values)[i]);
    for (double& value : motion.centre) scale(value);
    scale(motion.feed);
    scale(motion.most_speed);
    scale(motion.acceleration);
    scale(motion.tolerance);
    scale(motion.tool_length);
    return motion;
}

bool turns(const feeler_segment& motion) {
    return !std::equal(std::begin(motion.from) + 3, std::begin(motion.from) + 6,
                       std::begin(motion.to) + 3);
}

/// Whether an axis that lengthens the tool moves while a rotary axis turns: then the tip takes no
/// straight way.
bool bends(const LiveMotion& motion, const core::Machine& machine) {
    const auto length = machine.length_axis;
    return motion.follows_tip && length && turns(motion)
           && motion.to[*length] != motion.from[*length];
}

} // namespace

bool moves_others(const feeler_segment& motion) {
    return !std::equal(std::begin(motion.from) + 3, std::end(motion.from),
                       std::begin(motion.to) + 3);
}

core::AxisValues axis_values(const double (&numbers)[core::axis_count]) {
    core::AxisValues values;
    std::copy(std::begin(numbers), std::end(numbers), values.begin());
    return values;
}

bool is_after_drop(const feeler_segment& motion) {
    return motion.follows_part != 0 || motion.follows + 1 != motion.number;
}

ControlKinematics::ControlKinematics(double unit, gcode::SwitchableKinematics kinematics,
                                     const core::Machine& machine, double tolerance)
    : unit_(unit),
      tolerance_(tolerance),
      kinematics_(std::move(kinematics)),
      machine_(std::make_shared<const core::Machine>(machine)) {}

core::AxisValues ControlKinematics::axes_at(const core::AxisValues& position,
                                            const LiveMotion& motion) const {
    if (!motion.follows_tip) return position;
    gcode::Offsets offsets;
    offsets.machine = machine_.get();
    offsets.follows_tip = offsets.has_world = true;
    offsets.tool[2] = motion.tool_length;
    gcode::Position tip;
    for (size_t i = 0; i < core::axis_count; ++i) tip[i] = position[i];
    *tip[2] -= motion.tool_length;
    const gcode::Position reached = gcode::machine_from_program(offsets, tip);
    core::AxisValues axes = position;
    for (size_t i = 0; i < core::axis_count; ++i) axes[i] = reached[i].value_or(position[i]);
    return axes;
}

std::optional<core::TipPath> ControlKinematics::tip_path(const core::AxisValues& from,
                                                         const core::AxisValues& to,
                                                         const LiveMotion& motion) const {
    if (!motion.follows_tip) return {};
    // While its length changes, no rotary axis turns, and the axes move straight: see read().
    const double length = machine_->controlled_length(motion.tool_length, to);
    if (length != machine_->controlled_length(motion.tool_length, from)) return {};
    return core::TipPath{core::tip_position(*machine_, from, length),
                         core::tip_position(*machine_, to, length), length};
}

/// Between the joints of the control and those of the set-up, in the mode of the motion.
ControlKinematics::Difference ControlKinematics::difference_of(const LiveMotion& motion) const {
    constexpr double offset[] = FEELER_ASIDE;
    core::AxisValues aside = axis_values(motion.from);
    for (size_t i = 0; i < core::axis_count; ++i)
        aside[i] += FEELER_BETWEEN * (motion.to[i] - aside[i]) + (i < 3 ? unit_ * offset[i] : 0.0);
    const std::pair<const double*, core::AxisValues> places[] = {
        {motion.joint_from, axes_at(axis_values(motion.from), motion)},
        {motion.joint_aside, axes_at(aside, motion)},
        {motion.joint_to, axes_at(axis_values(motion.to), motion)},
    };
    Difference largest;
    const std::string& letters = kinematics_->coordinates;
    const size_t joints =
        std::min({letters.size(), size_t{motion.joints}, std::size(motion.joint_to)});
    for (const auto& [on_control, axes] : places)
        for (size_t joint = 0; joint < joints; ++joint) {
            const size_t axis = core::axis_letters.find(letters[joint]);
            if (axis >= core::axis_count) continue;
            const double value = on_control[joint] * (core::is_rotary(axis) ? 1.0 : unit_);
            const double difference = std::abs(value - axes[axis]);
            if (difference <= largest.most) continue;
            largest = {std::isfinite(difference) ? difference : core::infinity, letters[joint],
                       value, axes[axis]};
        }
    return largest;
}

/// Finds out in which mode the control makes a motion.
void ControlKinematics::compare(LiveMotion& motion) const {
    if (motion.joints == 0) {
        motion.problem = "The kinematics of LinuxCNC could not be asked what it does.";
        return;
    }
    using Type = gcode::SwitchableKinematics::Type;
    std::optional<Difference> least;
    bool is_tip = false;
    for (const Type type : {Type::axes, Type::tip}) {
        const auto& types = kinematics_->types;
        if (std::find(types.begin(), types.end(), type) == types.end()) continue;
        motion.follows_tip = type == Type::tip;
        const Difference difference = difference_of(motion);
        if (least && !(difference.most < least->most)) continue;
        least = difference;
        is_tip = motion.follows_tip;
    }
    motion.follows_tip = is_tip;
    if (!least || least->most < 0.0)
        motion.problem = "None of LinuxCNC's joints is one of the set-up.";
    else if (!(least->most <= tolerance_))
        motion.problem = fmt::format(
            "LinuxCNC's kinematics are not those of the set-up: by them, {} would be at {:.4f} and "
            "not at {:.4f} ({}).",
            least->letter, least->on_control, least->in_setup,
            core::is_rotary(core::axis_letters.find(least->letter)) ? "degrees" : "mm");
}

LiveMotion ControlKinematics::read(const feeler_segment& segment) const {
    LiveMotion motion;
    static_cast<feeler_segment&>(motion) = in_mm(segment, unit_);
    if (kinematics_) compare(motion);
    if (moves_others(motion) && motion.blending == FEELER_BLENDED) {
        motion.path_error = FEELER_TURNING_CORNER * motion.tolerance;
        motion.turn_error = core::radians_of(FEELER_TURN_ERROR);
    }
    motion.axes_from = axes_at(axis_values(motion.from), motion);
    motion.axes_to = axes_at(axis_values(motion.to), motion);
    if (motion.problem.empty() && machine_ && bends(motion, *machine_))
        motion.problem = fmt::format("{} moves while a rotary axis turns, which is not followed.",
                                     core::axis_letters[*machine_->length_axis]);
    return motion;
}

} // namespace app
