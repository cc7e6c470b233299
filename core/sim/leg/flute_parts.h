#pragma once

#include <vector>

#include "core/geom/profile.h"
#include "core/motion/kinematics.h"

namespace core {

/// A part of the flutes that is cut on its own while the tool turns: it needs far fewer legs than
/// the whole, because less of it is far from its centre.
struct FlutePart {
    RevolvedProfile profile; // in the frame of the tool
    Mover mover;
};

/// Divides flutes across their axis. Where two parts meet, both extend over the seam, so that one
/// of them covers each cell of columns there, also if it is made slimmer by an error. Everything is
/// within the flutes.
///
/// `mover`: that of the flutes. `cell`: side of the cells, mm.
/// Source:  core/sim/README.md, "Flutes in parts".
std::vector<FlutePart> flute_parts(const RevolvedProfile& flutes, const Mover& mover, double cell);

} // namespace core
