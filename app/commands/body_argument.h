#pragma once

#include <string>
#include <vector>

#include "app/session/body_pair.h"

namespace app {

/// A body as named on the command line.
struct NamedBody {
    std::string name;
    MeasuredBody body;
    std::vector<std::string> repairs; // of its mesh
};

/// Reads `sphere:R`, `box:X,Y,Z`, `cylinder:R,H` (axis Z), centred on the origin, or a mesh file.
///
/// Errors: sizes that are not positive lengths, and those of read_mesh.
core::Result<NamedBody> body_argument(const std::string& argument);

} // namespace app
