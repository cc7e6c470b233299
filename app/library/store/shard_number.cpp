#include "app/library/store/shard_number.h"

#include <algorithm>
#include <charconv>
#include <numeric>

#include <fmt/format.h>

namespace app {
namespace {

constexpr size_t most_shards = 1'000'000;

} // namespace

std::string text_of(const ShardId& shard) { return fmt::format("{}/{}", shard.i, shard.n); }

core::Result<ShardId> shard_named(const std::string& text) {
    ShardId shard{0, 0};
    const char* const end = text.data() + text.size();
    const auto [slash, wrong] = std::from_chars(text.data(), end, shard.i);
    if (wrong == std::errc() && slash != end && *slash == '/') {
        const auto [last, also_wrong] = std::from_chars(slash + 1, end, shard.n);
        if (also_wrong == std::errc() && last == end && shard.i >= 1 && shard.i <= shard.n
            && shard.n <= most_shards)
            return shard;
    }
    return core::fail(core::ErrorCode::invalid_value,
                      fmt::format("'{}' is not a shard: write I/N, as in 2/8 (N is at most {})",
                                  text, most_shards));
}

std::vector<size_t> indices_of_shard(std::span<const uintmax_t> sizes, const ShardId& shard) {
    std::vector<size_t> largest_first(sizes.size());
    std::iota(largest_first.begin(), largest_first.end(), size_t(0));
    std::stable_sort(largest_first.begin(), largest_first.end(),
                     [&](size_t a, size_t b) { return sizes[a] > sizes[b]; });
    using Load =
        std::pair<uintmax_t, size_t>; // bytes and number of the shard; the number breaks ties
    std::vector<Load> loads;          // a heap with the least load on top
    for (size_t each = 1; each <= shard.n; ++each) loads.push_back({0, each});
    std::vector<size_t> mine;
    for (const size_t index : largest_first) {
        std::pop_heap(loads.begin(), loads.end(), std::greater<>());
        // An empty file is some work, too.
        loads.back().first += std::max<uintmax_t>(sizes[index], 1);
        if (loads.back().second == shard.i) mine.push_back(index);
        std::push_heap(loads.begin(), loads.end(), std::greater<>());
    }
    std::sort(mine.begin(), mine.end());
    return mine;
}

} // namespace app
