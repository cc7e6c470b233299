#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/support/plain_command.h"

namespace test_support {

/// A place where two runs of a program part.
struct RunDifference {
    size_t line = 0;       // of the program, as the reference has it; 0: only we have it
    std::string what;      // a word: end, feed, line, kind, refusal ...
    std::string reference; // the command, or why it was refused
    std::string ours;
};

/// Two runs laid side by side.
struct RunComparison {
    size_t equal = 0; // commands
    size_t total = 0; // of the reference, as far as it is to be followed
    std::vector<RunDifference> differences;
};

/// How our run of a program differs from the reference's: lengths by more than a millionth of a
/// millimetre, what the reference only prints by more than its digits. `accepted_refusals` are
/// parts of messages with which the reference may refuse a line that we go on with.
RunComparison compare_runs(const PlainRun& reference, const PlainRun& ours,
                           const std::vector<std::string>& accepted_refusals);

/// Differences with the lines of the program that they come from.
std::string report_of(const RunComparison& comparison, const std::string& program);

} // namespace test_support
