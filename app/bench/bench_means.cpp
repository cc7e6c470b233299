#include "app/bench/bench_means.h"

#include <cassert>
#include <cmath>
#include <numeric>

namespace app {
namespace {

BenchMeans mean_of(const std::vector<BenchRow>& rows, double mesh_size) {
    BenchMeans mean{.mesh_size = mesh_size};
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
        log_ratio += std::log(row.ratio());
    }
    for (double* sum : {&mean.error_percent, &mean.sphere_tests, &mean.point_tests,
                        &mean.paper_seconds, &mean.fast_seconds})
        *sum /= count;
    mean.ratio = std::exp(log_ratio / count);
    return mean;
}

double mean_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

} // namespace

std::vector<BenchMeans> means_of(const BenchTable& table) {
    std::vector<BenchMeans> means;
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

LineFit time_by_points(const std::vector<BenchMeans>& means) {
    std::vector<double> points, seconds;
    for (const BenchMeans& mean : means) {
        points.push_back(static_cast<double>(mean.points));
        seconds.push_back(mean.paper_seconds);
    }
    return line_fit(points, seconds);
}

} // namespace app
