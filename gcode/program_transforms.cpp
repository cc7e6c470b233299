#include "gcode/program_transforms.h"

#include <cmath>
#include <numbers>

namespace gcode {
namespace {

struct Direction {
    double cosine, sine;
};

Direction direction_of(double degrees) {
    const double quarters = degrees / 90.0;
    if (quarters == std::floor(quarters)) {
        constexpr Direction exact[] = {{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}};
        const double turn = quarters - 4.0 * std::floor(quarters / 4.0);
        return exact[static_cast<size_t>(turn)];
    }
    const double angle = degrees * std::numbers::pi / 180.0;
    return {std::cos(angle), std::sin(angle)};
}

/// Lets a map that keeps one place follow what is there already.
void add_about(ProgramFrame& frame, const core::Mat3& linear, const core::Vec3& kept) {
    frame.linear = linear * frame.linear;
    frame.shift = linear * (frame.shift - kept) + kept;
}

void add_mirror_and_scaling(ProgramFrame& frame, const ProgramTransforms& transforms) {
    core::Mat3 reflected(1.0);
    for (int axis = 0; axis < 3; ++axis)
        if (transforms.mirror.axes[static_cast<size_t>(axis)]) reflected[axis][axis] = -1.0;
    if (reflected != core::Mat3(1.0)) add_about(frame, reflected, transforms.mirror.place);
    if (!transforms.scaling) return;
    core::Mat3 stretched(1.0);
    for (int axis = 0; axis < 3; ++axis) stretched[axis][axis] = transforms.scaling->factors[axis];
    add_about(frame, stretched, transforms.scaling->centre);
}

} // namespace

core::Mat3 turned_about(int axis, double degrees) {
    const Direction direction = direction_of(degrees);
    const int first = (axis + 1) % 3, second = (axis + 2) % 3;
    core::Mat3 turn(1.0);
    turn[first][first] = turn[second][second] = direction.cosine;
    turn[first][second] = direction.sine;
    turn[second][first] = -direction.sine;
    return turn;
}

ProgramFrame frame_of(const ProgramTransforms& transforms) {
    ProgramFrame frame;
    add_mirror_and_scaling(frame, transforms);
    if (const auto& rotation = transforms.rotation) {
        const double degrees = rotation->is_reversed ? -rotation->degrees : rotation->degrees;
        add_about(frame, turned_about(rotation->normal, degrees), rotation->centre);
    }
    if (const auto& tilt = transforms.tilt) {
        frame.linear = tilt->axes * frame.linear;
        frame.shift = tilt->axes * frame.shift + tilt->origin;
        frame.tilts_tool = tilt->axes[2] != core::Vec3(0.0, 0.0, 1.0);
    }
    frame.tilts_tool |= transforms.follows_vectors;
    return frame;
}

core::Vec3 scaled_place(const ProgramTransforms& transforms, const core::Vec3& place) {
    ProgramFrame frame;
    add_mirror_and_scaling(frame, transforms);
    return frame.linear * place + frame.shift;
}

} // namespace gcode
