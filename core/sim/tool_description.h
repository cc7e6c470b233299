#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/base/result.h"
#include "core/motion/event.h"

namespace core {

enum class ToolShape : uint8_t {
    flat,
    ball,
    bull,
    drill,
    taper,
    chamfer,
    tslot,
    dovetail,
    lollipop,
    threadmill,
    profile
};

const char* name_of(ToolShape shape);

/// The shape of that name; empty when there is none.
std::optional<ToolShape> tool_shape_named(const std::string& name);

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
    std::optional<double> corner_radius;        // bull, taper, chamfer, tslot, dovetail
    std::optional<double> point_deg;            // drill: full angle of the point, 118 if absent
    std::optional<double> angle_deg;            // taper, chamfer, dovetail: flank from the axis
    double tip_diameter = 0.0;                  // taper, chamfer: where the corner's rounding ends
    std::vector<std::array<double, 2>> outline; // profile: r, z from the tip up
    std::optional<double> neck_diameter;        // all but profile: what is slender above the flutes
    std::optional<double> neck_length;
    std::optional<double> pitch;      // threadmill
    std::optional<int> teeth;         // threadmill: rows of teeth; as many as fit if absent
    std::optional<double> thread_deg; // threadmill: full angle of the thread, 60 if absent
    std::vector<ConeStep> shank, holder;
    std::optional<double> shank_diameter; // of the cylinder that fills a stick-out
    std::optional<double> stick_out;      // tip to the holder's face
    std::optional<double> gauge_length;   // tip to the gauge line
    std::optional<double> touched_off;    // what the control takes its length for, and rightly so
    SpindleDirection cuts = SpindleDirection::clockwise;
    bool cuts_at_centre = true;
    double centre_radius = 0.0; // up to here it does not cut when it goes straight down
};

/// An error that names the tool.
tl::unexpected<Error> tool_error(const ToolDescription& tool, const std::string& why);

/// Looks at every size by itself: it must be a length or angle that a tool can have, and mean
/// something for the shape.
///
/// Errors: invalid_value, naming the tool and the key.
Result<void> check_keys(const ToolDescription& tool);

} // namespace core
