#pragma once

#include "core/base/vec.h"

namespace core {

class SweepLog;
struct CutModel;
struct RevolvedProfile;

/// A straight move that asks whether its cutter has been there before.
struct PathQuestion {
    const RevolvedProfile& flutes;         // of the tool that moves
    Vec3 from = Vec3(0.0), to = Vec3(0.0); // places of its tip
    double sideways = 0.0; // how far the tip may be from where it was, errors of both ways included
    Mat3 orientation = Mat3(1.0); // stock_from_tool; "above" and "up" are along the tool's axis
};

/// Whether a tool, made slimmer all round by `sideways`, moves only through what the same flutes
/// have cut already: back along a slot, up from a pocket's floor, out of a drilled hole.
///
/// Result: true only if every place of the tip lies within `sideways` of a logged move of the same
///         flutes, held the same way, or, seen from above, within it and not below, where the
///         flutes reached up past the stock's top. In the first case the tool has been there, and
///         stock does not grow. In the second the flutes, if they never get slimmer upwards,
///         stay inside that cut widened upwards, which holds no stock. Nothing is said of a shank:
///         it was there, too, but cuts nothing. False says nothing.
/// Cost:   the logged moves near the path, times the parts into which it must be divided.
bool runs_in_own_cut(const CutModel& stock, const PathQuestion& question);

/// The same for another body that the flutes have cut: `box` holds all of it, `log` the moves that
/// cut it.
bool runs_in_own_cut(const SweepLog& log, const Aabb& box, const PathQuestion& question);

} // namespace core
