#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geom/gjk.h"
#include "core/geom/profile.h"
#include "core/sim/tool_description.h"

namespace core {

/// The end of a tool that its shape describes. Frame: the tip is the origin, the axis is Z.
struct ToolHead {
    RevolvedProfile flutes;
    RevolvedProfile above_flutes; // non-cutting part of the shape above the flutes
    double length = 0.0;          // from the tip to the lower end of the shank, mm
    double top_diameter = 0.0;    // at that height, mm
};

/// Largest distance between a rounded edge and the cones that approximate it, mm.
constexpr double rounding_sag = 0.0025;

/// The head of a tool from its dimensions: a surface of revolution. It is exact, except that a
/// rounding that the end of the flutes divides is approximated by cones.
///
/// Errors: invalid_value, naming the tool and the key, if the dimensions are not those of a
///         possible tool or one does not apply to the shape.
Result<ToolHead> tool_head(const ToolDescription& tool);

/// Bodies on the spindle side: parts of the tool, the spindle nose, other machine bodies.
enum class PartKind : uint8_t { flutes, shank, holder, nose, machine };

const char* name_of(PartKind kind);

/// Whether a part belongs to the tool below its holder: it is close to the stock when it cuts.
constexpr bool is_below_holder(PartKind kind) {
    return kind == PartKind::flutes || kind == PartKind::shank;
}

/// One part of a tool assembly. Frame: the tool's tip is the origin, its axis is Z.
struct ToolPart {
    PartKind kind = PartKind::flutes;
    RevolvedProfile profile;
};

/// A tool as mounted in the spindle.
struct ToolAssembly {
    ToolDescription description;
    std::vector<ToolPart> parts; // existing parts, from the flutes up
    double length = 0.0;         // gauge length, mm; if touched off, the length in the control
    double gauge_rise = 0.0;     // gauge line above the point that the control takes for it, mm
    // Nobody stated how far it sticks out, so where the spindle is, is not known.
    bool reach_is_assumed = false;
    // A boring bar whose spindle stands in the direction in which a cycle moves its edge off the
    // wall: the bar alone counts.
    std::shared_ptr<const ToolAssembly> oriented = {};
    // For checks that must hold for a range of tools (docs/decisions/tolerances.md):
    std::optional<RevolvedProfile> certain_flutes = {}; // cut instead of the flutes
    Play holder_play = {}; // of the holder and the spindle against the tip, along Z
};

/// Makes the bodies of a tool. A neck is part of the shank. If no shank is described, a cylinder
/// reaches up to the stick-out; if no holder is described, there is none, and only the gauge length
/// is used.
///
/// Errors: invalid_value, naming the tool and the key, if the dimensions are not those of a
///         possible tool or contradict each other by more than 0.001 mm.
Result<ToolAssembly> assemble(const ToolDescription& description);

} // namespace core
