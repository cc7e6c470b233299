#pragma once

#include <memory>
#include <random>
#include <vector>

#include "core/dbm/cutter.h"
#include "tests/support/convex_oracle.h"
#include "tests/support/stock_oracle.h"

namespace test_support {

/// Random moves at a box: chains of short moves, jumps, moves far away, and tools in any direction.
class RandomMoves {
public:
    RandomMoves(const core::Aabb& box, std::mt19937& rng) : box_(box), rng_(rng) {
        for (const core::RevolvedProfile& flutes : cutters())
            cutters_.push_back(
                std::make_shared<const core::Cutter>(core::make_cutter(flutes, 0.0)));
        cutters_.push_back(
            std::make_shared<const core::Cutter>(core::make_cutter(cutters()[1], 0.15)));
        at_ = random_point(box_.grown(2.0), rng_);
    }

    core::CutterSweep next() {
        if (chance(0.1)) cutter_ = cutters_[rng_() % cutters_.size()];
        if (chance(0.05))
            orientation_ = chance(0.5) ? core::Mat3(1.0) : frame_along(random_direction(rng_));
        if (chance(0.1)) at_ = random_point(box_.grown(chance(0.2) ? 60.0 : 3.0), rng_);
        const core::Vec3 from = at_;
        at_ += (chance(0.1) ? 8.0 : 0.8) * random_direction(rng_);
        if (chance(0.3)) at_.z = from.z;
        return {cutter_, from, at_, orientation_, ++block_};
    }

private:
    bool chance(double p) { return std::uniform_real_distribution<double>(0, 1)(rng_) < p; }
    static core::Mat3 frame_along(const core::Vec3& z) {
        const core::Vec3 x = glm::normalize(
            glm::cross(z, std::abs(z.x) < 0.7 ? core::Vec3(1, 0, 0) : core::Vec3(0, 1, 0)));
        return {x, glm::cross(z, x), z};
    }

    core::Aabb box_;
    std::mt19937& rng_;
    std::vector<std::shared_ptr<const core::Cutter>> cutters_;
    std::shared_ptr<const core::Cutter> cutter_ =
        std::make_shared<const core::Cutter>(core::make_cutter(cutters()[0], 0.0));
    core::Mat3 orientation_ = core::Mat3(1.0);
    core::Vec3 at_;
    uint32_t block_ = 0;
};

} // namespace test_support
