#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/geom/mesh.h"

namespace core {

/// Red, green and blue.
using Colour = std::array<uint8_t, 3>;

/// A binary STL file. `comment` stands in its header, 80 characters of it at most.
///
/// Result: single precision, as the format has it: a corner is off by up to 6e-8 of its coordinate.
std::string stl_bytes(const Mesh& mesh, const std::string& comment);

/// A binary PLY file in double precision. `comments` are lines of its header; `colours`, if there
/// are any, one for each vertex.
std::string ply_bytes(const Mesh& mesh, const std::vector<std::string>& comments,
                      std::span<const Colour> colours = {});

} // namespace core
