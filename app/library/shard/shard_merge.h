#pragma once

#include "app/library/shard/shard.h"

namespace app {

/// What one run of the whole batch would have given. Programs that a shard was stopped before stay
/// unchecked; of the skipped files those are named that all have seen.
///
/// Errors: with the names of the files: shards of different batches, or of different states of
///         their files; one that is there twice or is missing; one that lacks a program's result or
///         has another's.
core::Result<BatchResult> merged(std::vector<Shard> shards);

} // namespace app
