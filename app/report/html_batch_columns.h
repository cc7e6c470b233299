#pragma once

#include <string>

#include "app/batch/batch_result.h"

namespace app {

/// All programs of a batch as columns, for the script of its page: a JSON object. Programs that
/// were not checked stand behind the others.
///
/// Units:  um, ms and mm3, as integers; a lower bound is rounded down and an upper one up.
/// Result: at most some 18 MB, however much was found: of a program that found very much, only
///         some of its worst findings are there; `tally` counts all.
/// Cost:   linear; each different text once.
std::string batch_columns_json(const BatchResult& batch);

} // namespace app
