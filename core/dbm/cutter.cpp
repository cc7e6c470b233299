#include "core/dbm/cutter.h"

namespace core {
namespace {

/// What a computed end of a stretch may be off by, mm (see line_interval).
constexpr double rounding = 1e-9;

} // namespace

Cutter make_cutter(const RevolvedProfile& flutes, double path_error) {
    std::vector<RevolvedProfile> convex;
    if (is_convex(flutes))
        convex.push_back(flutes);
    else
        for (const ProfileElement& element : flutes.elements)
            convex.push_back(RevolvedProfile{{element}});
    Cutter cutter{.flutes = flutes};
    for (const RevolvedProfile& piece : convex) {
        if (path_error == 0.0)
            cutter.pieces.push_back({piece, piece});
        else
            cutter.pieces.push_back({shrunk_within(piece, path_error), grown(piece, path_error)});
    }
    return cutter;
}

Aabb bounds(const CutterSweep& sweep) {
    Aabb box;
    for (const Cutter::Piece& piece : sweep.cutter->pieces) {
        const Aabb body = bounds(piece.around);
        for (const Vec3& place : {sweep.from, sweep.to})
            box.extend(Aabb{body.min + place, body.max + place});
    }
    return box;
}

std::optional<Interval> line_interval(const RevolvedProfile& convex, const CutterSweep& sweep,
                                      int axis, double u, double v) {
    // The sweep of a convex profile is convex, so the hull of what its pieces cover is covered.
    Interval hull{infinity, -infinity};
    for (const ProfileElement& element : convex.elements) {
        const auto part = line_interval({element, sweep.from, sweep.to}, axis, u, v);
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
    if (!swept || !(swept->lower + rounding < swept->upper - rounding)) return std::nullopt;
    return Interval{swept->lower + rounding, swept->upper - rounding};
}

} // namespace core
