#pragma once

#include <string>

#include "app/batch/batch_result.h"

namespace app {

/// How much is said of a batch, and whether in colour.
struct BatchStyle {
    bool colour = false;
    bool quiet = false;   // only programs with an error, and the summary
    bool verbose = false; // also warnings, notes and assumptions, and every skipped file
};

/// The line of a program as it ends, and lines below it that say what was found; empty where the
/// style leaves it out.
std::string program_text(const ProgramResult& result, const BatchStyle& style);

/// The table at the end: verdicts, findings by rule, the slowest, and what was not checked.
/// `seconds` is what all of it took; no word of seconds where it is negative.
std::string batch_summary(const BatchResult& batch, double seconds, const BatchStyle& style);

/// All of it, in the order in which programs were named. Without seconds it depends on nothing but
/// the batch.
std::string batch_text(const BatchResult& batch, const BatchStyle& style);

} // namespace app
