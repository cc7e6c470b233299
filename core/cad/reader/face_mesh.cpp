#include "core/cad/reader/face_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Geom2d_Line.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <gp_Pnt.hxx>
#include <gp_Pnt2d.hxx>

#include "core/base/math.h"
#include "core/cad/reader/surface_model.h"

namespace core::cad {

namespace {

constexpr double measured_factor = 2.0; // on the greatest measured deviation, where none is proven

double square(double x) { return x * x; }

/// The increase of a deviation by second derivatives over a chord: 8 times its bound.
double bend(const SurfaceDerivativeBounds& bounds, double du, double dv) {
    return bounds.uu * square(du) + 2.0 * bounds.uv * std::abs(du * dv) + bounds.vv * square(dv);
}

double kinks(const SurfaceDerivativeBounds& bounds, double du, double dv) {
    return bounds.kink_u * std::abs(du) + bounds.kink_v * std::abs(dv);
}

/// The bound on the deviation of a linear interpolation over parameters that differ by these.
double interpolation_bound(const SurfaceDerivativeBounds& bounds, double du, double dv) {
    return 0.125 * bend(bounds, du, dv) + 0.25 * kinks(bounds, du, dv);
}

template <size_t count>
ParameterBox box_of(const std::array<const FaceNode*, count>& nodes) {
    ParameterBox box{nodes[0]->u, nodes[0]->u, nodes[0]->v, nodes[0]->v};
    for (const FaceNode* node : nodes) {
        box.u0 = std::min(box.u0, node->u);
        box.u1 = std::max(box.u1, node->u);
        box.v0 = std::min(box.v0, node->v);
        box.v1 = std::max(box.v1, node->v);
    }
    return box;
}

} // namespace

Side side_of(uint32_t a, uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

Vec3 FaceMesh::point_at(double u, double v) const {
    const gp_Pnt p = adaptor_ ? adaptor_->Value(u, v) : surface->Value(u, v);
    return {p.X(), p.Y(), p.Z()};
}

Singular FaceMesh::singular_at(uint32_t node) const {
    const auto found = singular.find(nodes[node].point);
    return found == singular.end() ? Singular::none : found->second;
}

// The corners are put where the parameters are equal in which the surface is singular: a triangle
// at a pole is the image of a strip between two meridians (README.md).
FaceMesh::Judged FaceMesh::judge_proven(const std::array<uint32_t, 3>& triangle,
                                        const std::vector<Vec3>& points) {
    std::array<FaceNode, 3> n{};
    std::array<Singular, 3> kind{};
    size_t poles = 0;
    for (size_t i = 0; i < 3; ++i) {
        n[i] = nodes[triangle[i]];
        kind[i] = singular_at(triangle[i]);
        poles += kind[i] != Singular::none;
    }
    // Of those that cost about as much, the shortest: a diagonal only looks as bad as a side.
    const auto worst_side = [&](auto cost) {
        constexpr double about = 0.9;
        std::array<double, 3> costs{}, lengths{};
        for (size_t i = 0; i < 3; ++i) {
            const size_t k = (i + 1) % 3;
            costs[i] = cost(i, k);
            lengths[i] = glm::distance(points[n[i].point], points[n[k].point]);
        }
        const double most = std::max({costs[0], costs[1], costs[2]});
        size_t worst = 3;
        for (size_t i = 0; i < 3; ++i)
            if (costs[i] >= about * most && (worst == 3 || lengths[i] < lengths[worst])) worst = i;
        Judged judged;
        judged.worst = side_of(triangle[worst % 3], triangle[(worst + 1) % 3]);
        return judged;
    };
    if (poles == 0) {
        const ParameterBox box = box_of<3>({&n[0], &n[1], &n[2]});
        const SurfaceDerivativeBounds bounds = model->over(box);
        Judged judged = worst_side([&](size_t i, size_t k) {
            const double du = n[i].u - n[k].u, dv = n[i].v - n[k].v;
            return bend(bounds, du, dv) + 2.0 * kinks(bounds, du, dv);
        });
        judged.deviation =
            bounds.known ? interpolation_bound(bounds, box.u1 - box.u0, box.v1 - box.v0) : -2.0;
        return judged;
    }
    if (poles == 1) {
        size_t pole = 0;
        while (kind[pole] == Singular::none) ++pole;
        const size_t a = (pole + 1) % 3, b = (pole + 2) % 3;
        const bool in_u = kind[pole] == Singular::in_u;
        const auto meridian = [&](size_t i) { // the pole's node on the meridian of corner i
            return in_u ? FaceNode{n[i].u, n[pole].v} : FaceNode{n[pole].u, n[i].v};
        };
        const FaceNode pa = meridian(a), pb = meridian(b);
        const SurfaceDerivativeBounds bounds = model->over(box_of<4>({&n[a], &n[b], &pa, &pb}));
        const auto along = [&](size_t i) {
            return in_u ? interpolation_bound(bounds, 0.0, n[i].v - n[pole].v)
                        : interpolation_bound(bounds, n[i].u - n[pole].u, 0.0);
        };
        const double across = interpolation_bound(bounds, n[a].u - n[b].u, n[a].v - n[b].v);
        Judged judged = worst_side([&](size_t i, size_t k) {
            return i == pole ? along(k) : k == pole ? along(i) : across;
        });
        judged.deviation = bounds.known ? std::max(along(a), along(b)) + across : -2.0;
        return judged;
    }
    const bool is_flat =
        n[0].point == n[1].point || n[1].point == n[2].point || n[2].point == n[0].point;
    // Two corners at one pole: a meridian, which belongs to its neighbours as well.
    if (poles == 2 && is_flat) return {0.0, side_of(triangle[0], triangle[1])};
    Judged judged = worst_side([&](size_t i, size_t k) {
        return n[i].point == n[k].point ? 0.0
                                        : std::abs(n[i].u - n[k].u) + std::abs(n[i].v - n[k].v);
    });
    judged.deviation = is_flat ? 0.0 : std::numeric_limits<double>::infinity();
    return judged;
}

// Moves each point of the triangle away from the axis onto the cone (README.md).
FaceMesh::Judged FaceMesh::judge_cone(const std::array<uint32_t, 3>& triangle) const {
    double least_u = infinity, most_u = -infinity, least_r = infinity, most_r = -infinity;
    Judged judged;
    double longest = -1.0;
    for (size_t i = 0; i < 3; ++i) {
        const FaceNode &a = nodes[triangle[i]], &b = nodes[triangle[(i + 1) % 3]];
        const bool at_apex = singular_at(triangle[i]) != Singular::none;
        const bool one_at_apex = at_apex || singular_at(triangle[(i + 1) % 3]) != Singular::none;
        const double length = one_at_apex ? 0.0 : std::abs(a.u - b.u);
        if (length > longest)
            longest = length, judged.worst = side_of(triangle[i], triangle[(i + 1) % 3]);
        if (at_apex) continue;
        least_u = std::min(least_u, a.u);
        most_u = std::max(most_u, a.u);
        least_r = std::min(least_r, cone->radius_at(a.v));
        most_r = std::max(most_r, cone->radius_at(a.v));
    }
    const double span = std::max(0.0, most_u - least_u);
    const bool has_one_side = least_r >= 0.0 || most_r <= 0.0;
    constexpr double widest = 3.0; // rad, less than half a turn
    judged.deviation = infinity;
    if (span < widest && has_one_side)
        judged.deviation =
            std::max(std::abs(least_r), std::abs(most_r)) * (1.0 - core::cos(0.5 * span));
    if (span == 0.0) judged.deviation = 0.0; // also with no corner but the apex
    return judged;
}

// Moves each point of the triangle away from the centre onto the sphere. No point of the triangle
// is nearer to the centre than its plane, nor than its corners in the direction of their mean.
FaceMesh::Judged FaceMesh::judge_ball(const std::array<uint32_t, 3>& triangle,
                                      const std::vector<Vec3>& points) const {
    std::array<Vec3, 3> p{};
    for (size_t i = 0; i < 3; ++i) p[i] = points[nodes[triangle[i]].point] - ball->centre;
    Judged judged;
    double longest = -1.0;
    for (size_t i = 0; i < 3; ++i) {
        const double length = glm::distance(p[i], p[(i + 1) % 3]);
        if (length > longest)
            longest = length, judged.worst = side_of(triangle[i], triangle[(i + 1) % 3]);
    }
    const Vec3 mean = p[0] + p[1] + p[2], across = glm::cross(p[1] - p[0], p[2] - p[0]);
    double least = 0.0;
    if (const double size = glm::length(across); size > 0.0)
        least = std::abs(glm::dot(across, p[0])) / size;
    if (const double size = glm::length(mean); size > 0.0)
        least = std::max(
            least,
            std::min({glm::dot(mean, p[0]), glm::dot(mean, p[1]), glm::dot(mean, p[2])}) / size);
    judged.deviation = least > 0.0 ? std::max(0.0, ball->radius - least) : infinity;
    return judged;
}

// Chord and border are apart by what both bend; on the sphere by up to pi / 2 times that.
double FaceMesh::bow_on_ball(const BorderPiece& piece, const DerivativeBounds& curve,
                             const SurfaceDerivativeBounds& bounds) const {
    constexpr double half_turn_by_chord = 1.5707963267948968; // pi / 2, rounded up
    if (curve.first.each.x == 0.0) return 0.0;                // a meridian: the chord moves onto it
    const Vec3 a = point_at(nodes[piece.first].u, nodes[piece.first].v),
               b = point_at(nodes[piece.last].u, nodes[piece.last].v);
    const double chord = glm::distance(a, b), radius = ball->radius;
    const double sagitta =
        radius - std::sqrt(std::max(0.0, radius * radius - 0.25 * chord * chord));
    const Vec3 d = curve.first.each, dd = curve.second.each;
    const double length = std::abs(piece.to - piece.from);
    const double bent = bounds.uu * square(d.x) + 2.0 * bounds.uv * d.x * d.y
                        + bounds.vv * square(d.y) + bounds.u * dd.x + bounds.v * dd.y;
    const double kink = bounds.u * curve.kink.each.x + bounds.v * curve.kink.each.y;
    return half_turn_by_chord * (sagitta + 0.125 * square(length) * bent + 0.25 * length * kink);
}

// A chord moved away from the axis, r(t) e(t), runs at the angle of (1 - s) e(a) + s e(b) with
// s = t r(b) / r(t), not at that of s = t. |s - t| is at most the ratio below.
double FaceMesh::bow_on_cone(const FaceNode& a, const FaceNode& b) const {
    const double ra = std::sqrt(std::abs(cone->radius_at(a.v))),
                 rb = std::sqrt(std::abs(cone->radius_at(b.v)));
    const double half = 0.5 * std::abs(a.u - b.u);
    if (half == 0.0 || a.v == b.v) return 0.0; // both run along one line, or one circle
    if (half >= 1.5) return infinity;
    const double shift = 2.0 * half * std::abs(ra - rb) / (ra + rb) + core::tan(half) - half;
    return std::max(ra * ra, rb * rb) * shift;
}

FaceMesh::Judged FaceMesh::judge_measured(const std::array<uint32_t, 3>& triangle,
                                          const std::vector<Vec3>& points) const {
    constexpr int steps = 3;
    const FaceNode &a = nodes[triangle[0]], &b = nodes[triangle[1]], &c = nodes[triangle[2]];
    const auto off = [&](double x, double y, double z) {
        const Vec3 flat = x * points[a.point] + y * points[b.point] + z * points[c.point];
        return glm::distance(flat,
                             point_at(x * a.u + y * b.u + z * c.u, x * a.v + y * b.v + z * c.v));
    };
    Judged judged;
    for (int i = 0; i <= steps; ++i)
        for (int k = 0; i + k <= steps; ++k) {
            const double x = static_cast<double>(i) / steps, y = static_cast<double>(k) / steps;
            judged.deviation = std::max(judged.deviation, measured_factor * off(x, y, 1 - x - y));
        }
    // An S has no deviation in its middle.
    const auto along = [&](const auto& at) {
        return std::max({at(1.0 / 3.0), at(0.5), at(2.0 / 3.0)});
    };
    const std::array<double, 3> sides = {along([&](double x) { return off(x, 1.0 - x, 0.0); }),
                                         along([&](double x) { return off(0.0, x, 1.0 - x); }),
                                         along([&](double x) { return off(x, 0.0, 1.0 - x); })};
    const size_t worst =
        static_cast<size_t>(std::max_element(sides.begin(), sides.end()) - sides.begin());
    judged.worst = side_of(triangle[worst], triangle[(worst + 1) % 3]);
    return judged;
}

FaceMesh::Judged FaceMesh::judge(const std::array<uint32_t, 3>& triangle,
                                 const std::vector<Vec3>& points) {
    if (is_plane) return {0.0, {}};
    if (cone) return judge_cone(triangle);
    if (ball) return judge_ball(triangle, points);
    if (model) {
        const Judged proven = judge_proven(triangle, points);
        if (proven.deviation >= 0.0) return proven;
    }
    is_proven = false;
    return judge_measured(triangle, points);
}

// With L(t) linear between the nodes and P(t) the border, |P - L| is at most what P bends between
// its own ends, plus the greater distance of an end from its node.
std::optional<double> FaceMesh::sliver_proven(const BorderPiece& piece) const {
    const Border& border = borders[piece.border];
    if (!border.model || !(model || is_plane)) return std::nullopt;
    const DerivativeBounds curve =
        border.model->over(std::min(piece.from, piece.to), std::max(piece.from, piece.to));
    if (!curve.known) return std::nullopt;
    const double length = std::abs(piece.to - piece.from);
    const FaceNode &a = nodes[piece.first], &b = nodes[piece.last];
    const gp_Pnt2d p = border.curve->Value(piece.from), q = border.curve->Value(piece.to);
    const Vec3 ends = glm::max(glm::abs(Vec3(p.X() - a.u, p.Y() - a.v, 0.0)),
                               glm::abs(Vec3(q.X() - b.u, q.Y() - b.v, 0.0)));
    Vec3 off = 0.125 * square(length) * curve.second.each + 0.25 * length * curve.kink.each + ends;
    // At a pole, the parameter in which it is singular is that of the other node (README.md).
    const Singular at_a = singular_at(piece.first), at_b = singular_at(piece.last);
    const Singular pole = at_a != Singular::none ? at_a : at_b;
    if (pole != Singular::none) {
        const bool in_u = pole == Singular::in_u;
        const int axis = in_u ? 0 : 1;
        const bool at_first = at_a != Singular::none;
        const double own =
            at_first ? (in_u ? q.X() - b.u : q.Y() - b.v) : (in_u ? p.X() - a.u : p.Y() - a.v);
        off[axis] = std::abs(own) + length * curve.first.each[axis];
    }
    if (is_plane) return glm::length(off);
    const double bow = cone && pole == Singular::none ? bow_on_cone(a, b) : 0.0;
    if (off.x == 0.0 && off.y == 0.0 && !ball) return bow;
    ParameterBox box = box_of<2>({&a, &b});
    box.u0 = std::min({box.u0, p.X(), q.X()}) - off.x;
    box.u1 = std::max({box.u1, p.X(), q.X()}) + off.x;
    box.v0 = std::min({box.v0, p.Y(), q.Y()}) - off.y;
    box.v1 = std::max({box.v1, p.Y(), q.Y()}) + off.y;
    const SurfaceDerivativeBounds bounds = model->over(box);
    if (!bounds.known) return std::nullopt;
    if (ball)
        return bow_on_ball(piece, curve, bounds)
               + (pole == Singular::none ? bounds.u * ends.x + bounds.v * ends.y
                                         : bounds.u * off.x + bounds.v * ends.y);
    return bow + bounds.u * off.x + bounds.v * off.y;
}

double FaceMesh::sliver_measured(const BorderPiece& piece) const {
    constexpr int steps = 16;
    const FaceNode &a = nodes[piece.first], &b = nodes[piece.last];
    double most = 0.0;
    for (int i = 0; i <= steps; ++i) {
        const double x = static_cast<double>(i) / steps;
        const gp_Pnt2d p =
            borders[piece.border].curve->Value(piece.from + x * (piece.to - piece.from));
        most =
            std::max(most, glm::distance(point_at(p.X(), p.Y()),
                                         point_at(a.u + x * (b.u - a.u), a.v + x * (b.v - a.v))));
    }
    return measured_factor * most;
}

namespace {

/// How far points of a curve of a spline surface, at a constant parameter, can be from each other:
/// the curve is in the hull of its poles. Empty for other surfaces, and for weights that are not
/// positive.
std::optional<double> extent_of_poles(const Handle(Geom_Surface) & surface, bool at_constant_u,
                                      double parameter) {
    const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface);
    const auto spline =
        Handle(Geom_BSplineSurface)::DownCast(trimmed.IsNull() ? surface : trimmed->BasisSurface());
    if (spline.IsNull()) return std::nullopt;
    const Handle(Geom_Curve) iso =
        at_constant_u ? spline->UIso(parameter) : spline->VIso(parameter);
    const auto curve = Handle(Geom_BSplineCurve)::DownCast(iso);
    if (curve.IsNull()) return std::nullopt;
    const gp_Pnt first = curve->Pole(1);
    double farthest = 0.0;
    for (int i = 1; i <= curve->NbPoles(); ++i) {
        if (!(curve->Weight(i) > 0.0)) return std::nullopt;
        farthest = std::max(farthest, first.Distance(curve->Pole(i)));
    }
    return 2.0 * farthest; // any two of them
}

} // namespace

// A pole of a file is a point only within its tolerance.
double FaceMesh::extent_of_pole(const BorderPiece& piece) {
    const Border& border = borders[piece.border];
    const gp_Pnt2d p = border.curve->Value(piece.from), q = border.curve->Value(piece.to);
    const bool is_line = !Handle(Geom2d_Line)::DownCast(border.curve).IsNull();
    if (is_line && (p.X() == q.X() || p.Y() == q.Y()))
        if (const auto extent =
                extent_of_poles(surface, p.X() == q.X(), p.X() == q.X() ? p.X() : p.Y()))
            return *extent;
    if (border.model && model) {
        const DerivativeBounds curve =
            border.model->over(std::min(piece.from, piece.to), std::max(piece.from, piece.to));
        const Vec3 way = std::abs(piece.to - piece.from) * curve.first.each;
        const SurfaceDerivativeBounds bounds =
            model->over({std::min(p.X(), q.X()) - way.x, std::max(p.X(), q.X()) + way.x,
                         std::min(p.Y(), q.Y()) - way.y, std::max(p.Y(), q.Y()) + way.y});
        if (curve.known && bounds.known) return bounds.u * way.x + bounds.v * way.y;
    }
    is_proven = false;
    constexpr int steps = 16;
    double most = 0.0;
    for (int i = 1; i <= steps; ++i) {
        const gp_Pnt2d at = border.curve->Value(
            piece.from + static_cast<double>(i) / steps * (piece.to - piece.from));
        most = std::max(most, glm::distance(point_at(p.X(), p.Y()), point_at(at.X(), at.Y())));
    }
    return measured_factor * most;
}

double FaceMesh::sliver(const BorderPiece& piece) {
    if (const auto proven = sliver_proven(piece)) return *proven;
    is_proven = false;
    return sliver_measured(piece);
}

void FaceMesh::judge_all(const std::vector<Vec3>& points) {
    if (!adaptor_) adaptor_.emplace(surface);
    judged_.resize(triangles.size());
    for (size_t i = 0; i < triangles.size(); ++i)
        if (judged_[i].deviation < 0.0) judged_[i] = judge(triangles[i], points);
    for (const auto& [side, piece] : pieces) {
        if (slivers_.contains(side)) continue;
        const bool is_pole = borders[piece.border].is_degenerate;
        slivers_[side] = is_pole ? 0.0 : sliver(piece);
        if (is_pole) poles_[side] = extent_of_pole(piece);
    }
    for (; gap_nodes_ < nodes.size(); ++gap_nodes_) {
        const FaceNode& node = nodes[gap_nodes_];
        gap_ = std::max(gap_, glm::distance(points[node.point], point_at(node.u, node.v)));
    }
}

FaceDeviation FaceMesh::measured_by(const std::vector<Vec3>& points) {
    judge_all(points);
    FaceDeviation deviation;
    for (const Judged& triangle : judged_)
        deviation.inside = std::max(deviation.inside, triangle.deviation);
    for (const auto& [side, width] : slivers_)
        deviation.borders = std::max(deviation.borders, width);
    deviation.gap = gap_;
    double tolerance = 0.0;
    for (const Border& border : borders) tolerance = std::max(tolerance, border.tolerance);
    deviation.gap += tolerance;
    for (const auto& [side, extent] : poles_) deviation.gap += extent;
    return deviation;
}

double FaceMesh::area_of(const std::array<uint32_t, 3>& triangle) const {
    const auto& [a, b, c] = triangle;
    const FaceNode &p = nodes[a], &q = nodes[b], &r = nodes[c];
    return (q.u - p.u) * (r.v - p.v) - (q.v - p.v) * (r.u - p.u);
}

/// Replaces the common side of two triangles by the other diagonal if that is better.
bool FaceMesh::flip(uint32_t first, uint32_t second, const Side& side,
                    const std::vector<Vec3>& points) {
    const auto opposite = [&](const std::array<uint32_t, 3>& triangle) {
        size_t i = 0;
        while (triangle[i] == side.first || triangle[i] == side.second) ++i;
        return i;
    };
    const auto &t = triangles[first], &s = triangles[second];
    const size_t i = opposite(t), k = opposite(s);
    const uint32_t a = t[i], b = t[(i + 1) % 3], c = t[(i + 2) % 3], d = s[k];
    for (const uint32_t node : {a, b, c, d})
        if (singular_at(node) != Singular::none) return false;
    const std::array<uint32_t, 3> low = {a, b, d}, high = {a, d, c};
    const double area = area_of(t);
    // Else a side would be put back that was just divided.
    constexpr double least_part = 1e-3;
    const double least = least_part * (std::abs(area) + std::abs(area_of(s)));
    const double sign = area > 0.0 ? 1.0 : -1.0;
    if (a == d || !(sign * area_of(s) > 0.0) || !(sign * area_of(low) > least)
        || !(sign * area_of(high) > least))
        return false;
    const Judged of_low = judge(low, points), of_high = judge(high, points);
    const double before = std::max(judged_[first].deviation, judged_[second].deviation);
    if (!(std::max(of_low.deviation, of_high.deviation) < 0.95 * before)) return false;
    triangles[first] = low;
    triangles[second] = high;
    judged_[first] = of_low;
    judged_[second] = of_high;
    return true;
}

std::vector<FaceMesh::SideUse> FaceMesh::sides_near(double limit) const {
    std::vector<bool> is_near(nodes.size(), false); // a corner of a triangle beyond the limit
    for (size_t i = 0; i < triangles.size(); ++i)
        if (judged_[i].deviation > limit)
            for (const uint32_t node : triangles[i]) is_near[node] = true;
    std::vector<SideUse> uses;
    for (uint32_t i = 0; i < triangles.size(); ++i)
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t a = triangles[i][k], b = triangles[i][(k + 1) % 3];
            if (is_near[a] && is_near[b]) uses.push_back({side_of(a, b), i});
        }
    std::sort(uses.begin(), uses.end(), [](const SideUse& a, const SideUse& b) {
        return a.side != b.side ? a.side < b.side : a.triangle < b.triangle;
    });
    return uses;
}

