#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/distance/body_distance.h"
#include "core/motion/event.h"

namespace core {

/// The half of the machine that an axis moves: the tool side or the work side.
enum class Side : uint8_t { tool, table };

/// One axis. `direction` is the direction in which the tool moves relative to the work as the value
/// increases; for a rotary axis, the axis of rotation by the right-hand rule. An axis on the table
/// side moves the work the opposite way.
struct MachineAxis {
    Vec3 direction = Vec3(0.0); // unit length, machine frame with all axes at 0
    std::optional<double> min = {}, max = {}, home = {};
    std::optional<double> rapid = {};        // mm/min, degrees/min
    std::optional<double> acceleration = {}; // mm/s2, degrees/s2
    bool present = true;
    Side side = Side::tool;
    Vec3 point = Vec3(0.0);        // rotary: a point on the axis of rotation
    LinkId carrier = LinkId::base; // the link that carries this axis
    bool shortest_way = false;     // rotary: takes the shorter direction to an angle
    // How far the axis of rotation may be from where it is stated.
    double point_tolerance = 0.0;     // of `point`, mm
    double direction_tolerance = 0.0; // of `direction`, radians
};

/// A solid part of the machine. Frame: the machine's with all axes at 0.
struct MachineBody {
    std::string name;
    ExactBody body;
    LinkId link = LinkId::base; // the link that carries the body
    Transform place = {};       // moves it from where the machine describes it
    double deviation = 0.0;     // of `body` from the true one, mm
};

/// A machine: linear and rotary axes from the base to the spindle and from the base to the table.
///
/// Frame:   with all axes at 0, the centre of the gauge line is the origin and the tool points to
///          -Z.
struct Machine {
    std::array<MachineAxis, axis_count> axes = three_axes();
    RapidStyle rapid = RapidStyle::straight;
    // How far the control leaves the path at corners, mm, where the program does not say.
    std::optional<double> corner_tolerance;       // between feeds
    std::optional<double> rapid_corner_tolerance; // between rapids
    LinkId spindle = link_of(2);                  // carries the tool
    LinkId table = LinkId::base;                  // carries the work
    // An axis that moves nothing by itself: while the control follows the tip, it takes the tool to
    // be longer by its value. W of LinuxCNC's 5axiskins.
    std::optional<size_t> length_axis;
    std::vector<MachineBody> bodies;

    /// Whether an axis of rotation is only known with a tolerance.
    bool has_axis_tolerances() const {
        return std::any_of(axes.begin(), axes.end(), [](const MachineAxis& axis) {
            return axis.point_tolerance > 0.0 || axis.direction_tolerance > 0.0;
        });
    }
    bool has_rotary() const { return axes[3].present || axes[4].present || axes[5].present; }

    /// The length of the tool from which the control computes the position of the tip.
    double controlled_length(double tool_length, const AxisValues& values) const {
        return length_axis ? tool_length + values[*length_axis] : tool_length;
    }

    /// Position of the gauge line relative to the work from the linear axes alone. Frame: the
    /// machine's.
    Vec3 linear_position(const AxisValues& values) const {
        Vec3 p(0.0);
        for (size_t i = 0; i < axis_count; ++i)
            if (axes[i].present && !is_rotary(i) && i != length_axis)
                p += values[i] * axes[i].direction;
        return p;
    }
    AxisPosition home() const {
        AxisPosition position;
        for (size_t i = 0; i < axis_count; ++i)
            if (axes[i].present) position[i] = axes[i].home;
        return position;
    }

private:
    /// X, Y and Z along the axes of the frame, all on the tool side.
    static std::array<MachineAxis, axis_count> three_axes() {
        std::array<MachineAxis, axis_count> axes;
        for (size_t i = 0; i < axis_count; ++i) axes[i].present = i < 3;
        for (int i = 0; i < 3; ++i) axes[static_cast<size_t>(i)].direction[i] = 1.0;
        axes[1].carrier = link_of(0);
        axes[2].carrier = link_of(1);
        return axes;
    }
};

} // namespace core
