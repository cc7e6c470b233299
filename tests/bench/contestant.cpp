#include "tests/bench/contestant.h"

#include <iterator>

#include "core/distance/distance_engine.h"
#include "tests/bench/peers.h"

namespace bench {
namespace {

using MakeEngine = std::unique_ptr<core::DistanceEngine> (*)();

/// Our engines; the last one must be faster than all others.
constexpr MakeEngine engines[] = {
    core::paper_engine,
    core::fast_engine,
};

struct Pair {
    explicit Pair(MakeEngine make, const Points& points_a, const Points& points_b)
        : engine(make()), a(engine->add(points_a).value()), b(engine->add(points_b).value()) {}

    core::ClosestPair closest(const core::Transform& a_from_b, const core::PairGoal& goal) const {
        return engine->closest_pair(a, b, a_from_b, goal).value();
    }

    std::unique_ptr<core::DistanceEngine> engine;
    core::PointBody a, b;
};

/// A query along a path: the pair of the previous pose is the initial guess.
Query follower(std::shared_ptr<const Pair> pair) {
    const auto last = std::make_shared<std::optional<core::PointPair>>();
    return [pair = std::move(pair), last](const auto& a_from_b, const auto& goal) {
        core::PairGoal guided = goal;
        guided.first = *last;
        const core::ClosestPair found = pair->closest(a_from_b, guided);
        if (found.found()) *last = found.points;
        return found.distance;
    };
}

Contestant engine_contestant(MakeEngine make) {
    return {std::string(make()->name()), 0.0,
            [make](const Points& a, const Points& b) -> Prepared {
                const auto pair = std::make_shared<const Pair>(make, a, b);
                return {[pair](const auto& a_from_b, const auto& goal) {
                            return pair->closest(a_from_b, goal).distance;
                        },
                        [pair] { return follower(pair); }};
            },
            [make](const Points& points) {
                std::shared_ptr<core::DistanceEngine> engine = make();
                engine->add(points).value();
                return engine;
            }};
}

} // namespace

std::vector<Contestant> contestants() {
    std::vector<Contestant> all;
    for (const MakeEngine make : engines) all.push_back(engine_contestant(make));
#ifdef FEELER_BENCH_FCL
    all.push_back(fcl_peer());
#endif
#ifdef FEELER_BENCH_NANOFLANN
    all.push_back(nanoflann_peer());
#endif
#ifdef FEELER_BENCH_EMBREE
    all.push_back(embree_peer());
#endif
    return all;
}

std::string challenger() { return std::string(std::rbegin(engines)[0]()->name()); }

} // namespace bench
