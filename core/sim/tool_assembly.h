#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/base/result.h"
#include "core/geom/profile.h"
#include "core/sim/event.h"

namespace core {

enum class ToolShape : uint8_t { flat, ball, bull, drill, taper, chamfer, profile };

/// A truncated cone of a shank or holder, stacked on the one below.
struct ConeStep {
    double lower_diameter = 0.0;
    double upper_diameter = 0.0;
    double length = 0.0;
};

/// What is known about a tool, as written in a set-up. mm; angles in degrees as in tool catalogues.
struct ToolDescription {
    ToolNumber number{};
    std::string name;
    ToolShape shape = ToolShape::flat;
    double diameter = 0.0;
    double flute_length = 0.0;
    std::optional<double> corner_radius;        // bull
    std::optional<double> point_deg;            // drill: full angle of the point, 118 if absent
    std::optional<double> angle_deg;            // taper, chamfer: flank from the axis
    double tip_diameter = 0.0;                  // taper, chamfer
    std::vector<std::array<double, 2>> outline; // profile: r, z from the tip up
    std::vector<ConeStep> shank, holder;
    SpindleDirection cuts = SpindleDirection::clockwise;
    bool cuts_at_centre = true;
};

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
    double length = 0.0;         // gauge length: tip to gauge line, mm
};

/// The solid parts of a tool.
///
/// Errors: invalid_value or missing_value, naming the tool and the key, when the sizes make no
/// tool.
Result<ToolAssembly> assemble(const ToolDescription& description);

} // namespace core
