#pragma once

#include <vector>

#include "core/base/vec.h"

namespace core {

struct Mesh;

/// A convex piece of a body of revolution about Z: the truncated cone from (r0, z0) up to (r1, z1),
/// grown by `margin` on all sides. A ball is a point with a margin, a rounded corner a disc with
/// one.
struct ProfileElement {
    double z0 = 0.0, r0 = 0.0; // lower rim, mm; r >= 0, z0 <= z1
    double z1 = 0.0, r1 = 0.0; // upper rim
    double margin = 0.0;

    bool operator==(const ProfileElement&) const = default;
};

/// A body of revolution about Z, as the union of convex pieces.
struct RevolvedProfile {
    std::vector<ProfileElement> elements;
    double form_error = 0.0; // maximum distance of the true surface from the pieces, mm
    double deviation = 0.0;  // the part of it that is the deviation of a CAD file

    bool empty() const { return elements.empty(); }
    bool operator==(const RevolvedProfile&) const = default;
};

Aabb bounds(const ProfileElement& element);
Aabb bounds(const RevolvedProfile& profile);

/// Whether the union of the pieces, stacked from the tip up, is convex.
bool is_convex(const RevolvedProfile& profile);

/// A profile inside the given one, `by` away from its surface everywhere. Seams between pieces open
/// by up to 2 * by; for a convex profile the hull of the pieces is still inside.
RevolvedProfile shrunk_within(const RevolvedProfile& profile, double by);

/// A profile that contains every point deeper than `by` in the given one and none outside it: its
/// sides, its downward faces and the upward faces of its steps move inwards; its top face stays.
RevolvedProfile shrunk_around(const RevolvedProfile& profile, double by);

/// A profile that contains every point closer than `by` to the given one.
RevolvedProfile grown(const RevolvedProfile& profile, double by);

/// The smallest body of revolution about Z that contains a mesh, as stacked cones from its lowest
/// point to its highest.
///
/// Result:  the whole mesh is inside. It is too wide by at most `tolerance` plus the sagitta of the
///          chord of an edge's rotation about the axis over a 400th of the height; if the vertices
///          have more than 400 heights, also by the widening of flanks between some of these
///          heights.
/// Cost:    triangles times heights, at most 800 of them.
RevolvedProfile revolved_hull(const Mesh& mesh, double tolerance);

} // namespace core
