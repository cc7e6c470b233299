#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <variant>
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

/// A row of the table of tool shapes.
struct ToolShapeEntry {
    ToolShape shape;
    const char* name;        // `shape` in a set-up
    const char* description; // "a T-slot cutter", for messages
};

/// Every shape, in the order of the enumeration.
std::span<const ToolShapeEntry> tool_shapes();

/// The name of a shape in a set-up: tslot.
const char* name_of(ToolShape shape);

/// A shape in a sentence: a T-slot cutter.
const char* description_of(ToolShape shape);

/// The shape of a name; empty if there is none.
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

/// A set of shapes.
struct ShapeSet {
    uint32_t bits = 0;

    constexpr ShapeSet(std::initializer_list<ToolShape> shapes) {
        for (const ToolShape shape : shapes) bits |= 1U << static_cast<unsigned>(shape);
    }
    constexpr bool contains(ToolShape shape) const {
        return (bits >> static_cast<unsigned>(shape) & 1U) != 0;
    }
};

/// A size of a tool: its key in a set-up, its name in a dialog, and the shapes that have it.
struct ToolSize {
    using Member =
        std::variant<double ToolDescription::*, std::optional<double> ToolDescription::*>;
    enum class Group : uint8_t { diameter, edge, length };

    const char* key;
    const char* name;
    const char* unit; // mm or deg
    Member member;
    Group group;
    ShapeSet shapes;    // in which a set-up may state it
    ShapeSet shown;     // in which a dialog offers it
    ShapeSet zero = {}; // in which 0 is allowed and means that there is none

    /// Empty where it is not stated.
    std::optional<double> of(const ToolDescription& tool) const;
    void put(ToolDescription& tool, std::optional<double> value) const;
};

/// Every size that is a number, in the order in which a set-up file is written.
std::span<const ToolSize> tool_sizes();

/// An error that names the tool.
tl::unexpected<Error> tool_error(const ToolDescription& tool, const std::string& why);

/// Checks each size by itself: a tool of this shape must have it, and it must be in range.
///
/// Errors: invalid_value, naming the tool and the key.
Result<void> check_keys(const ToolDescription& tool);

} // namespace core
