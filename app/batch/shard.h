#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "app/batch/program_result.h"

namespace app {

/// The places in a list of the programs that share `i` of `n` has, sorted; shares count from 1. It
/// depends on the sizes and their order alone, so every machine comes to the same: the largest
/// first, each to the share that has the least so far.
std::vector<size_t> share_of(std::span<const uintmax_t> sizes, size_t i, size_t n);

/// "2/8": which share of how many.
struct ShareName {
    size_t i = 1, n = 1;

    bool operator==(const ShareName&) const = default;
};

/// Errors: a text that is no share, or one of none.
core::Result<ShareName> share_named(const std::string& text);

/// What one machine has done of a batch.
struct Shard {
    std::string file;    // it was read from; not kept
    std::string version; // of the program that checked
    std::string options; // of the batch
    ShareName share;
    std::vector<std::string> programs; // of the whole batch, in their order
    std::vector<size_t> places;        // of the results in that list
    std::vector<ProgramResult> results;

    bool operator==(const Shard&) const = default;
};

/// As a JSON object, an entry to a line, and back.
///
/// Errors: text that is no such object.
std::string json_of(const Shard& shard);
core::Result<Shard> shard_from_json(const std::string& text);

/// The results of all shares in the order of the whole list: what one run would have given.
///
/// Errors: with the names of the files: shares of different batches, one that is there twice or is
///         missing, one that lacks a program's result or has another's.
core::Result<std::vector<ProgramResult>> merged(std::vector<Shard> shards);

} // namespace app
