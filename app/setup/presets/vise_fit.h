#pragma once

#include "app/setup/presets/preset.h"
#include "core/base/vec.h"

namespace app {

/// Where a vise must be, and how far open, to hold a part.
struct ViseFit {
    core::Vec3 at;        // of the vise, mm, in the frame of the part
    double opening = 0.0; // mm
};

/// Clamps a box: the fixed jaw is at its +Y face, the moving jaw at its -Y face, the vise in the
/// middle of its X. Turned by quarter turns about Z, the fixed jaw is at the -X, -Y, +X face.
///
/// `depth`: how far it reaches down into the jaws, mm, at most their height. With the height of the
///          jaws it lies on the bed, with less on parallels.
/// `values`: of the vise; its `opening` does not matter.
/// Errors:  invalid_value: the box is too wide for the vise, or does not reach into the jaws.
core::Result<ViseFit> vise_around(const Preset& vise, const PresetValues& values,
                                  const core::Aabb& box, double depth, int quarter_turns = 0);

} // namespace app
