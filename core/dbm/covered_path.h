#pragma once

#include <cstdint>

#include "core/base/vec.h"

namespace core {

class SweepLog;
struct CutModel;
struct RevolvedProfile;

/// A straight move that is compared with earlier cuts.
struct PathQuery {
    const RevolvedProfile& flutes;         // of the moving tool
    Vec3 from = Vec3(0.0), to = Vec3(0.0); // positions of the tip
    double sideways =
        0.0; // allowed distance of the tip from earlier positions, errors of both paths included
    Mat3 orientation = Mat3(1.0); // stock_from_tool; "above" and "up" are along the tool's axis
};

/// Whether a tool, made slimmer by `sideways` on all sides, moves only where the same flutes have
/// cut before: back along a slot, up from the floor of a pocket, out of a drilled hole.
///
/// Result:  true only if every tip position is within `sideways` of a logged move of the same
///          flutes in the same orientation; or, seen from above, within it and not below, where the
///          flutes reached above the top of the stock. In the first case the tool has been there,
///          and stock does not grow. In the second, if the flutes never get slimmer upwards, they
///          stay inside that cut extended upwards, which contains no stock. This does not hold for
///          a shank, which was there too but does not cut. False proves nothing.
/// Cost:    the number of logged moves near the path times the number of parts into which it is
///          divided.
bool runs_in_own_cut(const CutModel& stock, const PathQuery& question);

/// Overload for another body cut by the flutes: `box` contains the body, `log` the moves that cut
/// it.
bool runs_in_own_cut(const SweepLog& log, const Aabb& box, const PathQuery& question);

/// A straight move of a part of a tool that is compared with earlier cuts.
struct PartPathQuery {
    const RevolvedProfile& part;           // its heights count from the tip
    const RevolvedProfile& flutes;         // cutters that reach farther may be overlooked
    Vec3 from = Vec3(0.0), to = Vec3(0.0); // positions of the tip
    double sideways = 0.0;                 // allowed distance of its axis from that of a cutter
    Mat3 orientation = Mat3(1.0);          // stock_from_tool
    uint32_t first_move = 0;               // number of the first move in the log that counts
    uint32_t moves_end = UINT32_MAX;       // and of the first later one that does not
    double gap = 0.0; // mm: what is left between two cuts counts if it is wider than this
};

/// Whether a part of a tool stays where cutters at least as wide have been: beside each point of
/// its axis, at most `sideways` away, errors of the cuts included, the axis of such a cutter has
/// passed while that cut at this height. Where the part stays more than `sideways` beside the box
/// of the stock, this is not needed; where an upright axis is outside of it, the nearest place in
/// it may be covered instead. Cutters must be parallel to the part.
///
/// Result:  if true, and `gap` is 0, no stock is where the part goes if it is made slimmer by
///          `sideways` on all sides. With a gap, cutters may also be out of parallel by 0.02
///          radians. False proves nothing.
/// Cost:    the number of logged moves near the path times the number of parts into which path
///          and heights are divided. It gives up after some 100,000 of these.
bool stays_in_own_cut(const CutModel& stock, const PartPathQuery& question);

} // namespace core
