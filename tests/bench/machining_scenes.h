#pragma once

#include <vector>

#include "core/dbm/cut_model.h"
#include "core/geom/profile.h"
#include "hwsim/driver.h"

namespace bench {

/// A tool above a stock, and its path.
struct MachiningScene {
    const char* name;
    core::RevolvedProfile body;
    core::CutModel stock;
    std::vector<hwsim::PathSegment> segments; // one after the other, without their pair
    double keep = 1.0;                        // mm
};

/// The scenes of the tables in hwsim/README.md, at h = 0.5.
///
/// facing:    a holder 1.2 mm above a flat face, in steps of 0.5 mm
/// pocket:    a collar of 25 mm in a round pocket of 29 mm, 1 mm from its wall almost all around
/// finishing: a slim shank above a ball that finishes a wavy surface, above the finished part
std::vector<MachiningScene> machining_scenes();

} // namespace bench
