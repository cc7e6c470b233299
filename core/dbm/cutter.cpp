#include "core/dbm/cutter.h"

#include <bitset>

#include "core/base/math.h"
#include "core/dbm/solid.h"

namespace core {
namespace {

/// The box of a piece relative to the origin of the profile, for any direction of its axis.
Aabb tilted_bounds(const ProfileElement& e, const Vec3& up) {
    // A circle about the axis extends along X by its radius times the sine of the angle between the
    // axis and X.
    const Vec3 lean(core::hypot(up.y, up.z), core::hypot(up.z, up.x), core::hypot(up.x, up.y));
    Aabb box;
    for (const auto& [z, r] : {std::pair(e.z0, e.r0), std::pair(e.z1, e.r1)})
        box.extend(Aabb{z * up - r * lean, z * up + r * lean});
    return box.grown(e.margin);
}

/// The least and the greatest distance of a line along Z from the axis of an upright tool on a
/// move.
Interval distances_from_axis(const CutterSweep& sweep, double x, double y) {
    const double to_x = x - sweep.from.x, to_y = y - sweep.from.y;
    const double way_x = sweep.to.x - sweep.from.x, way_y = sweep.to.y - sweep.from.y;
    const double way_2 = way_x * way_x + way_y * way_y;
    const double along = to_x * way_x + to_y * way_y;
    const double t = way_2 > 0.0 ? std::clamp(along / way_2, 0.0, 1.0) : 0.0;
    const auto distance_2 = [&](double at) {
        const double off_x = to_x - at * way_x, off_y = to_y - at * way_y;
        return off_x * off_x + off_y * off_y;
    };
    return {std::sqrt(distance_2(t)), std::sqrt(std::max(distance_2(0.0), distance_2(1.0)))};
}

/// Calls `act` with the pieces of a convex profile, ordered by height, that may be the lowest or
/// the highest one on a line at one of these distances from the axis. A piece that may be both is
/// passed once if it is one of the first 64.
template <typename Act>
void for_outer_pieces(const RevolvedProfile& convex, const Interval& distances, const Act& act) {
    constexpr double slack = 1e-9; // mm
    const std::vector<ProfileElement>& pieces = convex.elements;
    const size_t count = pieces.size();
    std::bitset<64> done;
    const auto act_once = [&](const ProfileElement& piece) {
        const auto number = static_cast<size_t>(&piece - pieces.data());
        if (number < done.size()) {
            if (done[number]) return;
            done.set(number);
        }
        act(piece);
    };
    const auto rim = [&](const ProfileElement& piece) { return std::max(piece.r0, piece.r1); };
    const auto visit = [&](const auto& nth, const auto& is_beyond) {
        // Out to this distance there is a piece that ends before the present one begins.
        double widest = -infinity;
        size_t passed = 0;
        for (size_t i = 0; i < count && widest - slack <= distances.upper; ++i) {
            const ProfileElement& piece = nth(i);
            for (; passed < i && is_beyond(piece, nth(passed)); ++passed)
                widest = std::max(widest, rim(nth(passed)));
            const double reach = rim(piece) + piece.margin;
            if (reach > widest && reach + slack >= distances.lower) act_once(piece);
        }
    };
    visit([&](size_t i) -> const ProfileElement& { return pieces[i]; },
          [](const ProfileElement& piece, const ProfileElement& lower) {
              return lower.z1 <= piece.z0 - piece.margin;
          });
    visit([&](size_t i) -> const ProfileElement& { return pieces[count - 1 - i]; },
          [](const ProfileElement& piece, const ProfileElement& higher) {
              return higher.z0 >= piece.z1 + piece.margin;
          });
}

/// No point of the piece that is `distance` or more from the axis is lower; infinite if there is
/// none.
double lowest_beyond(const ProfileElement& e, double distance) {
    const double rim = std::max(e.r0, e.r1);
    if (distance > rim + e.margin) return infinity;
    const auto of_cone = [&](double radius) {
        return radius <= e.r0 ? e.z0 : e.z0 + (radius - e.r0) / (e.r1 - e.r0) * (e.z1 - e.z0);
    };
    if (e.r1 <= e.r0 || e.z0 == e.z1) { // widest at its lowest height
        const double off = std::max(0.0, distance - rim);
        return e.z0 - std::sqrt(std::max(0.0, e.margin * e.margin - off * off));
    }
    return of_cone(std::min(rim, distance - e.margin)) - e.margin;
}

} // namespace

Underside::Underside(const std::vector<ProfileElement>& elements) {
    for (const ProfileElement& each : elements)
        radius_ = std::max(radius_, std::max(each.r0, each.r1) + each.margin);
    heights_.fill(infinity);
    for (size_t i = 0; i < steps; ++i)
        for (const ProfileElement& each : elements)
            heights_[i] = std::min(heights_[i],
                                   lowest_beyond(each, static_cast<double>(i) / steps * radius_));
}

double Underside::beyond(double distance) const {
    constexpr double slack = 1e-9; // mm
    if (distance > radius_ + slack) return infinity;
    const double place = (distance - slack) / std::max(radius_, slack) * steps;
    return heights_[static_cast<size_t>(std::clamp(place, 0.0, steps - 1.0))];
}

Cutter make_cutter(const RevolvedProfile& flutes, double path_error) {
    std::vector<RevolvedProfile> convex;
    if (is_convex(flutes))
        convex.push_back(flutes);
    else
        for (const ProfileElement& element : flutes.elements)
            convex.push_back(RevolvedProfile{{element}});
    Cutter cutter{
        .cutting = flutes, .flutes = flutes, .path_error = path_error, .pieces = {}, .body = {}};
    for (const RevolvedProfile& piece : convex) {
        if (path_error == 0.0)
            cutter.pieces.push_back({piece, piece});
        else
            cutter.pieces.push_back({shrunk_within(piece, path_error), grown(piece, path_error)});
    }
    std::vector<ProfileElement> all;
    for (const Cutter::Piece& piece : cutter.pieces) {
        cutter.body.extend(bounds(piece.around));
        all.insert(all.end(), piece.around.elements.begin(), piece.around.elements.end());
    }
    cutter.underside = Underside(all);
    return cutter;
}

bool cut_alike(const CutterSweep& a, const CutterSweep& b) {
    if (a.from != b.from || a.to != b.to || a.orientation != b.orientation) return false;
    return a.cutter == b.cutter
           || (a.cutter->path_error == b.cutter->path_error && a.cutter->flutes == b.cutter->flutes
               && a.cutter->pieces == b.cutter->pieces);
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
    const auto add = [&](const ProfileElement& element) {
        const ElementSweep moved{element, sweep.from, sweep.to};
        const auto part = upright ? line_interval(moved, axis, u, v)
                                  : tilted_line_interval(moved, sweep.orientation, axis, u, v);
        if (!part) return;
        hull.lower = std::min(hull.lower, part->lower);
        hull.upper = std::max(hull.upper, part->upper);
    };
    if (upright && axis == 2 && convex.elements.size() > 1)
        for_outer_pieces(convex, distances_from_axis(sweep, u, v), add);
    else
        for (const ProfileElement& element : convex.elements) add(element);
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