/// Flips sides of triangles that deviate by more than the limit, as long as it helps.
void FaceMesh::flip_sides(const std::vector<Vec3>& points, double limit) {
    constexpr int most_rounds = 3;
    std::vector<int> changed(triangles.size(), -1); // in which round
    const auto is_bad = [&](uint32_t i) { return judged_[i].deviation > limit; };
    bool any = true;
    for (int round = 0; any && round < most_rounds; ++round) {
        any = false;
        const std::vector<SideUse> uses = sides_near(limit);
        for (size_t i = 0; i + 1 < uses.size(); ++i) {
            const uint32_t a = uses[i].triangle, b = uses[i + 1].triangle;
            if (uses[i].side != uses[i + 1].side || !(is_bad(a) || is_bad(b))) continue;
            if (changed[a] == round || changed[b] == round || pieces.contains(uses[i].side))
                continue;
            if (!flip(a, b, uses[i].side, points)) continue;
            changed[a] = changed[b] = round;
            any = true;
        }
    }
}

bool FaceMesh::mark(const std::vector<Vec3>& points, double wanted, std::set<size_t>& segments) {
    marked_.clear();
    FaceDeviation now = measured_by(points);
    const double goal = std::max(0.5 * wanted, wanted - now.gap);
    if (now.inside + now.borders <= goal) return false;
    flip_sides(points, std::max(goal - goal / 3.0, goal - now.borders));
    now = measured_by(points);
    if (now.inside + now.borders <= goal) return false;
    const double for_borders = std::max(goal / 3.0, goal - now.inside);
    const double for_inside = std::max(goal - goal / 3.0, goal - now.borders);
    bool any = false;
    const auto add = [&](const Side& side) {
        any = true;
        const auto piece = pieces.find(side);
        if (piece == pieces.end())
            marked_.insert(side);
        else
            segments.insert(piece->second.segment);
    };
    for (size_t i = 0; i < triangles.size(); ++i)
        if (judged_[i].deviation > for_inside) add(judged_[i].worst);
    for (const auto& [side, width] : slivers_)
        if (width > for_borders) add(side);
    return any;
}

