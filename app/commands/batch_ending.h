#pragma once

#include "app/batch/shard.h"
#include "app/commands/batch_talk.h"
#include "app/commands/read_files.h"

namespace app {

/// Writes the reports of a batch, each whole or not at all; `shard`, which may be null, is the one
/// of format "shard". None takes the place of a file that was read. Errors go to standard error.
/// What the process is to end with.
ExitCode end_batch(const BatchResult& batch, const Shard* shard,
                   const std::vector<ReportTarget>& targets, const BatchTalk& talk,
                   const ReadFiles& read);

} // namespace app
