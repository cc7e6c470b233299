#pragma once

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

} // namespace core