void FaceMesh::mark_triangle(size_t triangle, const std::vector<Vec3>& points,
                             std::set<size_t>& segments) {
    std::optional<Side> longest;
    double length = -1.0;
    for (size_t k = 0; k < 3; ++k) {
        const uint32_t a = triangles[triangle][k], b = triangles[triangle][(k + 1) % 3];
        const double own = glm::distance(points[nodes[a].point], points[nodes[b].point]);
        if (pieces.contains(side_of(a, b)) || own <= length) continue;
        length = own;
        longest = side_of(a, b);
    }
    if (longest)
        marked_.insert(*longest);
    else
        for (size_t k = 0; k < 3; ++k)
            segments.insert(
                pieces.at(side_of(triangles[triangle][k], triangles[triangle][(k + 1) % 3]))
                    .segment);
}

uint32_t FaceMesh::divide_piece(const BorderPiece& piece, const SegmentHalves& halves) {
    const double middle = 0.5 * (piece.from + piece.to);
    const gp_Pnt2d p = borders[piece.border].curve->Value(middle);
    const auto node = static_cast<uint32_t>(nodes.size());
    nodes.push_back({p.X(), p.Y(), halves.middle});
    pieces[side_of(piece.first, node)] = {piece.border, halves.before, piece.first,
                                          node,         piece.from,    middle};
    pieces[side_of(node, piece.last)] = {piece.border, halves.after, node,
                                         piece.last,   middle,       piece.to};
    return node;
}

