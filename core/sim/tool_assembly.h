#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
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

/// What moves on the tool's side: parts of the tool, the spindle's nose, and the rest of the
/// machine.
enum class PartKind : uint8_t { flutes, shank, holder, nose, machine };

const char* name_of(PartKind kind);

/// One part of a tool assembly. Frame: the tool's tip is the origin, its axis is Z.
struct ToolPart {
    PartKind kind = PartKind::flutes;
    RevolvedProfile profile;
};

/// A tool as it stands in the spindle.
struct ToolAssembly {
    ToolDescription description;
    std::vector<ToolPart> parts; // those that exist, from the flutes up
    double length = 0.0; // gauge length: tip to gauge line, mm; as stated if it was touched off
};

/// The solid parts of a tool. A neck is part of the shank. A shank that is not described fills the
/// stick-out; a holder that is not described leaves nothing but the gauge length.
///
/// Errors: invalid_value, naming the tool and the key, when the sizes make no tool or contradict
///         each other by more than 0.001 mm.
Result<ToolAssembly> assemble(const ToolDescription& description);

} // namespace core
