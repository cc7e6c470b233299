#pragma once

#include <random>

#include "tests/support/true_machining.h"

namespace test_support {

/// A point of a body and the distance to which the other comes: never below the true one.
struct NearPoint {
    core::Vec3 p = core::Vec3(0.0); // in the body's frame
    Nearness near;
};

/// Searches for the least distance of a pair over a block, starting from known points.
class ClearanceSearch {
public:
    ClearanceSearch(const TrueMachining& world, const std::vector<TruePassage>& block,
                    const TruePair& pair, bool crashed, std::mt19937& random)
        : world_(world), block_(block), pair_(pair), crashed_(crashed), random_(random) {}

    const NearPoint& best() const { return best_; }

    /// Adds a point; for the stock, one that existed before the block.
    void offer_known(const core::Vec3& p, const Removal& removal) {
        const Nearness near = nearness(world_, block_, pair_, p, removal, best_.near.distance);
        if (near.distance < best_.near.distance) best_ = {p, near};
    }

    /// Adds a point if it belongs to the body.
    void offer(const core::Vec3& p) {
        const Removal always{block_.size(), 0.0};
        if (pair_.cuts_fixture(world_)) {
            if (const auto until = world_.removal(block_, *pair_.fixture, p))
                offer_known(p, *until);
            return;
        }
        if (pair_.fixture) return offer_known(p, always);
        const double limit = best_.near.distance;
        if (nearness(world_, block_, pair_, p, always, limit).distance >= limit) return;
        if (world_.is_spared(p)) offer_known(p, world_.removal(block_, crashed_, p));
    }

    /// Adds the points of the body in its raw shape that are nearest to points of the part.
    void offer_foremost() {
        for (const TruePassage& by : block_) {
            if (!pair_.counts_in(world_, by)) continue;
            const core::ProfileElement& hull = by.tool->part(pair_.part)->hull;
            for (const double fraction : {0.0, 0.5, 1.0})
                for (const double z : {hull.z0, 0.5 * (hull.z0 + hull.z1), hull.z1})
                    offer_nearest_to({0, 0, z}, by, fraction);
        }
    }

    /// Improves the best point, alternately with the nearest points of the bodies and at random,
    /// while the distance is above `enough`.
    void improve(int steps, double radius, double enough) {
        std::uniform_real_distribution<double> way(-1.0, 1.0);
        for (int i = 0; i < steps && best_.near.distance > enough; ++i) {
            if (best_.near.distance == core::infinity) return;
            const double before = best_.near.distance;
            const TruePassage& by = block_[best_.near.passage];
            const core::Vec3 seen =
                world_.seen(by, pair_.mount(world_), best_.p)(best_.near.fraction);
            const auto on_part = nearest_of(by.tool->part(pair_.part)->profile, seen).nearest;
            offer_nearest_to(on_part, by, best_.near.fraction);
            if (pair_.fixture && best_.near.distance > before - 1e-7) return;
            if (pair_.fixture) continue;
            const core::Vec3 by_chance(way(random_), way(random_), way(random_));
            offer(nearest_of(world_.stock, best_.p + radius * by_chance).nearest);
            if (best_.near.distance >= before) radius *= 0.8;
        }
    }

private:
    /// Adds the point of the raw body nearest to a point in the tool's frame.
    void offer_nearest_to(const core::Vec3& p, const TruePassage& by, double fraction) {
        const core::AxisValues at = by.path.at(fraction);
        const core::Vec3 tip(at[0], at[1], at[2] - by.tool->length);
        const core::Vec3 here = mounted_place(world_.machine, pair_.mount(world_), at, p + tip);
        offer(nearest_of(pair_.solid(world_), here).nearest);
    }

    const TrueMachining& world_;
    const std::vector<TruePassage>& block_;
    TruePair pair_;
    bool crashed_;
    std::mt19937& random_;
    NearPoint best_;
};

} // namespace test_support
