#pragma once

#include <string>
#include <vector>

#include "app/bench/bench_scene.h"
#include "app/bench/bench_table.h"

namespace app {

/// The tables of `feeler bench paper` for a person: the first one is that of the paper.
std::string text_bench(const std::vector<BenchTable>& tables);

/// The same as one table for a script: a row for each engine in each place.
std::string csv_bench(const std::vector<BenchTable>& tables);

/// The answer to `feeler distance` as JSON.
std::string json_distance(const BodyPairDistance& found);

/// The same for a person; of a sweep, it says when.
std::string text_distance(const BodyPairDistance& found, const std::string& a, const std::string& b,
                          bool swept);

} // namespace app
