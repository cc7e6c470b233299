#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/vec.h"
#include "core/dbm/interval.h"
#include "core/geom/profile.h"

namespace core {

struct Square;

/// A convex piece of a profile, upright, moved straight.
struct ElementSweep {
    ProfileElement element;
    Vec3 from = Vec3(0.0), to = Vec3(0.0); // positions of the profile's origin
};

/// The segment of a line along an axis inside the swept volume of a convex piece.
///
/// Shape:   the line runs along `axis`; `u` and `v` are its coordinates on the next two axes in
///          cyclic order (X: y, z; Y: z, x; Z: x, y).
/// Result:  empty if the line misses the volume or only touches it. The ends are inside the volume
///          up to rounding (1e-9 mm within 2 m): the segment is never longer than the true one.
/// Cost:    closed form for cylinders, cones and balls; some 100 evaluations for a rounded corner.
std::optional<Interval> line_interval(const ElementSweep& sweep, int axis, double u, double v);

/// The segment of a line along an axis inside the swept volume of a tilted convex piece. The sweep
/// gives positions of the profile's origin.
///
/// Shape:   as for line_interval.
/// Result:  as for line_interval, but the ends are inside the volume up to 1e-8 mm.
/// Cost:    closed form for cylinders, cones and balls; some 100 evaluations for a rounded corner.
std::optional<Interval> tilted_line_interval(const ElementSweep& sweep, const Mat3& stock_from_tool,
                                             int axis, double u, double v);

/// Whether the tool axis points straight up, so that line_interval can be used.
inline bool is_upright(const Mat3& stock_from_tool) {
    return stock_from_tool[2] == Vec3(0.0, 0.0, 1.0);
}

/// How low an upright body of revolution reaches at some distance from its axis: a lower bound.
class Underside {
public:
    Underside() = default;
    explicit Underside(const std::vector<ProfileElement>& elements);

    /// No point that is `distance` or more from the axis is lower; infinite if there is none.
    double beyond(double distance) const;

private:
    static constexpr size_t steps = 32;
    double radius_ = 0.0;                 // of the body
    std::array<double, steps> heights_{}; // beyond i / steps of the radius
};

/// The flutes of a tool prepared for cutting: convex pieces, each as a profile inside the real one
/// and one that contains it. They differ by the error of the path.
struct Cutter {
    struct Piece {
        RevolvedProfile within, around;

        bool operator==(const Piece&) const = default;
    };
    RevolvedProfile cutting; // of which the pieces are
    RevolvedProfile flutes;  // the same, or larger where they may cut less than they look like
    double path_error = 0.0;
    std::vector<Piece> pieces;
    Aabb body;                // of everything it may cut when upright, relative to the tip
    Underside underside = {}; // of the same
};

/// A cutter for paths within `path_error` mm of the straight moves given for them.
Cutter make_cutter(const RevolvedProfile& flutes, double path_error);

/// One straight move of a cutter with constant orientation. Frame: the stock's; positions of the
/// tool tip.
struct CutterSweep {
    std::shared_ptr<const Cutter> cutter;
    Vec3 from = Vec3(0.0), to = Vec3(0.0);
    Mat3 orientation = Mat3(1.0); // stock_from_tool
    uint32_t block = 0;           // of the program, in the caller's numbering
};

/// Whether two moves remove the same from any stock, whatever their blocks.
bool cut_alike(const CutterSweep& a, const CutterSweep& b);

/// A box that contains everything the sweep may remove.
Aabb bounds(const CutterSweep& sweep);

/// The segment of a line inside the swept volume of a convex profile, as for an ElementSweep.
std::optional<Interval> line_interval(const RevolvedProfile& convex, const CutterSweep& sweep,
                                      int axis, double u, double v);

/// The heights at which a convex profile sweeps over a whole square: where it covers all four
/// corners, it covers every point between them.
std::optional<Interval> covered_heights(const RevolvedProfile& convex, const CutterSweep& sweep,
                                        const Square& square);

/// Error bound of a computed end, mm (see tilted_line_interval).
constexpr double safely_less = 1e-8;

/// A computed segment, shortened by the error bound at both ends; empty if nothing remains.
std::optional<Interval> safely_within(std::optional<Interval> swept);

} // namespace core
