#pragma once

#include "core/geom/profile.h"
#include "core/sim/tool_description.h"

namespace core {

/// The end of a tool that its shape describes. Frame: the tip is the origin, the axis is Z.
struct ToolHead {
    RevolvedProfile flutes;
    RevolvedProfile behind;    // what the shape has above the flutes and does not cut
    double length = 0.0;       // from the tip to where the shank begins, mm
    double top_diameter = 0.0; // there
};

/// How far a rounding that had to be made of cones stands off the round, mm.
constexpr double rounding_sag = 0.0025;

/// The head of a tool from its sizes: a surface of revolution, exact but for roundings that the end
/// of the flutes divides, which are cones.
///
/// Errors: invalid_value, naming the tool and the key, when the sizes make no such tool or a size
///         means nothing for the shape.
Result<ToolHead> tool_head(const ToolDescription& tool);

} // namespace core