uint32_t FaceMesh::divide_side(const Side& side, std::vector<Vec3>& points) {
    FaceNode a = nodes[side.first], b = nodes[side.second];
    const Singular at_a = singular_at(side.first), at_b = singular_at(side.second);
    if (at_a == Singular::in_u)
        a.u = b.u;
    else if (at_b == Singular::in_u)
        b.u = a.u;
    if (at_a == Singular::in_v)
        a.v = b.v;
    else if (at_b == Singular::in_v)
        b.v = a.v;
    const auto node = static_cast<uint32_t>(nodes.size());
    nodes.push_back({0.5 * (a.u + b.u), 0.5 * (a.v + b.v), static_cast<uint32_t>(points.size())});
    points.push_back(point_at(nodes[node].u, nodes[node].v));
    return node;
}

void FaceMesh::divide(std::vector<Vec3>& points, const std::map<size_t, SegmentHalves>& halves) {
    if (!adaptor_) adaptor_.emplace(surface);
    std::map<Side, uint32_t> middles;
    std::vector<std::pair<Side, BorderPiece>> divided;
    for (const auto& [side, piece] : pieces)
        if (halves.contains(piece.segment)) divided.emplace_back(side, piece);
    for (const auto& [side, piece] : divided) {
        pieces.erase(side);
        slivers_.erase(side);
        poles_.erase(side);
        middles[side] = divide_piece(piece, halves.at(piece.segment));
    }
    for (const Side& side : marked_) middles[side] = divide_side(side, points);
    marked_.clear();
    if (middles.empty()) return;

    judged_.resize(triangles.size());
    const size_t count = triangles.size();
    const auto middle = [&](uint32_t a, uint32_t b) {
        const auto found = middles.find(side_of(a, b));
        return found == middles.end() ? UINT32_MAX : found->second;
    };
    for (size_t i = 0; i < count; ++i) {
        auto [a, b, c] = triangles[i];
        std::array<uint32_t, 3> m = {middle(a, b), middle(b, c), middle(c, a)};
        const auto marks = 3 - std::count(m.begin(), m.end(), UINT32_MAX);
        if (marks == 0) continue;
        // Turned so that the first side is divided, and with two the last is not.
        while (m[0] == UINT32_MAX || (marks == 2 && m[2] != UINT32_MAX)) {
            std::rotate(m.begin(), m.begin() + 1, m.end());
            const uint32_t first = a;
            a = b, b = c, c = first;
        }
        const auto add = [&](uint32_t x, uint32_t y, uint32_t z) {
            triangles.push_back({x, y, z});
            judged_.emplace_back();
        };
        judged_[i] = {};
        if (marks == 1) {
            triangles[i] = {a, m[0], c};
            add(m[0], b, c);
        } else if (marks == 2) {
            triangles[i] = {m[0], b, m[1]};
            add(a, m[0], m[1]);
            add(a, m[1], c);
        } else {
            triangles[i] = {m[0], m[1], m[2]};
            add(a, m[0], m[2]);
            add(m[0], b, m[1]);
            add(m[2], m[1], c);
        }
    }
}

std::string FaceMesh::why_no_cover() const {
    struct Use {
        Side side;
        int step; // 1: from the lower to the higher node, -1: back
    };
    std::vector<Use> uses;
    const auto add = [&](uint32_t from, uint32_t to) {
        // A chord along a pole is one point of space.
        if (nodes[from].point != nodes[to].point)
            uses.push_back({side_of(from, to), from < to ? 1 : -1});
    };
    for (const auto& [a, b, c] : triangles) add(a, b), add(b, c), add(c, a);
    for (const auto& [side, piece] : pieces) {
        const Border& border = borders[piece.border];
        if (border.is_inside) continue;
        if (border.is_reversed)
            add(piece.first, piece.last);
        else
            add(piece.last, piece.first);
    }
    std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) { return a.side < b.side; });
    for (size_t i = 0, end = 0; i < uses.size(); i = end) {
        int balance = 0;
        for (end = i; end < uses.size() && uses[end].side == uses[i].side; ++end)
            balance += uses[end].step;
        if (balance != 0) return "its triangles do not end at its borders";
    }
    return {};
}

} // namespace core::cad
