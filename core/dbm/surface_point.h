#pragma once

#include "core/dbm/cut_model.h"

namespace core {

/// A point of a stock's surface.
struct SurfacePoint {
    Vec3 point = Vec3(0.0);
    Vec3 normal = Vec3(0.0);       // of length 1, out of the stock
    std::optional<uint32_t> block; // whose move made it; none for the raw stock
};

/// One end of an interval on a line.
struct LineEnd {
    int axis = 0, u = 0, v = 0;
    size_t interval = 0;
    bool upper = false;
};

/// The surface at the end of an interval.
///
/// Result: the normal is that of the surface which the end lies on: of the swept volume of the move
///         that cut there, or of the raw stock. On an edge it is that of one of the faces.
/// Cost:   a search of at most 40 steps along the move for each convex piece of the cutter.
SurfacePoint surface_point(const CutModel& model, const LineEnd& end);

/// The surface at all ends of one family, in order: row by row, upwards along the line.
std::vector<SurfacePoint> surface_points(const CutModel& model, int axis);

} // namespace core
