#pragma once

#include <cstdint>
#include <vector>

#include "app/bench/bench_scene.h"

namespace app {

/// The result of an engine, and its cost.
struct EngineResult {
    double distance = 0.0;   // mm, between the closest points
    uint64_t node_tests = 0; // sphere tests or box tests
    uint64_t point_tests = 0;
    double seconds = 0.0; // CPU time of one query
};

/// One pose of a scene at one mesh size.
struct BenchRow {
    double mesh_size = 0.0; // mm
    size_t points_a = 0, points_b = 0;
    double separation = 0.0; // mm, between the surfaces
    EngineResult paper, fast;

    double error_percent() const { return 100.0 * (paper.distance - separation) / separation; }
    double ratio() const { return paper.seconds / fast.seconds; }
    bool same_answer() const { return paper.distance == fast.distance; }
};

/// A scene with its rows: by mesh size, then by pose.
struct BenchTable {
    BenchScene scene;
    std::vector<BenchRow> rows;
};

/// Measures every pose of a scene with both engines, with one thread and without an initial guess.
///
/// Result: the seconds are the minimum of at least one run; all runs together take about
///         `seconds_each`. Nothing else depends on the machine.
/// Errors: those of scanning the bodies.
core::Result<BenchTable> measure(const BenchScene& scene, double seconds_each = 0.01);

/// Means over all poses of a scene at one mesh size.
struct BenchAverages {
    double mesh_size = 0.0;
    size_t points = 0; // of A
    double error_percent = 0.0;
    double sphere_tests = 0.0, point_tests = 0.0; // in the paper's engine
    double paper_seconds = 0.0, fast_seconds = 0.0;
    double ratio = 0.0; // geometric mean
};

/// The means for each mesh size of the table, in its order.
std::vector<BenchAverages> averages_of(const BenchTable& table);

/// The straight line y = start + slope * x that best fits some points.
struct LineFit {
    double start = 0.0;
    double slope = 0.0;
    double r_squared = 0.0; // coefficient of determination, 0..1
};

/// The least-squares fit; at least two points must differ in x.
LineFit line_fit(const std::vector<double>& x, const std::vector<double>& y);

/// The fit of the paper's engine's time, s, over the number of points of one body.
LineFit time_by_points(const std::vector<BenchAverages>& means);

} // namespace app
