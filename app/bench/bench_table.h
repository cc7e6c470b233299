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

} // namespace app
