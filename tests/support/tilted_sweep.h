#pragma once

#include <random>

#include "core/base/vec.h"
#include "tests/support/profile_oracle.h"

namespace test_support {

/// A random rotation matrix, roughly uniformly distributed.
inline core::Mat3 random_rotation(std::mt19937& rng) {
    std::normal_distribution<double> normal;
    const core::Vec3 x =
        glm::normalize(core::Vec3(normal(rng), normal(rng), normal(rng)) + core::Vec3(1e-12));
    const core::Vec3 y =
        glm::normalize(glm::cross(x, core::Vec3(normal(rng), normal(rng), normal(rng))));
    return {x, y, glm::cross(x, y)};
}

/// The distance of a point outside a piece that moves between two positions while its axis points
/// along the third column of the rotation (see outside_sweep).
template <typename Body>
double outside_tilted_sweep(const Body& body, const core::Mat3& stock_from_tool,
                            const core::Vec3& from, const core::Vec3& to, const core::Vec3& p) {
    const core::Mat3 back = glm::transpose(stock_from_tool);
    return outside_sweep(body, core::Vec3(0.0), back * (to - from), back * (p - from));
}

} // namespace test_support
