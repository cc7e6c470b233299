#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/library/store/database.h"
#include "app/library/store/shard_number.h"

namespace app {

/// The default database for the programs of a folder. Each shard of a batch has its own, so that
/// computers with a shared disk do not write to the same file.
std::string default_store_path(const std::string& folder, const std::optional<ShardId>& shard = {});

/// The other databases in the same folder: of the whole batch and of shards.
std::vector<std::string> sibling_stores(const std::string& path);

/// The databases in the nearest folder above a program that has any; empty if none has.
std::vector<std::string> stores_above(const std::string& program);

/// Opens the database of results; creates it, its tables and its folder `.feeler` if needed. A
/// write-protected file can be opened, too, but changes then fail. A file opened read-only is never
/// changed, not even to roll back a transaction of a killed process.
///
/// Errors: io, with the file; unsupported for a database of another program or of a newer version.
core::Result<Database> open_store_file(const std::string& path,
                                       Database::Access access = Database::Access::read_write,
                                       std::shared_ptr<RetryBudget> retries = nullptr);

} // namespace app
