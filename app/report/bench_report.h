#pragma once

#include <string>
#include <vector>

#include "app/bench/bench_table.h"

namespace app {

/// The tables of `feeler bench paper` for a person: the first one is that of the paper.
std::string text_bench(const std::vector<BenchTable>& tables);

/// The same as one table for a script: a row for each engine in each place.
std::string csv_bench(const std::vector<BenchTable>& tables);

} // namespace app
