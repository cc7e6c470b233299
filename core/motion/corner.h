#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/motion/path.h"

namespace core {

/// The part of the path at a corner within which a control may leave it.
struct CornerRegion {
    std::vector<Leg> along; // the programmed path there, before and after the corner
    Leg hull;               // contains the rounded path; empty if rotary axes turn there
};

/// The greatest distance from the corner, along the path, at which a corner with this deviation is
/// rounded; `turn` is the change of direction, radians, above 0.
///
/// Source: docs/decisions/distance.md, "Rounded corners".
double rounding_reach(double deviation, double turn);

/// Whether a motion is so short that controls leave it out; the motions beside it meet then.
bool is_left_out(const Motion& motion);

/// Legs on which an axis stays where it moves by less than a control counts.
std::vector<Leg> without_rounding(std::span<const Leg> legs);

/// Length of a path in the linear axes, mm; for boxes of possible positions, at least that.
double length_of(std::span<const Leg> legs);

/// The two lines that LinuxCNC makes of an arc if they are within `joining` of it, mm; otherwise
/// empty. `path`: that of the motion.
std::vector<Leg> lines_of_arc(const Motion& motion, const Path& path, double joining);

/// Whether the accelerations of all linear axes are known.
bool states_accelerations(const Machine& machine);

/// Whether their speeds are known, too.
bool states_dynamics(const Machine& machine);

/// Whether speeds and accelerations of all axes are known.
bool states_all_dynamics(const Machine& machine);

/// How far from a corner the control leaves the motion before it and the one after it, mm.
struct CornerReach {
    double before = infinity, after = infinity;
};

/// How a control leaves the path at a corner at which it brakes along one motion while it
/// accelerates along the next one, as LinuxCNC does.
struct CornerBlend {
    CornerReach reach;
    double deviation = 0.0; // greatest distance from the path, mm
    double turn = 0.0;      // greatest sum of what all rotary axes are off, radians
    // The part of the first motion that is left when the second one begins, and the part of the
    // second one that is made until the first one has ended; only if other axes than X, Y and Z
    // move. For joined motions, `part_after` may exceed 1.
    double left = 0.5, part_after = infinity;
};

/// Which motions meet at a corner.
enum class CornerKind : uint8_t {
    rapids,
    feeds,
    joined_feeds // straight ones may be parts of longer ones
};

/// The blend between two motions, given by their legs.
///
/// `tolerance`: from which the control computes where it begins to brake, mm; infinity: as soon as
/// accelerations allow. Where the machine states accelerations, and for rapids also speeds, the
/// blend reaches no farther than they make it, and never beyond the middle of the motion before the
/// corner. Next to arcs, and where other axes than X, Y and Z move, the tolerance alone says
/// nothing.
///
/// Source: docs/decisions/distance.md, "Corners of LinuxCNC".
CornerBlend blend_at(std::span<const Leg> before, std::span<const Leg> after, double tolerance,
                     CornerKind kind, const Machine& machine);

/// Whether other axes than X, Y and Z move on legs.
bool moves_other_axes(std::span<const Leg> legs);

/// The sum of what the rotary axes turn on legs, radians.
double turned_on(std::span<const Leg> legs);

/// The last part of a motion, as straight legs; by time, or by length if the legs have no times.
std::vector<Leg> last_part(std::span<const Leg> legs, double part);

/// Legs at a corner while the motion before it ends: `rest` is left of that, from one of its
/// fractions to another one. `corner`: where it ends.
std::vector<Leg> displaced(std::span<const Leg> legs, const Leg& rest, double from, double to,
                           const AxisValues& corner);

/// The change of direction between two motions, given by their legs, radians; empty if a direction
/// is not known.
std::optional<double> turn_at(std::span<const Leg> before, std::span<const Leg> after);

/// How far before a corner a feed is blended at most, divided by the square of its speed, s2/mm;
/// 0 if the machine does not state its accelerations.
double most_reach_of_speed(const Machine& machine);

/// The greatest deviation of a blend between straight motions, as a multiple of its tolerance.
double most_blend_deviation(const Machine& machine);

/// The region of the corner between two motions, given by their legs; empty if nothing is rounded:
/// no change of direction, no length, or no deviation.
///
/// `deviation`: greatest distance from the programmed path, mm. `reach`: where the rounding begins
/// and ends at most. If that is not known, it reaches at most to the middle of either motion, and
/// no farther than `rounding_reach`.
std::optional<CornerRegion> corner_region(std::span<const Leg> before, std::span<const Leg> after,
                                          double deviation, const CornerReach& reach = {});

} // namespace core
