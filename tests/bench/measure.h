#pragma once

#include <benchmark/benchmark.h>

#include "tests/bench/scenes.h"

namespace bench {

/// Measures all queries of a scene with all engines. Their repetitions are shuffled, so that other
/// load on the machine affects all alike.
///
/// Result: to the reporter, under names ROW/POSE/CONTESTANT.
/// Errors: throws when an engine gives another distance than the paper's engine or, if the bodies
///         are small enough, than all pairs of points.
void measure(const Scene& scene, const std::vector<Contestant>& contestants,
             benchmark::BenchmarkReporter& reporter);

} // namespace bench
