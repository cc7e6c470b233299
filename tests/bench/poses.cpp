#include "tests/bench/poses.h"

#include <numbers>

#include <fmt/format.h>

namespace bench {
namespace {

/// Moves B towards A until it is `gap` away. A step by the remaining distance never goes too far.
core::Transform approached(const Query& exact, const core::Mat3& rotation,
                           const core::Vec3& direction, double gap) {
    double away = 200.0;
    for (int step = 0; step < 100; ++step) {
        const double left = exact({rotation, away * direction}, {}) - gap;
        away -= left;
        if (left < 1e-3) break;
    }
    return {rotation, away * direction};
}

} // namespace

core::Vec3 generic_direction() { return glm::normalize(core::Vec3(1.0, 0.35, 0.2)); }

std::vector<Pose> gap_poses(double touching, const core::Vec3& direction,
                            const core::Vec3& angles_deg) {
    std::vector<Pose> poses;
    for (const double gap : gaps)
        poses.push_back({fmt::format("gap-{}", gap),
                         {core::rotation_xyz_deg(angles_deg), (touching + gap) * direction}});
    return poses;
}

std::vector<Pose> faces_apart(double touching, double angle_deg, const core::Vec3& sideways) {
    std::vector<Pose> poses;
    for (const double gap : {5.0, 7.5, 10.0, 15.0})
        poses.push_back({fmt::format("gap-{}", gap),
                         {core::rotation_xyz_deg({0.0, 0.0, angle_deg}),
                          sideways + core::Vec3(0.0, 0.0, touching + gap)}});
    return poses;
}

std::vector<Pose> approaches(const Query& exact, int count) {
    std::vector<Pose> poses;
    for (int i = 0; i < count; ++i) {
        const core::Vec3 direction = glm::normalize(
            core::Vec3(std::cos(2.4 * i + 0.3), std::sin(2.4 * i + 0.3), std::cos(1.7 * i + 1.0)));
        const core::Mat3 turn =
            core::rotation_xyz_deg({37.0 * i + 10.0, 71.0 * i + 20.0, 113.0 * i + 30.0});
        const double gap = gaps[i % 6];
        poses.push_back(
            {fmt::format("{}-gap-{}", i, gap), approached(exact, turn, direction, gap)});
    }
    return poses;
}

std::vector<Pose> pin_poses() {
    return {
        {"centred", core::translation({0.0, 0.0, 15.0})},
        {"near-wall", {core::rotation_xyz_deg({0, 0, 11}), core::Vec3(1.6, 0.4, 14.0)}},
        {"tilted", {core::rotation_xyz_deg({1.5, 0.7, 31}), core::Vec3(0.1, -0.2, 14.0)}},
        {"near-floor", {core::rotation_xyz_deg({0.3, -0.4, 5}), core::Vec3(0.3, 0.5, 10.8)}},
        {"half-out", {core::rotation_xyz_deg({2.0, 1.0, 73}), core::Vec3(-0.4, 0.3, 40.0)}},
        {"above", {core::rotation_xyz_deg({12.0, 25.0, 40}), core::Vec3(3.0, 2.0, 80.0)}},
    };
}

std::vector<Pose> linked_poses() {
    return {
        {"linked-wide", {core::rotation_xyz_deg({90, 0, 0}), core::Vec3(30.0, 0.0, 0.0)}},
        {"linked-mid", {core::rotation_xyz_deg({80, 10, 5}), core::Vec3(38.0, 3.0, -2.0)}},
        {"linked-near", {core::rotation_xyz_deg({97, 8, -6}), core::Vec3(42.0, -1.0, 1.0)}},
    };
}

std::vector<core::Transform> path_round_a_ball() {
    const int lines = 8, steps = 1250;
    const double reach = 51.0 / std::cos(std::numbers::pi / lines);
    const core::Mat3 tilt = core::rotation_xyz_deg({33.0, 21.0, 7.0});
    const auto corner = [&](int i) {
        const double angle = 2.0 * std::numbers::pi * i / lines;
        return tilt * core::Vec3(reach * std::cos(angle), reach * std::sin(angle), 0.0);
    };
    std::vector<core::Transform> path;
    for (int line = 0; line < lines; ++line)
        for (int step = 0; step < steps; ++step) {
            const double turn = 0.01 * static_cast<double>(path.size());
            path.push_back({core::rotation_xyz_deg({0.3 * turn, 0.5 * turn, 0.8 * turn}),
                            glm::mix(corner(line), corner(line + 1), double(step) / steps)});
        }
    return path;
}

} // namespace bench
