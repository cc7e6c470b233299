#pragma once

#include <optional>
#include <string>

#include "app/batch/database.h"

namespace app {

/// Where results of a folder's programs are kept unless another place is named.
std::string default_store_path(const std::string& folder);

/// The database of the nearest folder above a program that has one; empty if none has.
std::optional<std::string> store_above(const std::string& program);

/// Opens the database that results are kept in, and makes it where there is none: its tables, and
/// the folder `.feeler` that it lies in by default. A file that may not be written is opened all
/// the same; changes of it then fail.
///
/// Errors: io, with the file; unsupported for a database of another program or of a newer version.
core::Result<Database> open_store_file(const std::string& path);

} // namespace app
