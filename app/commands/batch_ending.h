#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "app/commands/check_options.h"
#include "app/commands/read_files.h"
#include "app/report/text/batch_text.h"

namespace app {

struct Shard;

/// Prints text meant for people: to standard output, or to standard error if a report goes to
/// standard output.
struct BatchOutput {
    std::FILE* stream = stdout;
    BatchStyle style;

    void say(const std::string& text) const;
};

/// Chooses the stream for `targets`, and colour if it is a terminal and NO_COLOR is not set.
BatchOutput output_for(const BatchStyle& asked, const std::vector<ReportTarget>& targets);

/// Writes the reports of a batch, each completely or not at all. `shard` (may be null) is the
/// content of reports of format "shard". Never overwrites a file that was read. Prints errors to
/// standard error and returns the exit status.
ExitCode end_batch(const BatchResult& batch, const Shard* shard,
                   const std::vector<ReportTarget>& targets, const BatchOutput& talk,
                   const ReadFiles& read);

} // namespace app
