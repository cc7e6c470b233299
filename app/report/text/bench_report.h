#pragma once

#include <string>
#include <vector>

#include "app/bench/bench_scene.h"
#include "app/bench/bench_table.h"

namespace app {

/// The tables of `feeler bench paper` as text; the first is the paper's.
std::string text_bench(const std::vector<BenchTable>& tables);

/// The tables as one CSV table: a row for each engine in each case.
std::string csv_bench(const std::vector<BenchTable>& tables);

/// The answer to `feeler distance` as JSON.
std::string json_distance(const BodyPairDistance& found);

/// The answer to `feeler distance` as text; for a sweep, with the position along it.
std::string text_distance(const BodyPairDistance& found, const std::string& a, const std::string& b,
                          bool swept);

} // namespace app
