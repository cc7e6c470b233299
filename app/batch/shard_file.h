#pragma once

#include "app/batch/shard.h"

namespace app {

/// A shard as a JSON object, an entry to a line, and back.
///
/// Errors: unsupported for one that a newer version wrote; syntax for text that is no such object,
///         or not all of one.
std::string json_of(const Shard& shard);
core::Result<Shard> shard_from_json(const std::string& text);

} // namespace app
