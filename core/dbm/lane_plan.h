#pragma once

#include <array>
#include <vector>

#include "core/dbm/cutter.h"

namespace core {

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
    const RevolvedProfile* piece = nullptr;
    const CutterSweep* sweep = nullptr;
};

/// The plan for a convex piece; it points to both arguments. Segments along Z need not be exact
/// above `top`, where there is no stock.
LanePlan lane_plan(const RevolvedProfile& convex, const CutterSweep& sweep, int axis,
                   double top = infinity);

} // namespace core
