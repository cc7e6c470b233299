#pragma once

#include <cstddef>
#include <string_view>

#include "core/base/result.h"

namespace core {

/// What a binary STL whose bytes are in order holds.
struct StlCount {
    size_t triangles = 0;
    size_t degenerate = 0; // those that name a corner twice
};

/// Whether the bytes have the length that a binary STL states in its own header.
bool has_length_of_binary_stl(std::string_view bytes);

/// Errors: no triangles, a length that is not 84 + 50 n, a coordinate that is not finite.
Result<StlCount> checked_binary_stl(std::string_view bytes);

} // namespace core
