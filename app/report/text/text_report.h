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
    size_t width = 80;                               // columns of a line
    bool colour = false;                             // of severities and the headline
};

/// The report of a check as text: findings first, then the headline with what was not checked.
std::string text_report(const CheckRun& run, const TextOptions& options);

/// "1 error, 2 warnings, 0 notes". Findings without a pair of bodies that say the same have one
/// cause and count once. A program that stopped has at least one error.
std::string counts_text(const CheckRun& run);

/// An error as `file:line:column: message`.
std::string error_text(const core::Error& error);

} // namespace app
