#pragma once

#include <array>
#include <vector>

#include "core/dbm/cutter.h"

namespace core {

/// Ends of swept segments are multiples of 2.3e-10 mm: two moves that produce the same surface then
/// give the same bits, and neither cuts a rounding error from the other's surface.
constexpr double ends_per_mm = 4294967296.0; // 2^32

/// A ball, or the circle of an upright cylinder seen from above, along one move: parameters for its
/// intersection with the lines of one family. Coordinates: along the lines (a), and across them (u,
/// v).
///
/// Seen along the lines the move has a direction (cos_u, cos_v) and a length; a line is at g along
/// it and at e across it. Its segment begins and ends at the times t = g * per_length + w * by_half
/// + at, w = sqrt(r^2 - e^2), clamped to 0..1. For moves along the lines per_length and by_half are
/// 0.
struct CapsuleLanes {
    double from_a, from_u, from_v;
    double by_a;
    double radius;
    double cos_u, cos_v, length, per_length;
    double low_by_half, low_at, high_by_half, high_at;
    double low_end, high_end;     // added to the ends of a cylinder's segment: its end faces
    bool steep;                   // nearly along the lines, but not exactly
    bool opens_up;                // no stock above, so every segment may end at high_end
    double reach_low, reach_high; // bounds of the ball's centre or of the cylinder's ends
    double u_most, v_most;        // beyond these, another element covers this one
    bool level; // all of a piece, which does not move along the lines: its ends are the reach
};

/// An upright cylinder crossed from the side: (a, s) is the plane of its circle, z the height.
struct AcrossLanes {
    bool side_is_u; // else the height is
    double from_a, from_side, from_z;
    double by_a, by_side, by_z;
    double radius, z0, z1;
    double reach_low, reach_high; // bounds of the centre
    double per_side, per_z;       // 1 / by_side, 1 / by_z; 0 if the motion is negligible
    double low_at, high_at;       // the times are side * per_side + these, ...
    double by_radius;             // ... minus radius * by_radius (low), plus it (high)
};

/// A cone or a rounded corner. On a level or vertical move, its section at a given distance from
/// the path or at a given height is constant, only moves or only grows; on any other move it is
/// `sloped`.
struct ElementLanes {
    ProfileElement element;
    CapsuleLanes path;  // for lines along Z
    AcrossLanes across; // for other lines; its radius is not used
    bool sloped;
    Interval matters; // it can be left out for lines elsewhere: by their distance from the axis, or
                      // by their height for lines along X and Y
};

/// A tilted cone along one move. A point s along a line and t along the motion, both in mm, is
/// p + s d - t m in the frame of the tool; p is linear in the coordinates of the line. What is the
/// same for all lines is computed once; the names are those of swept_line.cpp.
struct TiltedLanes {
    Vec3 origin, by_u, by_v; // p = origin + u by_u + v by_v
    double from_a;           // where s is 0, along the line
    Vec3 d, m;
    double length; // of the motion
    double z0, z1, r0, r1, slope;
    double chord_a; // of the quadratic form along d
    // The line of (s, t) at the height of an end face, which is `rise` above p.
    double face_s, face_t; // its foot, times rise
    double face_s_by, face_t_by;
    Vec3 face_e;
    // The two points at which a line can touch the envelope of the flank.
    bool has_silhouette;
    Vec3 touch_n, touch_s_foot, touch_t_foot; // multiply (x, y, radius) of p
    std::array<double, 2> touch_y;
    double touch_t_by_h, touch_t_by_s;
};

/// A slab of space around what a tilted piece sweeps: normal . point is within low .. high. For a
/// line, its components across the lines and 1 / that along them; 0 if it hardly has one.
struct SlabLanes {
    double normal_u, normal_v, per_a;
    double low, high;
};

/// Parameters for intersecting the sweep of a convex piece with the lines of one family, as the
/// lanes need them.
struct LanePlan {
    static constexpr size_t most = 4;

    int axis = 0;
    bool by_lanes = false; // else line by line, using `piece` and `sweep`
    size_t balls = 0, uprights = 0, across = 0;
    std::array<CapsuleLanes, most> ball, upright; // upright: cylinders met by lines along Z
    std::array<AcrossLanes, most> sideways;       // cylinders met by lines along X and Y
    std::vector<ElementLanes> elements;           // any number: a form tool has dozens
    std::vector<TiltedLanes> tilted;              // cones and cylinders of a tilted tool
    bool has_slabs = false;
    std::array<SlabLanes, 3> slabs; // of a tilted tool: a box aligned with it and its way
    const RevolvedProfile* piece = nullptr;
    const CutterSweep* sweep = nullptr;
};

/// The plan for a convex piece; it points to both arguments. Segments along Z need not be exact
/// above `top`, where there is no stock.
LanePlan lane_plan(const RevolvedProfile& convex, const CutterSweep& sweep, int axis,
                   double top = infinity);

} // namespace core
