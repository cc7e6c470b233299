#pragma once

#include <random>
#include <vector>

#include "core/base/vec.h"

namespace test_support {

using Points = std::vector<core::Vec3>;

/// Random points in a cube of half size `reach`.
inline Points random_cloud(std::mt19937& rng, int count, double reach) {
    std::uniform_real_distribution<double> position(-reach, reach);
    Points cloud;
    for (int i = 0; i < count; ++i) {
        const double x = position(rng), y = position(rng), z = position(rng);
        cloud.emplace_back(x, y, z);
    }
    return cloud;
}

/// Points 1 mm apart in rows, starting at the origin.
inline Points block_of_points(int nx, int ny, int nz) {
    Points points;
    for (int x = 0; x < nx; ++x)
        for (int y = 0; y < ny; ++y)
            for (int z = 0; z < nz; ++z) points.emplace_back(x, y, z);
    return points;
}

} // namespace test_support
