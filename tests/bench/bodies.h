#pragma once

#include "core/geom/mesh.h"
#include "core/geom/primitive.h"
#include "tests/bench/contestant.h"

namespace bench {

/// The boundary points of a body, scanned at this spacing.
Points scanned(const core::Primitive& body, double spacing);
Points scanned(const core::Mesh& body, double spacing);

/// A beaker about Z, 60 mm high: bore 32 mm wide and 55 mm deep, wall of 4 mm.
core::Mesh cup_mesh();

/// A pin about Z, 70 mm long, 28 mm thick, its lower end chamfered.
core::Mesh pin_mesh();

/// A lump like a casting or an organic scan: a ball of about 50 mm with bumps of three sizes.
/// `seed` varies the bumps.
core::Mesh lump_mesh(double seed);

/// A spur gear about Z: 24 teeth, 52 mm across, 12 mm thick.
core::Mesh gear_mesh();

} // namespace bench
