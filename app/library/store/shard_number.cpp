#include "app/library/store/shard_number.h"

#include <algorithm>
#include <charconv>
#include <numeric>

#include <fmt/format.h>

namespace app {
namespace {

constexpr size_t most_shares = 1'000'000;

} // namespace

std::string text_of(const ShardId& share) { return fmt::format("{}/{}", share.i, share.n); }

core::Result<ShardId> share_named(const std::string& text) {
    ShardId share{0, 0};
    const char* const end = text.data() + text.size();
    const auto [slash, wrong] = std::from_chars(text.data(), end, share.i);
    if (wrong == std::errc() && slash != end && *slash == '/') {
        const auto [last, also_wrong] = std::from_chars(slash + 1, end, share.n);
        if (also_wrong == std::errc() && last == end && share.i >= 1 && share.i <= share.n
            && share.n <= most_shares)
            return share;
    }
    return core::fail(core::ErrorCode::invalid_value,
                      fmt::format("'{}' is not a shard: write I/N, as in 2/8 (N is at most {})",
                                  text, most_shares));
}

std::vector<size_t> share_of(std::span<const uintmax_t> sizes, const ShardId& share) {
    std::vector<size_t> largest_first(sizes.size());
    std::iota(largest_first.begin(), largest_first.end(), size_t(0));
    std::stable_sort(largest_first.begin(), largest_first.end(),
                     [&](size_t a, size_t b) { return sizes[a] > sizes[b]; });
    using Load =
        std::pair<uintmax_t, size_t>; // bytes and number of the shard; the number breaks ties
    std::vector<Load> loads;          // a heap with the least load on top
    for (size_t each = 1; each <= share.n; ++each) loads.push_back({0, each});
    std::vector<size_t> mine;
    for (const size_t place : largest_first) {
        std::pop_heap(loads.begin(), loads.end(), std::greater<>());
        // An empty file is some work, too.
        loads.back().first += std::max<uintmax_t>(sizes[place], 1);
        if (loads.back().second == share.i) mine.push_back(place);
        std::push_heap(loads.begin(), loads.end(), std::greater<>());
    }
    std::sort(mine.begin(), mine.end());
    return mine;
}

} // namespace app
