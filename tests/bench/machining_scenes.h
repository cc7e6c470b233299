#pragma once

#include <vector>

#include "core/dbm/cut_model.h"
#include "core/geom/profile.h"
#include "hwsim/driver.h"

namespace bench {

/// A tool over a stock, and where it goes.
struct MachiningScene {
    const char* name;
    core::RevolvedProfile body;
    core::CutModel stock;
    std::vector<hwsim::PathSegment> segments; // one after the other, without their pair
    double keep = 1.0;                        // mm
};

/// What the tables of hwsim/README.md are made of, at h = 0.5.
///
/// facing:    a holder 1.2 mm over a flat face, in steps of 0.5 mm
/// pocket:    a collar of 25 mm in a round pocket of 29 mm, a millimetre from its wall nearly all
///            round
/// finishing: a slim shank above a ball that finishes a wavy surface, over what is finished already
std::vector<MachiningScene> machining_scenes();

} // namespace bench
