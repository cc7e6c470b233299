#include "app/bench/bench_table.h"

#include <algorithm>
#include <ctime>

#include "core/distance/distance_engine.h"

namespace app {
namespace {

double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// An engine that holds both bodies of a scene.
struct Contestant {
    std::unique_ptr<core::DistanceEngine> engine;
    core::PointBody a{}, b{};
};

core::Result<Contestant> contestant(std::unique_ptr<core::DistanceEngine> engine,
                                    const std::vector<core::Vec3>& points_a,
                                    const std::vector<core::Vec3>& points_b) {
    FEELER_TRY(const core::PointBody a, engine->add(points_a));
    FEELER_TRY(const core::PointBody b, engine->add(points_b));
    return Contestant{std::move(engine), a, b};
}

core::Result<BenchAnswer> answer(const Contestant& by, const core::Transform& a_from_b,
                                 double seconds_each) {
    BenchAnswer answer{.seconds = core::infinity};
    double spent = 0.0;
    do {
        const double start = cpu_seconds();
        FEELER_TRY(const core::ClosestPair pair, by.engine->closest_pair(by.a, by.b, a_from_b));
        const double seconds = cpu_seconds() - start;
        answer = {pair.distance, pair.node_tests, pair.point_tests,
                  std::min(answer.seconds, seconds)};
        spent += seconds;
    } while (spent < seconds_each);
    return answer;
}

} // namespace

core::Result<BenchTable> measure(const BenchScene& scene, double seconds_each) {
    BenchTable table{scene, {}};
    for (const double mesh_size : scene.mesh_sizes) {
        FEELER_TRY(const auto points_a, points_of(scene.a, mesh_size));
        FEELER_TRY(const auto points_b, points_of(scene.b, mesh_size));
        FEELER_TRY(const Contestant paper, contestant(core::paper_engine(), points_a, points_b));
        FEELER_TRY(const Contestant fast, contestant(core::fast_engine(), points_a, points_b));
        for (const BenchPlace& place : scene.places) {
            FEELER_TRY(const BenchAnswer by_paper, answer(paper, place.a_from_b, seconds_each));
            FEELER_TRY(const BenchAnswer by_fast, answer(fast, place.a_from_b, seconds_each));
            table.rows.push_back(
                {mesh_size, points_a.size(), points_b.size(), place.separation, by_paper, by_fast});
        }
    }
    return table;
}

} // namespace app
