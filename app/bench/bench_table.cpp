#include "app/bench/bench_table.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "core/base/math.h"
#include "core/base/platform.h"
#include "core/distance/distance_engine.h"

namespace app {
namespace {

/// An engine with both bodies of a scene loaded.
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

core::Result<EngineResult> answer(const Contestant& by, const core::Transform& a_from_b,
                                  double seconds_each) {
    EngineResult answer{.seconds = core::infinity};
    double spent = 0.0;
    do {
        const double start = core::platform::thread_cpu_seconds();
        FEELER_TRY(const core::ClosestPair pair, by.engine->closest_pair(by.a, by.b, a_from_b));
        const double seconds = core::platform::thread_cpu_seconds() - start;
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
        for (const BenchPose& pose : scene.poses) {
            FEELER_TRY(const EngineResult by_paper, answer(paper, pose.a_from_b, seconds_each));
            FEELER_TRY(const EngineResult by_fast, answer(fast, pose.a_from_b, seconds_each));
            table.rows.push_back(
                {mesh_size, points_a.size(), points_b.size(), pose.separation, by_paper, by_fast});
        }
    }
    return table;
}

namespace {

BenchAverages mean_of(const std::vector<BenchRow>& rows, double mesh_size) {
    BenchAverages mean{.mesh_size = mesh_size};
    double count = 0.0, log_ratio = 0.0;
    for (const BenchRow& row : rows) {
        if (row.mesh_size != mesh_size) continue;
        count += 1.0;
        mean.points = row.points_a;
        mean.error_percent += row.error_percent();
        mean.sphere_tests += static_cast<double>(row.paper.node_tests);
        mean.point_tests += static_cast<double>(row.paper.point_tests);
        mean.paper_seconds += row.paper.seconds;
        mean.fast_seconds += row.fast.seconds;
        log_ratio += core::log(row.ratio());
    }
    for (double* sum : {&mean.error_percent, &mean.sphere_tests, &mean.point_tests,
                        &mean.paper_seconds, &mean.fast_seconds})
        *sum /= count;
    mean.ratio = core::exp(log_ratio / count);
    return mean;
}

double mean_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

} // namespace

std::vector<BenchAverages> averages_of(const BenchTable& table) {
    std::vector<BenchAverages> means;
    for (const double mesh_size : table.scene.mesh_sizes)
        means.push_back(mean_of(table.rows, mesh_size));
    return means;
}

LineFit line_fit(const std::vector<double>& x, const std::vector<double>& y) {
    assert(x.size() == y.size() && x.size() >= 2);
    const double mean_x = mean_of(x), mean_y = mean_of(y);
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for (size_t i = 0; i < x.size(); ++i) {
        xx += (x[i] - mean_x) * (x[i] - mean_x);
        xy += (x[i] - mean_x) * (y[i] - mean_y);
        yy += (y[i] - mean_y) * (y[i] - mean_y);
    }
    const double slope = xy / xx;
    return {mean_y - slope * mean_x, slope, yy > 0.0 ? xy * xy / (xx * yy) : 1.0};
}

LineFit time_by_points(const std::vector<BenchAverages>& means) {
    std::vector<double> points, seconds;
    for (const BenchAverages& mean : means) {
        points.push_back(static_cast<double>(mean.points));
        seconds.push_back(mean.paper_seconds);
    }
    return line_fit(points, seconds);
}

} // namespace app
