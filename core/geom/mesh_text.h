#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace core {

/// The vertices and faces of a mesh file in text form, each number known to be one, and nothing
/// else.
struct MeshText {
    std::string text;
    size_t vertices = 0; // of an STL: 0
    size_t faces = 0;
    size_t degenerate_faces = 0; // of an STL: triangles that name a corner twice, kept in `text`
};

/// Check a file word by word and give it back in the plainest form of its format.
///
/// Errors: the line and what is wrong with it: no number, not finite, an index out of range, a
///         facet that is not complete, no end, no faces. Textures, normals, colours and names are
///         left out unread.
Result<MeshText> checked_ascii_stl(std::string_view bytes);
Result<MeshText> checked_obj(std::string_view bytes);
Result<MeshText> checked_off(std::string_view bytes);

/// The same for a PLY file of any of its three forms, up to its last face.
Result<MeshText> checked_ply(std::string_view bytes);

} // namespace core
