#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace app {

/// Shard i of n, written 2/8. Shards count from 1.
struct ShardId {
    size_t i = 1, n = 1;

    bool operator==(const ShardId&) const = default;
};

std::string text_of(const ShardId& shard);

/// Parses I/N.
///
/// Errors: a text that is not I/N, or I outside 1..N.
core::Result<ShardId> shard_named(const std::string& text);

/// The sorted indices of the programs of a shard. Depends only on the sizes and their order, so all
/// computers agree: in order of decreasing size, each program goes to the shard with the fewest
/// bytes so far.
std::vector<size_t> indices_of_shard(std::span<const uintmax_t> sizes, const ShardId& shard);

} // namespace app
