#pragma once

#include <string>
#include <vector>

#include "app/library/find/folder_walk.h"
#include "app/library/result/program_result.h"

namespace app {

/// The result of a batch. A plain value from which all reports are made.
struct BatchResult {
    std::vector<ProgramResult> programs; // in the order of the arguments
    std::vector<std::string> unchecked;  // programs not finished because the batch was stopped
    std::vector<SkippedFile> skipped;    // files that are not NC programs
    std::string shard = {};    // such as "shard 2/8: 13 of 104 programs"; empty: the whole batch
    FileBytes file_bytes = {}; // of unchecked and skipped files; see ProgramResult
};

/// The exit status of a batch: 2 if any program could not be run to its end or was not checked,
/// else 1 if any has an error, else 0.
int status_of(const BatchResult& batch);

/// The number of findings of a severity.
size_t count_of(const ProgramResult& result, core::Severity severity);

/// The outcome of a program in a batch, from best to worst.
enum class Outcome : uint8_t {
    clear,
    no_error,  // clear as far as it was checked, but the set-up does not describe everything
    no_motion, // nothing moves, so nothing was checked
    undecided,
    errors, // clearances are sufficient, but there is another error
    violation,
    collision,
    stopped,
    not_run, // stopped before the first block
    unchecked
};

inline constexpr std::array all_outcomes = {
    Outcome::clear,   Outcome::no_error,  Outcome::no_motion, Outcome::undecided,
    Outcome::errors,  Outcome::violation, Outcome::collision, Outcome::stopped,
    Outcome::not_run, Outcome::unchecked};

/// The name of an outcome in lower case, such as "not run".
const char* name_of(Outcome outcome);

/// The outcome of a program that was checked completely or in part.
Outcome outcome_of(const ProgramResult& result);

} // namespace app
