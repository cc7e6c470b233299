#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/base/vec.h"
#include "core/dbm/interval.h"
#include "core/geom/profile.h"

namespace core {

struct Square;

/// A convex piece of a profile, upright, moved straight from one place to another.
struct ElementSweep {
    ProfileElement element;
    Vec3 from = Vec3(0.0), to = Vec3(0.0); // places of the profile's origin
};

/// The stretch of a line along an axis that lies in the swept volume of a convex piece.
///
/// Shape:  the line runs along `axis`; `u` and `v` are its coordinates on the next two axes in
///         cyclic order (X: y, z; Y: z, x; Z: x, y).
/// Result: empty when the line misses the volume or only touches it. The ends lie in the volume up
///         to rounding (1e-9 mm within 2 m): the stretch is never longer than the true one.
/// Cost:   closed form for cylinders, cones and balls; some 100 evaluations for a rounded corner.
std::optional<Interval> line_interval(const ElementSweep& sweep, int axis, double u, double v);

/// The same for a whole profile at rest: the union over its pieces.
IntervalList line_intervals(const RevolvedProfile& profile, int axis, double u, double v);

/// The stretch of a line along an axis that lies in the swept volume of a convex piece whose own
/// axis may point anywhere; the sweep's places are those of the profile's origin.
///
/// Shape:  as line_interval has it.
/// Result: as line_interval has it, but the ends lie in the volume up to 1e-8 mm.
/// Cost:   closed form for cylinders, cones and balls; some 100 evaluations for a rounded corner.
std::optional<Interval> tilted_line_interval(const ElementSweep& sweep, const Mat3& stock_from_tool,
                                             int axis, double u, double v);

/// Whether the tool's axis points straight up, so that line_interval serves as well.
inline bool is_upright(const Mat3& stock_from_tool) {
    return stock_from_tool[2] == Vec3(0.0, 0.0, 1.0);
}

/// The flutes of a tool made ready for cutting: convex pieces, each as a profile that lies within
/// the real one and one that holds it. They differ by the error of the path they are moved along.
struct Cutter {
    struct Piece {
        RevolvedProfile within, around;
    };
    RevolvedProfile flutes;
    double path_error = 0.0;
    std::vector<Piece> pieces;
    Aabb body; // round all of what it may cut, when it stands upright, about its tip
};

/// A cutter for paths that stay within `path_error` mm of the straight moves given for them.
Cutter make_cutter(const RevolvedProfile& flutes, double path_error);

/// One straight move of a cutter that does not turn meanwhile.
/// Frame: that of the stock; places of the tool's tip.
struct CutterSweep {
    std::shared_ptr<const Cutter> cutter;
    Vec3 from = Vec3(0.0), to = Vec3(0.0);
    Mat3 orientation = Mat3(1.0); // stock_from_tool
    uint32_t block = 0;           // of the program, whatever the caller counts by
};

/// The box of everything the sweep may remove.
Aabb bounds(const CutterSweep& sweep);

/// The stretch of a line in the swept volume of a convex profile, as line_interval has it.
std::optional<Interval> line_interval(const RevolvedProfile& convex, const CutterSweep& sweep,
                                      int axis, double u, double v);

/// The heights that a convex profile sweeps above the whole of a square: where it covers all four
/// corners, it covers every point between them.
std::optional<Interval> covered_heights(const RevolvedProfile& convex, const CutterSweep& sweep,
                                        const Square& square);

/// What a computed end of a stretch may be off by, mm (see tilted_line_interval).
constexpr double safely_less = 1e-8;

/// A computed stretch, shortened by what rounding may have added to it; empty if nothing is left.
std::optional<Interval> safely_within(std::optional<Interval> swept);

} // namespace core
