#pragma once

#include <string>
#include <vector>

namespace core {
struct Error;
}

namespace app {

struct CheckRun;

/// Options of the text report.
struct TextOptions {
    bool blocks = false;                             // the table of all blocks that move
    std::vector<std::string> shown_assumptions = {}; // assumptions already shown on the terminal
};

/// The report of a check for an 80-column terminal: findings first.
std::string text_report(const CheckRun& run, const TextOptions& options);

/// The verdict of a run, or why there is none.
std::string outcome_text(const CheckRun& run);

/// "1 error, 2 warnings, 0 notes".
std::string counts_text(const CheckRun& run);

/// An error as `file:line:column: message`.
std::string error_text(const core::Error& error);

} // namespace app
