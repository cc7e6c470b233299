#pragma once

#include <benchmark/benchmark.h>

#include "tests/bench/scenes.h"

namespace bench {

/// Measures all that is asked in a scene, each contestant beside the others: their repetitions are
/// shuffled, so that whatever else the machine does hits all alike.
///
/// Result:  to the reporter, under names ROW/POSE/CONTESTANT.
/// Errors:  throws when a contestant gives another distance than the paper's engine, or, where the
///          bodies are small enough, than all pairs of points tried.
void measure(const Scene& scene, const std::vector<Contestant>& contestants,
             benchmark::BenchmarkReporter& reporter);

} // namespace bench
