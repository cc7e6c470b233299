#pragma once

#include <vector>

#include "app/bench/bench_table.h"

namespace app {

/// What a scene takes at one mesh size, over all its places.
struct BenchMeans {
    double mesh_size = 0.0;
    size_t points = 0; // of A
    double error_percent = 0.0;
    double sphere_tests = 0.0, point_tests = 0.0; // of the paper's engine
    double paper_seconds = 0.0, fast_seconds = 0.0;
    double ratio = 0.0; // geometric mean
};

/// One for each mesh size of the table, in its order.
std::vector<BenchMeans> means_of(const BenchTable& table);

/// The straight line y = start + slope * x that lies nearest to some points.
struct LineFit {
    double start = 0.0;
    double slope = 0.0;
    double r_squared = 0.0; // how much of the spread of y it explains, 0..1
};

/// The fit of least squares; there must be two points with different x at least.
LineFit line_fit(const std::vector<double>& x, const std::vector<double>& y);

/// The time of the paper's engine, s, against the points of one body.
LineFit time_by_points(const std::vector<BenchMeans>& means);

} // namespace app
