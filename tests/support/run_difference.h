#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/support/plain_command.h"

namespace test_support {

/// A difference between two runs of a program.
struct RunDifference {
    size_t line = 0;       // of the program in the reference; 0: only in our run
    std::string what;      // a word: end, feed, line, kind, refusal ...
    std::string reference; // the command, or the reason for refusal
    std::string ours;
};

/// The comparison of two runs.
struct RunComparison {
    size_t equal = 0; // commands
    size_t total = 0; // compared commands of the reference
    std::vector<RunDifference> differences;
};

/// Compares our run of a program with the reference: lengths to a millionth of a millimetre, values
/// that the reference only prints to the digits printed. `accepted_refusals` are parts of messages
/// with which the reference may refuse a line that we accept.
RunComparison compare_runs(const PlainRun& reference, const PlainRun& ours,
                           const std::vector<std::string>& accepted_refusals);

/// The differences with their program lines, as text.
std::string report_of(const RunComparison& comparison, const std::string& program);

} // namespace test_support
