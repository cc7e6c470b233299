#pragma once

#include <cstddef>
#include <string_view>

#include "core/base/result.h"

namespace core {

/// What a file whose bytes are in order holds.
struct MeshBytes {
    size_t vertices = 0; // of an STL: 0
    size_t faces = 0;
    size_t degenerate_faces = 0; // of an STL: triangles that name a corner twice
};

/// Whether the bytes have the length that a binary STL states in its own header.
bool has_length_of_binary_stl(std::string_view bytes);

/// Errors: no triangles, a length that is not 84 + 50 n, a coordinate that is not finite.
Result<MeshBytes> checked_binary_stl(std::string_view bytes);

/// Walks through a PLY file of any of its three forms, to its last face.
///
/// Errors: a header that is not understood, a file that ends early, a face of fewer than three
///         corners or with an index out of range, a coordinate that is not finite, no faces.
Result<MeshBytes> checked_ply(std::string_view bytes);

} // namespace core
