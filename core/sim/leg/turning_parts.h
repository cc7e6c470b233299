#pragma once

#include <vector>

#include "core/geom/profile.h"
#include "core/motion/kinematics.h"

namespace core {

/// A part of a body of revolution that is cut or measured on its own while the tool turns: it needs
/// far fewer legs than the whole, because less of it is far from its centre.
struct TurningPart {
    RevolvedProfile profile; // in the frame of the tool
    Mover mover;
};

/// Divides flutes across their axis. Where two parts meet, both extend over the seam, so that one
/// of them covers each cell of columns there, also if it is made slimmer by an error. Everything is
/// within the flutes.
///
/// `mover`: that of the flutes. `cell`: side of the cells, mm.
/// Source:  core/sim/README.md, "Flutes in parts".
std::vector<TurningPart> flute_parts(const RevolvedProfile& flutes, const Mover& mover,
                                     double cell);

/// Divides a shank or a holder in the same way, into few parts, none of which is much longer than
/// wide. The union of the parts is the body.
std::vector<TurningPart> slender_parts(const RevolvedProfile& body, const Mover& mover);

} // namespace core
