#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "app/commands/check_options.h"
#include "app/commands/read_files.h"
#include "app/report/text/batch_text.h"

namespace app {

struct Shard;

/// Prints lines for a person: to standard output unless a report goes there.
struct BatchTalk {
    std::FILE* stream = stdout;
    BatchStyle style;

    void say(const std::string& text) const;
};

/// Coloured on a terminal, unless NO_COLOR is set.
BatchTalk talk_of(const BatchStyle& asked, const std::vector<ReportTarget>& targets);

/// Writes the reports of a batch, each completely or not at all; `shard`, which may be null, is the
/// report of format "shard". Never overwrites a file that was read. Prints errors to standard error
/// and returns the exit status.
ExitCode end_batch(const BatchResult& batch, const Shard* shard,
                   const std::vector<ReportTarget>& targets, const BatchTalk& talk,
                   const ReadFiles& read);

} // namespace app
