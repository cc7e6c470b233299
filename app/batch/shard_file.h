#pragma once

#include "app/batch/shard.h"

namespace app {

/// A shard as a JSON object, an entry to a line, and back.
///
/// Errors: unsupported for one that a newer version wrote; syntax for text that is no such object,
///         or not all of one, or whose seal is not that of what stands before it.
std::string json_of(const Shard& shard);
core::Result<Shard> shard_from_json(const std::string& text);

/// An object that lacks its end, with the seal as its last entry: damage shows, and so does an edit
/// by hand. Whoever makes a new seal is not kept from it.
std::string sealed(std::string text);

/// Whether there is a file that begins as a shard does.
bool is_shard_file(const std::string& path);

} // namespace app
