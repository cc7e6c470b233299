#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace app {

/// Which items of one list go with which of another: pairs of places with equal items, rising in
/// both. As many as there can be, or nearly, where the lists have little in common.
///
/// Cost:   the length times the number of differences, up to a bound; memory grows with the length.
/// Source: Myers, An O(ND) difference algorithm and its variations, 1986: the linear-space form.
std::vector<std::pair<size_t, size_t>> aligned(std::span<const uint32_t> a,
                                               std::span<const uint32_t> b);

} // namespace app
