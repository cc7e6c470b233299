#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/sim/finding.h"
#include "core/sim/verdict.h"

namespace app {

struct CheckJob;
struct CheckRun;

/// The bytes of names of files that are no UTF-8, by the texts that stand for them in results.
using FileBytes = std::map<std::string, std::string>;

/// The text that stands for a name, whose bytes are kept where they are others.
std::string shown_name(const std::string& path, FileBytes& bytes);

/// The name that a text stands for.
const std::string& name_shown_as(const std::string& text, const FileBytes& bytes);

/// A finding as it is kept when the run is gone.
struct StoredFinding {
    std::string rule;
    core::Severity severity = core::Severity::warning;
    std::optional<uint32_t> block; // empty: the program as a whole
    uint32_t line = 0;             // of the block; 0 if there is none
    std::string file;              // of a subprogram's; empty for the main program
    std::string text;              // of the block
    std::string message, cure;
    std::array<std::string, 2> pair{};
    double shortfall = 0.0; // mm

    bool operator==(const StoredFinding&) const = default;
};

/// The block with the least margin, and what is known of it. mm.
struct Tightest {
    uint32_t block = 0, line = 0;
    std::array<std::string, 2> pair{};
    double lower = 0.0;
    std::optional<double> upper;
    double allowance = 0.0;

    bool operator==(const Tightest&) const = default;
};

/// Why a program could not be run, or not to its end.
struct StoredError {
    std::string file;              // empty if it is about none
    uint32_t line = 0, column = 0; // in characters
    std::string message;

    bool operator==(const StoredError&) const = default;
};

/// What is kept of one program of a library: all that summaries, other systems and later versions
/// are told. A plain value; the same for the same content, but for `seconds`. Texts are UTF-8.
struct ProgramResult {
    std::string program; // its path, as it was found
    std::string setup;   // its set-up's; empty: it was inferred
    std::string sha256;  // of the program; empty if it could not be read
    std::string dialect; // empty if nobody knows
    std::string engine;  // "exact" or "coprocessor"
    core::Verdict verdict = core::Verdict::undecided;
    std::optional<StoredError> error;
    std::vector<StoredFinding> findings;
    std::vector<std::string> assumptions;
    size_t blocks = 0;
    double cycle_time = 0.0; // seconds
    double removed = 0.0;    // mm3
    std::optional<Tightest> tightest;
    double seconds = 0.0;      // of wall time that the check took
    FileBytes file_bytes = {}; // of the names of files in it that are no UTF-8

    bool operator==(const ProgramResult&) const = default;
};

/// What is kept of a check.
ProgramResult result_of(const CheckRun& run, const std::string& setup);

/// What is kept of one that could not begin.
ProgramResult failed_result(const CheckJob& job, const core::Error& error);

/// As the exit status of `feeler check` says it: 0 nothing found, 1 an error found, 2 not run to
/// its end.
int status_of(const ProgramResult& result);

/// As a JSON object on one line, and back. Numbers come back to the last bit.
///
/// Errors: text that is no such object.
std::string json_of(const ProgramResult& result);
core::Result<ProgramResult> result_from_json(const std::string& text);

} // namespace app
