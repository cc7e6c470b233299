#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace app {

/// Which share of how many; written as 2/8. Shares count from 1.
struct ShardId {
    size_t i = 1, n = 1;

    bool operator==(const ShardId&) const = default;
};

std::string text_of(const ShardId& share);

/// Errors: a text that is no share, or one of none.
core::Result<ShardId> share_named(const std::string& text);

/// The places in a list of the programs that a share has, sorted. It depends on the sizes and their
/// order alone, so every machine comes to the same: the largest first, each to the share that has
/// the least so far.
std::vector<size_t> share_of(std::span<const uintmax_t> sizes, const ShardId& share);

} // namespace app
