#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/library/store/database.h"
#include "app/library/store/shard_number.h"

namespace app {

/// Where results of a folder's programs are kept unless another place is named. A share of a batch
/// has one of its own: machines with one disk need not write to one file.
std::string default_store_path(const std::string& folder, const std::optional<ShardId>& share = {});

/// The other databases of the same folder: of the whole batch, and of shares.
std::vector<std::string> stores_beside(const std::string& path);

/// The databases of the nearest folder above a program that has any; empty if none has.
std::vector<std::string> stores_above(const std::string& program);

/// Opens the database that results are kept in, and makes it where there is none: its tables, and
/// the folder `.feeler` that it lies in by default. A file that may not be written is opened all
/// the same; changes of it then fail. One that is opened to be read only is never changed, not even
/// to take back what a process that was killed had begun.
///
/// Errors: io, with the file; unsupported for a database of another program or of a newer version.
core::Result<Database> open_store_file(const std::string& path,
                                       Database::Access access = Database::Access::read_write,
                                       std::shared_ptr<RetryBudget> retries = nullptr);

} // namespace app
