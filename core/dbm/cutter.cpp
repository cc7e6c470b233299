#include "core/dbm/cutter.h"

#include "core/dbm/solid.h"

namespace core {
namespace {

/// The box of a piece relative to the origin of the profile, for any direction of its axis.
Aabb tilted_bounds(const ProfileElement& e, const Vec3& up) {
    // A circle about the axis extends along X by its radius times the sine of the angle between the
    // axis and X.
    const Vec3 lean(std::hypot(up.y, up.z), std::hypot(up.z, up.x), std::hypot(up.x, up.y));
    Aabb box;
    for (const auto& [z, r] : {std::pair(e.z0, e.r0), std::pair(e.z1, e.r1)})
        box.extend(Aabb{z * up - r * lean, z * up + r * lean});
    return box.grown(e.margin);
}

} // namespace

Cutter make_cutter(const RevolvedProfile& flutes, double path_error) {
    std::vector<RevolvedProfile> convex;
    if (is_convex(flutes))
        convex.push_back(flutes);
    else
        for (const ProfileElement& element : flutes.elements)
            convex.push_back(RevolvedProfile{{element}});
    Cutter cutter{.flutes = flutes, .path_error = path_error, .pieces = {}, .body = {}};
    for (const RevolvedProfile& piece : convex) {
        if (path_error == 0.0)
            cutter.pieces.push_back({piece, piece});
        else
            cutter.pieces.push_back({shrunk_within(piece, path_error), grown(piece, path_error)});
    }
    for (const Cutter::Piece& piece : cutter.pieces) cutter.body.extend(bounds(piece.around));
    return cutter;
}

Aabb bounds(const CutterSweep& sweep) {
    Aabb body = sweep.cutter->body;
    if (!is_upright(sweep.orientation)) {
        body = {};
        for (const Cutter::Piece& piece : sweep.cutter->pieces)
            for (const ProfileElement& e : piece.around.elements)
                body.extend(tilted_bounds(e, sweep.orientation[2]));
    }
    return {glm::min(sweep.from, sweep.to) + body.min, glm::max(sweep.from, sweep.to) + body.max};
}

std::optional<Interval> line_interval(const RevolvedProfile& convex, const CutterSweep& sweep,
                                      int axis, double u, double v) {
    // The sweep of a convex profile is convex, so the hull of what its pieces cover is covered.
    const bool upright = is_upright(sweep.orientation);
    Interval hull{infinity, -infinity};
    for (const ProfileElement& element : convex.elements) {
        const ElementSweep moved{element, sweep.from, sweep.to};
        const auto part = upright ? line_interval(moved, axis, u, v)
                                  : tilted_line_interval(moved, sweep.orientation, axis, u, v);
        if (!part) continue;
        hull.lower = std::min(hull.lower, part->lower);
        hull.upper = std::max(hull.upper, part->upper);
    }
    if (!(hull.lower < hull.upper)) return std::nullopt;
    return hull;
}

std::optional<Interval> covered_heights(const RevolvedProfile& convex, const CutterSweep& sweep,
                                        const Square& square) {
    Interval common{-infinity, infinity};
    for (const double x : {square.x0, square.x1}) {
        for (const double y : {square.y0, square.y1}) {
            const auto corner = line_interval(convex, sweep, 2, x, y);
            if (!corner) return std::nullopt;
            common.lower = std::max(common.lower, corner->lower);
            common.upper = std::min(common.upper, corner->upper);
        }
    }
    return safely_within(common);
}

std::optional<Interval> safely_within(std::optional<Interval> swept) {
    if (!swept || !(swept->lower + safely_less < swept->upper - safely_less)) return std::nullopt;
    return Interval{swept->lower + safely_less, swept->upper - safely_less};
}

} // namespace core
