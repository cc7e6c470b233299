#pragma once

#include <cstdint>
#include <vector>

#include "app/bench/bench_scene.h"

namespace app {

/// What an engine found, and what it took.
struct BenchAnswer {
    double distance = 0.0;   // mm, of the closest pair of points
    uint64_t node_tests = 0; // of spheres, or of boxes
    uint64_t point_tests = 0;
    double seconds = 0.0; // CPU time of one query
};

/// One place of a scene at one mesh size.
struct BenchRow {
    double mesh_size = 0.0; // mm
    size_t points_a = 0, points_b = 0;
    double separation = 0.0; // mm, of the surfaces
    BenchAnswer paper, fast;

    double error_percent() const { return 100.0 * (paper.distance - separation) / separation; }
    double ratio() const { return paper.seconds / fast.seconds; }
    bool same_answer() const { return paper.distance == fast.distance; }
};

/// A scene with its rows: mesh size by mesh size, each place in turn.
struct BenchTable {
    BenchScene scene;
    std::vector<BenchRow> rows;
};

/// Measures every place of a scene by both engines, one thread, without a first guess.
///
/// Result: the seconds are the least of several runs, which together take about `seconds_each`;
///         there is one at least. Nothing else depends on the machine.
/// Errors: those of scanning the bodies.
core::Result<BenchTable> measure(const BenchScene& scene, double seconds_each = 0.01);

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
