#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
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

/// An entry in the table of tool shapes.
struct ToolShapeEntry {
    ToolShape shape;
    const char* name;        // `shape` in a set-up
    const char* description; // "a T-slot cutter", for messages
    // Made to cut undercuts with the upper face or the side of its head.
    bool cuts_undercuts = false;
    bool only_drills = false; // made to be fed along its axis, not sideways
};

/// All shapes, in the order of the enumeration.
std::span<const ToolShapeEntry> tool_shapes();

/// Name of a shape in a set-up, such as `tslot`.
const char* name_of(ToolShape shape);

/// Name of a shape in a sentence, such as "a T-slot cutter".
const char* description_of(ToolShape shape);

/// Whether a tool of this shape is made to cut undercuts.
bool cuts_undercuts(ToolShape shape);

/// Whether a tool of this shape must not be fed sideways.
bool only_drills(ToolShape shape);

/// Shape with this set-up name; empty if there is none.
std::optional<ToolShape> tool_shape_named(const std::string& name);

/// A truncated cone of a shank or holder, on top of the previous one.
struct ConeStep {
    double lower_diameter = 0.0;
    double upper_diameter = 0.0;
    double length = 0.0;
};

double total_length(const std::vector<ConeStep>& steps);

/// A tool as described in a set-up. mm; angles in degrees, as in tool catalogues.
struct ToolDescription {
    ToolNumber number{};
    std::string name;
    ToolShape shape = ToolShape::flat;
    double diameter = 0.0;
    double flute_length = 0.0;
    std::optional<double> corner_radius; // bull, taper, chamfer, tslot, dovetail
    std::optional<double> point_deg;     // drill: included point angle, 118 if absent
    std::optional<double> angle_deg;     // taper, chamfer, dovetail: angle between flank and axis
    double tip_diameter = 0.0;           // taper, chamfer: at the end of the corner radius
    std::vector<std::array<double, 2>> outline; // profile: r, z from the tip up
    std::optional<double> neck_diameter;        // all but profile: relief above the flutes
    std::optional<double> neck_length;
    std::optional<double> pitch;      // threadmill
    std::optional<int> teeth;         // threadmill: number of tooth rows; as many as fit if absent
    std::optional<double> thread_deg; // threadmill: included thread angle, 60 if absent
    std::vector<ConeStep> shank, holder;
    double holder_deviation = 0.0;        // of the holder from the true one, mm
    std::optional<double> shank_diameter; // of the cylinder up to the holder if no shank is given
    std::optional<double> stick_out;      // tip to the holder's lower face
    std::optional<double> gauge_length;   // tip to the gauge line
    std::optional<double> touched_off; // length in the control; correct, the tool was touched off
    bool length_is_guess = false;      // nobody stated the length in the control
    SpindleDirection cuts = SpindleDirection::clockwise;
    bool cuts_at_centre = true;
    double centre_radius = 0.0; // it does not cut within this radius when it plunges
    bool single_point = false;  // a boring bar: it cuts on one side of its axis
    bool is_in_inches = false;  // the unit in which messages show its lengths
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

/// A dimension of a tool: its key in a set-up, its label in a dialog, and the shapes that have it.
struct ToolSize {
    using Member =
        std::variant<double ToolDescription::*, std::optional<double> ToolDescription::*>;
    enum class Group : uint8_t { diameter, edge, length };

    const char* key;
    const char* name;
    const char* unit; // mm or deg
    Member member;
    Group group;
    ShapeSet shapes;    // whose set-up entry may have this key
    ShapeSet shown;     // for which a dialog shows it
    ShapeSet zero = {}; // for which 0 is allowed and means "none"

    bool is_angle() const { return std::string_view(unit) == "deg"; }
    /// The value; empty if it is not given.
    std::optional<double> of(const ToolDescription& tool) const;
    void put(ToolDescription& tool, std::optional<double> value) const;
};

/// All numeric dimensions, in the order in which they are written to a set-up file.
std::span<const ToolSize> tool_sizes();

/// Whether tools of a shape have a dimension, such as &ToolDescription::pitch.
bool has_size(ToolShape shape, ToolSize::Member member);

/// A length of a tool in the unit of its messages, and the name of that unit.
std::string shown(const ToolDescription& tool, double mm);
const char* unit_of(const ToolDescription& tool);

/// An error whose message names the tool.
tl::unexpected<Error> tool_error(const ToolDescription& tool, const std::string& why);

/// Checks each dimension by itself: it must apply to the shape, required ones must be given, and
/// its value must be in range.
///
/// Errors: invalid_value, naming the tool and the key.
Result<void> check_keys(const ToolDescription& tool);

} // namespace core
