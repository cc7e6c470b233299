#pragma once

#include <string>
#include <vector>

#include "app/batch/folder_walk.h"
#include "app/batch/program_result.h"

namespace app {

/// What became of a batch. A plain value: reports are made of it alone.
struct BatchResult {
    std::vector<ProgramResult> programs; // in the order in which they were named
    std::vector<std::string> unchecked;  // programs that it was stopped before or in
    std::vector<SkippedFile> skipped;    // files that are no NC programs
    std::string share = {};    // of a batch, as "share 2/8: 13 of 104 programs"; empty: it is whole
    FileBytes file_bytes = {}; // of what was not checked or skipped, as those of a ProgramResult
};

/// The exit status of all: 2 if any program could not be run to its end or was not checked, else 1
/// if any has an error, else 0.
int status_of(const BatchResult& batch);

/// How many findings of a severity a program has.
size_t count_of(const ProgramResult& result, core::Severity severity);

} // namespace app
