#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geom/mesh.h"

namespace core {

/// Makes a solid of triangles, or says why they are none.
///
/// Result: corners that coincide are shared; triangles that name a corner twice are gone; every
/// edge
///         is passed as often one way as the other; outer shells face outwards, and a shell
///         inside another that faces inwards stays a cavity. Each change but the sharing of
///         corners adds a sentence to `repairs`. Shells may overlap.
/// Errors: no triangles, a coordinate that is not finite or beyond 1e6 mm, open edges (how many,
/// and
///         where one is), a surface with one side only, no volume.
Result<Mesh> checked_solid(Mesh mesh, std::vector<std::string>& repairs);

} // namespace core
