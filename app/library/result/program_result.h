#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/setup/coverage.h"
#include "core/base/result.h"
#include "core/sim/finding.h"
#include "core/sim/verdict.h"

namespace app {

struct CheckJob;
struct CheckRun;

/// The bytes of file names that are not UTF-8, by the text used for them in results.
using FileBytes = std::map<std::string, std::string>;

/// The UTF-8 text of a file name. Records the bytes of the name if they differ.
std::string shown_name(const std::string& path, FileBytes& bytes);

/// The file name for a text made by shown_name.
const std::string& name_shown_as(const std::string& text, const FileBytes& bytes);

/// A finding with the line and text of its block, because a stored result has no blocks. Texts are
/// UTF-8.
struct StoredFinding : core::Finding {
    uint32_t line = 0; // of the block; 0 if there is none
    std::string file;  // of a subprogram; empty for the main program
    std::string text;  // of the block

    bool operator==(const StoredFinding&) const = default;
};

/// The block with the least margin and its clearance, mm.
struct Tightest {
    uint32_t block = 0, line = 0;
    std::array<std::string, 2> pair{};
    double lower = 0.0;
    std::optional<double> upper;
    double allowance = 0.0;

    bool operator==(const Tightest&) const = default;
};

/// Why a program could not be run to its end.
struct StoredError {
    std::string file;              // empty if the error is not about a file
    uint32_t line = 0, column = 0; // column in characters
    std::string message;

    bool operator==(const StoredError&) const = default;
};

/// The stored result of one program: everything that summaries, exchange formats and comparisons
/// with later versions need. Depends only on the inputs, except `seconds`. Texts are UTF-8.
struct ProgramResult {
    std::string program; // path as found
    std::string setup;   // path of the set-up; empty: inferred
    std::string sha256;  // of the program; empty if it could not be read
    std::string dialect; // empty if unknown
    std::string engine;  // "exact" or "coprocessor"
    core::Verdict verdict = core::Verdict::undecided;
    std::optional<Coverage> coverage; // empty: not checked, or by an older version
    std::optional<StoredError> error;
    std::vector<StoredFinding> findings;
    std::vector<std::string> assumptions;
    size_t blocks = 0;
    double cycle_time = 0.0; // seconds
    double removed = 0.0;    // mm3
    std::optional<Tightest> tightest;
    double seconds = 0.0;      // wall time of the check
    FileBytes file_bytes = {}; // for file names in the result that are not UTF-8

    bool operator==(const ProgramResult&) const = default;
};

/// Whether the tightest block only shows that bodies touch that may: the program has no clearance
/// that says more.
bool has_only_contact(const ProgramResult& result);

/// The stored result of a check.
ProgramResult result_of(const CheckRun& run, const std::string& setup);

/// The stored result of a check that could not start.
ProgramResult failed_result(const CheckJob& job, const core::Error& error);

/// The exit status of `feeler check`: 0 no error, 1 at least one error, 2 not run to its end.
int status_of(const ProgramResult& result);

/// The verdict in words that say no more than was checked; see headline_of in coverage.h.
std::string headline_of(const ProgramResult& result);

/// What was not checked of a program, as uncovered_text; empty if the set-up describes everything
/// or the program was not run.
std::string uncovered_text(const ProgramResult& result);

/// Converts a result to a JSON object on one line, and back. Numbers are preserved to the last bit.
///
/// Errors: a text that is not such an object.
std::string json_of(const ProgramResult& result);
core::Result<ProgramResult> result_from_json(const std::string& text);

} // namespace app
