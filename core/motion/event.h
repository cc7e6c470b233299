#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "core/base/ids.h"
#include "core/base/vec.h"

namespace core {

/// X Y Z, the rotary axes A B C and the secondary axes U V W, always in this order.
constexpr size_t axis_count = 9;
constexpr std::string_view axis_letters = "XYZABCUVW";

constexpr bool is_rotary(size_t axis) { return axis >= 3 && axis < 6; }

constexpr bool is_secondary(size_t axis) { return axis >= 6; }

/// One value for each axis: mm, or degrees for rotary axes, as controls count them.
using AxisValues = std::array<double, axis_count>;

/// The length along which a feed is counted, given the travel of each axis: of X, Y and Z; if these
/// do not move, of U, V and W; else of the rotary axes, in degrees.
inline double fed_length(const AxisValues& by) {
    for (const size_t first : {size_t{0}, size_t{6}, size_t{3}}) {
        const double length = glm::length(Vec3(by[first], by[first + 1], by[first + 2]));
        if (length > 0.0) return length;
    }
    return 0.0;
}

/// One value for each axis; empty where the position is unknown.
using AxisPosition = std::array<std::optional<double>, axis_count>;

/// A set of axes: one bit for each, by its index.
using AxisSet = uint16_t;

/// How far each axis may be below and above a position that is not known exactly, mm. A negative
/// value: it is at least that far on the other side.
struct AxisSpread {
    AxisValues below{}, above{};

    bool none() const { return *this == AxisSpread{}; }
    bool operator==(const AxisSpread&) const = default;
};

/// A link of the machine: what an axis carries, by the index of the axis, or the base.
enum class LinkId : uint8_t { base = 255 };

constexpr LinkId link_of(size_t axis) { return static_cast<LinkId>(axis); }

/// A frame fixed to a link. The link's own frame is the machine's with all axes at 0.
struct Mount {
    LinkId link = LinkId::base;
    Transform link_from_body;
};

enum class MotionKind : uint8_t { rapid, feed, arc };

/// A circular or helical path: the first two axes of the plane turn about the centre, the third
/// advances.
struct ArcPath {
    int normal = 2;          // axis of the arc: 0 X, 1 Y, 2 Z
    Vec3 centre = Vec3(0.0); // machine coordinates; the component along `normal` is not used
    double angle = 0.0;      // radians, positive counter-clockwise seen from +normal
};

/// The path of the tool tip when the control keeps it straight relative to the work while rotary
/// axes move. Frame: the table link.
struct TipPath {
    Vec3 from = Vec3(0.0), to = Vec3(0.0);
    double tool_length = 0.0; // as used by the control
    double turn_error = 0.0;  // how far the rotary axes are in all from moving evenly, radians
};

/// How far the motions of a block are known.
enum class PathCertainty : uint8_t {
    known,
    doubtful,     // as far as is known: measured, but never clear
    pose_unknown, // the axis positions are known, but not where they put the bodies: not measured
    unknown,      // the axes may be anywhere: not measured, and limits are not checked
};

/// How the axes of a rapid move. straight: they arrive together. dogleg: each at its own speed.
/// independent: each at a speed that is not known.
enum class RapidStyle : uint8_t { straight, dogleg, independent };

/// One rapid, feed or arc move. Machine coordinates of the gauge line, not of the tip.
struct Motion {
    MotionKind kind = MotionKind::rapid;
    AxisPosition from, to;
    std::optional<ArcPath> arc = {}; // when kind is arc; both ends known then
    std::optional<TipPath> tip = {}; // when the control follows the tip; both ends known then
    double path_error = 0.0;         // mm: the path may be this far from the stated one
    double turn_error = 0.0; // radians: the rotary axes may in all be this far from the stated ones
    double feed = 0.0;       // mm/min along the path; 0 on rapids
    std::optional<RapidStyle> style = {}; // of a rapid; empty: that of the machine
    bool stops_at_contact = false; // a probing move: it ends between its first contact and `to`
    bool leaves_contact = false;   // such a move ends when the contact is lost (G38.4)
    // Axes that reach `to` wherever the motion starts. After a probing move, the others end as far
    // from `to` as they started from `from`.
    AxisSet settles = 0;
};

/// The new tool in the spindle; empty for T0, an empty spindle.
struct ToolChange {
    std::optional<ToolNumber> tool;
};

enum class SpindleDirection : uint8_t { stopped, clockwise, counterclockwise };

struct SpindleChange {
    SpindleDirection direction = SpindleDirection::stopped;
    double speed = 0.0; // rev/min
};

struct Dwell {
    double seconds = 0.0;
};

/// The new length that the control adds along Z; `number` is empty after G49.
struct LengthOffsetChange {
    std::optional<OffsetNumber> number;
    double length = 0.0;     // mm
    bool is_assumed = false; // nobody states the length under this number
};

/// How corners are passed. exact_stop: every motion ends at rest (G61.1). exact_path: the path is
/// kept, and the machine passes without a stop only where there is no corner for it (G61).
/// continuous: corners are rounded within a tolerance (G64).
enum class Blending : uint8_t { exact_stop, exact_path, continuous };

/// The new way in which corners are passed.
struct PathModeChange {
    Blending blending = Blending::continuous;
    std::optional<double> tolerance; // of corners between feeds, mm; empty: not stated
    double joining =
        0.0; // feeds this close to a line may be joined into it, mm; adds to `tolerance`
    std::optional<double> distance = {}; // of the path at which such a corner is rounded, mm
    std::optional<double> rapid_tolerance = {}, rapid_distance = {}; // of corners between rapids
    // LinuxCNC computes from `tolerance` and `rapid_tolerance` where it begins to brake; see
    // `blend_at`. Otherwise they are the greatest deviations.
    bool blends = false;
    bool blends_at_arcs = false;    // likewise before and after arcs
    bool rapids_keep_speed = false; // corners between rapids are rounded as far as speeds demand
    bool between_kinds = false; // rounds corners between a rapid and a feed by the smaller distance
};

/// A fixture that is mounted or removed, by its index in the set-up.
struct FixtureChange {
    size_t fixture = 0;
    bool is_there = true;
};

/// What a block does to the machine, in order of execution.
using Event = std::variant<Motion, ToolChange, SpindleChange, Dwell, LengthOffsetChange,
                           PathModeChange, FixtureChange>;

} // namespace core
