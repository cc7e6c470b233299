#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace app {

/// Refuses an option's value that is no finite number from `low` to `high`.
CLI::Validator number_range(double low, double high);

} // namespace app
