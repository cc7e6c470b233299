#include "core/cad/reader/surface_model.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <GeomConvert.hxx>
#include <GeomConvert_BSplineSurfaceToBezierSurface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_OffsetSurface.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <TColStd_Array1OfReal.hxx>

#include "core/base/math.h"
#include "core/cad/reader/curve_model.h"

namespace core::cad {

namespace {

class PlaneModel : public SurfaceModel {
public:
    SurfaceDerivativeBounds over(const ParameterBox&) const override { return {.u = 1, .v = 1}; }
};

/// (radius + v slope) (cos u, sin u), v rise: a cone, or a cylinder if `slope` is 0.
class ConeModel : public SurfaceModel {
public:
    ConeModel(double radius, double slope) : radius_(radius), slope_(slope) {}

    SurfaceDerivativeBounds over(const ParameterBox& box) const override {
        const double r =
            std::max(std::abs(radius_ + box.v0 * slope_), std::abs(radius_ + box.v1 * slope_));
        return {.u = r, .v = 1.0, .uu = r, .uv = std::abs(slope_)};
    }

private:
    double radius_, slope_;
};

/// The greatest |sin| or |cos| over a range, from the value in its middle.
double most_of(double value, double from, double to) {
    return std::min(1.0, std::abs(value) + 0.5 * (to - from) + 1e-12);
}

/// (major + minor cos v) (cos u, sin u), minor sin v: a torus, or a sphere if `major` is 0.
class TorusModel : public SurfaceModel {
public:
    TorusModel(double major, double minor) : major_(major), minor_(minor) {}

    SurfaceDerivativeBounds over(const ParameterBox& box) const override {
        const double v = 0.5 * (box.v0 + box.v1);
        const double cosine = std::min(1.0, core::cos(v) + 0.5 * (box.v1 - box.v0) + 1e-12);
        const double least = std::max(-1.0, core::cos(v) - 0.5 * (box.v1 - box.v0) - 1e-12);
        const double r =
            std::max(std::abs(major_ + minor_ * cosine), std::abs(major_ + minor_ * least));
        const double turn = minor_ * most_of(core::sin(v), box.v0, box.v1);
        return {.u = r, .v = minor_, .uu = r, .uv = turn, .vv = minor_};
    }

private:
    double major_, minor_;
};

/// curve(u) + v direction.
class ExtrusionModel : public SurfaceModel {
public:
    explicit ExtrusionModel(std::unique_ptr<CurveModel> curve) : curve_(std::move(curve)) {}

    SurfaceDerivativeBounds over(const ParameterBox& box) const override {
        const DerivativeBounds c = curve_->over(box.u0, box.u1);
        return {.u = c.first.length,
                .v = 1.0,
                .uu = c.second.length,
                .kink_u = c.kink.length,
                .known = c.known};
    }

private:
    std::unique_ptr<CurveModel> curve_;
};

/// curve(v), turned about an axis by u. A point of the curve is at most as far from the axis as the
/// middle of the range, and as the curve is long from there.
class RevolutionModel : public SurfaceModel {
public:
    RevolutionModel(Handle(Geom_Curve) basis, std::unique_ptr<CurveModel> curve)
        : basis_(std::move(basis)), curve_(std::move(curve)) {}

    SurfaceDerivativeBounds over(const ParameterBox& box) const override {
        const DerivativeBounds c = curve_->over(box.v0, box.v1);
        // Along the axis, it goes nowhere.
        const double away = std::min(c.first.length, core::hypot(c.first.each.x, c.first.each.y));
        const gp_Pnt middle = basis_->Value(0.5 * (box.v0 + box.v1));
        const double r = core::hypot(middle.X(), middle.Y()) + 0.5 * (box.v1 - box.v0) * away;
        return {.u = r,
                .v = c.first.length,
                .uu = r,
                .uv = away,
                .vv = c.second.length,
                .kink_v = c.kink.length,
                .known = c.known};
    }

private:
    Handle(Geom_Curve) basis_; // in a frame whose Z is the axis
    std::unique_ptr<CurveModel> curve_;
};

/// One of the two parameters of a spline surface: its knots, and the kinks at them.
struct Direction {
    std::vector<double> knots;
    std::vector<double> kinks; // at each knot; 0 at a border
    double period = 0.0;       // 0: not periodic

    size_t spans() const { return knots.size() - 1; }
    double length(size_t span) const { return knots[span + 1] - knots[span]; }
};

/// Part of a direction: a range of its parameter.
struct Stretch {
    double from, to;
    double kink = 0.0; // sum of the kinks within
};

/// The stretch within the knots that `from` and `to` mean; empty beyond the borders.
std::optional<Stretch> stretch_of(const Direction& direction, double from, double to) {
    const double first = direction.knots.front(), last = direction.knots.back();
    bool is_whole = false;
    if (direction.period > 0.0) {
        const double shift =
            std::floor((0.5 * (from + to) - first) / direction.period) * direction.period;
        from -= shift;
        to -= shift;
        is_whole = from < first || to > last;
    }
    if (is_whole)
        from = first, to = last;
    else if (from < first || to > last)
        return std::nullopt;
    Stretch found{from, to};
    for (size_t i = 0; i < direction.knots.size(); ++i) {
        const bool is_inside = from < direction.knots[i] && direction.knots[i] < to;
        // Across the ends of a period, each kink twice.
        if (is_whole || is_inside) found.kink += direction.kinks[i] * (is_whole ? 2.0 : 1.0);
    }
    return found;
}

/// A spline surface as Bezier patches, each divided into cells when it is first needed.
class SplineModel : public SurfaceModel {
public:
    explicit SplineModel(const Handle(Geom_BSplineSurface) & surface);

    SurfaceDerivativeBounds over(const ParameterBox& box) const override;

private:
    using Cells = std::vector<SurfaceDerivativeBounds>;

    size_t index(size_t i, size_t k) const { return i * v_.spans() + k; }
    const Cells& cells_of(size_t i, size_t k) const;
    void extend_ends(bool in_u);
    void find_kinks(bool by_u);
    void include_cells(SurfaceDerivativeBounds& bounds, size_t i, size_t k, const Stretch& along_u,
                       const Stretch& along_v) const;

    Direction u_, v_;
    std::vector<BezierPatch> patches_;
    int division_ = 1; // cells along each side of a patch
    mutable std::vector<Cells> cells_;
};

Direction direction_of(const TColStd_Array1OfReal& knots, bool is_periodic) {
    Direction direction;
    for (int i = knots.Lower(); i <= knots.Upper(); ++i) direction.knots.push_back(knots(i));
    direction.kinks.resize(direction.knots.size(), 0.0);
    if (is_periodic) direction.period = direction.knots.back() - direction.knots.front();
    return direction;
}

BezierPatch patch_of(const Handle(Geom_BezierSurface) & bezier) {
    BezierPatch patch;
    for (int i = 1; i <= bezier->NbUPoles(); ++i) {
        BezierArc& row = patch.rows.emplace_back();
        for (int k = 1; k <= bezier->NbVPoles(); ++k) {
            const gp_Pnt p = bezier->Pole(i, k);
            row.push_back({Vec3(p.X(), p.Y(), p.Z()), bezier->Weight(i, k)});
        }
    }
    return patch;
}

SplineModel::SplineModel(const Handle(Geom_BSplineSurface) & surface) {
    GeomConvert_BSplineSurfaceToBezierSurface converter(surface);
    TColStd_Array1OfReal knots_u(1, converter.NbUPatches() + 1),
        knots_v(1, converter.NbVPatches() + 1);
    converter.UKnots(knots_u);
    converter.VKnots(knots_v);
    u_ = direction_of(knots_u, surface->IsUPeriodic());
    v_ = direction_of(knots_v, surface->IsVPeriodic());
    for (int i = 1; i <= converter.NbUPatches(); ++i)
        for (int k = 1; k <= converter.NbVPatches(); ++k)
            patches_.push_back(patch_of(converter.Patch(i, k)));
    if (u_.period == 0.0) extend_ends(true);
    if (v_.period == 0.0) extend_ends(false);
    constexpr size_t many = 64;
    division_ = patches_.size() > many ? 2 : 8;
    cells_.resize(patches_.size());
    find_kinks(true);
    find_kinks(false);
}

/// The patch continued before its first row.
BezierPatch extended_in_u(const BezierPatch& patch) {
    BezierPatch columns = transposed(patch);
    for (BezierArc& column : columns.rows) column = extended(column, beyond_ends);
    return transposed(columns);
}

BezierPatch turned_in_u(BezierPatch patch) {
    std::reverse(patch.rows.begin(), patch.rows.end());
    return patch;
}

/// Continues the first and the last patches a little: borders of files lie beyond their splines.
void SplineModel::extend_ends(bool in_u) {
    Direction& along = in_u ? u_ : v_;
    const size_t last = along.spans() - 1, count = (in_u ? v_ : u_).spans();
    for (size_t k = 0; k < count; ++k) {
        BezierPatch& first_patch = patches_[in_u ? index(0, k) : index(k, 0)];
        BezierPatch turned = in_u ? first_patch : transposed(first_patch);
        turned = extended_in_u(turned);
        first_patch = in_u ? turned : transposed(turned);
        BezierPatch& last_patch = patches_[in_u ? index(last, k) : index(k, last)];
        turned = in_u ? last_patch : transposed(last_patch);
        turned = turned_in_u(extended_in_u(turned_in_u(turned)));
        last_patch = in_u ? turned : transposed(turned);
    }
    along.knots.front() -= beyond_ends * along.length(0);
    along.knots.back() += beyond_ends * along.length(last);
}

void SplineModel::find_kinks(bool by_u) {
    Direction &along = by_u ? u_ : v_, &across = by_u ? v_ : u_;
    const auto patch = [&](size_t i, size_t k) {
        return by_u ? patches_[index(i, k)] : transposed(patches_[index(k, i)]);
    };
    const auto kink = [&](size_t before, size_t after) {
        double most = 0.0;
        for (size_t k = 0; k < across.spans(); ++k)
            most = std::max(most, kink_between(patch(before, k), along.length(before),
                                               patch(after, k), along.length(after)));
        return most;
    };
    for (size_t i = 1; i < along.spans(); ++i) along.kinks[i] = kink(i - 1, i);
    if (along.period > 0.0) along.kinks.front() = along.kinks.back() = kink(along.spans() - 1, 0);
}

const SplineModel::Cells& SplineModel::cells_of(size_t i, size_t k) const {
    Cells& cells = cells_[index(i, k)];
    if (cells.empty())
        for (const BezierPatch& part : divided(patches_[index(i, k)], division_))
            cells.push_back(bounds_of(part, u_.length(i) / division_, v_.length(k) / division_));
    return cells;
}

/// The cells of a span that a stretch touches.
std::pair<int, int> touched(const Direction& direction, size_t span, const Stretch& stretch,
                            int division) {
    const double step = direction.length(span) / division, from = direction.knots[span];
    const auto cell = [&](double at) {
        return static_cast<int>(std::clamp((at - from) / step, 0.0, division - 1.0));
    };
    constexpr double slack = 1e-9; // of a cell: rounding
    return {cell(stretch.from - slack * step), cell(stretch.to + slack * step)};
}

void SplineModel::include_cells(SurfaceDerivativeBounds& bounds, size_t i, size_t k,
                                const Stretch& along_u, const Stretch& along_v) const {
    const Cells& cells = cells_of(i, k);
    const auto [u0, u1] = touched(u_, i, along_u, division_);
    const auto [v0, v1] = touched(v_, k, along_v, division_);
    for (int a = u0; a <= u1; ++a)
        for (int b = v0; b <= v1; ++b)
            bounds.include(cells[static_cast<size_t>(a * division_ + b)]);
}

/// The spans that a stretch touches, first and last.
std::pair<size_t, size_t> spans_of(const Direction& direction, const Stretch& stretch) {
    const auto& knots = direction.knots;
    const auto after = std::lower_bound(knots.begin() + 1, knots.end() - 1, stretch.from);
    const auto end = std::upper_bound(knots.begin() + 1, knots.end() - 1, stretch.to);
    const auto first = static_cast<size_t>(after - knots.begin()) - 1;
    return {first, std::max(first, static_cast<size_t>(end - knots.begin()) - 1)};
}

SurfaceDerivativeBounds SplineModel::over(const ParameterBox& box) const {
    const auto along_u = stretch_of(u_, box.u0, box.u1), along_v = stretch_of(v_, box.v0, box.v1);
    if (!along_u || !along_v) return {.known = false};
    SurfaceDerivativeBounds bounds;
    const auto [i0, i1] = spans_of(u_, *along_u);
    const auto [k0, k1] = spans_of(v_, *along_v);
    for (size_t i = i0; i <= i1; ++i)
        for (size_t k = k0; k <= k1; ++k) include_cells(bounds, i, k, *along_u, *along_v);
    bounds.kink_u = along_u->kink;
    bounds.kink_v = along_v->kink;
    return bounds;
}

template <typename Kind>
Handle(Kind) kind_of(const Handle(Geom_Surface) & surface) {
    return Handle(Kind)::DownCast(surface);
}

std::unique_ptr<SurfaceModel> swept_model(const Handle(Geom_Surface) & surface) {
    if (const auto e = kind_of<Geom_SurfaceOfLinearExtrusion>(surface); !e.IsNull()) {
        auto curve = model_of(e->BasisCurve());
        if (curve) return std::make_unique<ExtrusionModel>(std::move(curve));
    }
    if (const auto r = kind_of<Geom_SurfaceOfRevolution>(surface); !r.IsNull()) {
        const gp_Ax1 axis = r->Axis();
        gp_Trsf to_axis;
        to_axis.SetTransformation(gp_Ax3(axis.Location(), axis.Direction()));
        const auto basis = Handle(Geom_Curve)::DownCast(r->BasisCurve()->Transformed(to_axis));
        auto curve = model_of(basis);
        if (curve) return std::make_unique<RevolutionModel>(basis, std::move(curve));
    }
    return {};
}

} // namespace

std::optional<Cone> cone_of(const Handle(Geom_Surface) & surface) {
    if (const auto t = kind_of<Geom_RectangularTrimmedSurface>(surface); !t.IsNull())
        return cone_of(t->BasisSurface());
    const auto cone = kind_of<Geom_ConicalSurface>(surface);
    if (cone.IsNull()) return std::nullopt;
    return Cone{cone->RefRadius(), core::sin(cone->SemiAngle())};
}

std::optional<Ball> ball_of(const Handle(Geom_Surface) & surface) {
    if (const auto t = kind_of<Geom_RectangularTrimmedSurface>(surface); !t.IsNull())
        return ball_of(t->BasisSurface());
    const auto sphere = kind_of<Geom_SphericalSurface>(surface);
    if (sphere.IsNull()) return std::nullopt;
    const gp_Pnt centre = sphere->Location();
    return Ball{{centre.X(), centre.Y(), centre.Z()}, sphere->Radius()};
}

std::unique_ptr<SurfaceModel> model_of(const Handle(Geom_Surface) & surface) {
    if (const auto t = kind_of<Geom_RectangularTrimmedSurface>(surface); !t.IsNull())
        return model_of(t->BasisSurface());
    if (!kind_of<Geom_Plane>(surface).IsNull()) return std::make_unique<PlaneModel>();
    if (const auto c = kind_of<Geom_CylindricalSurface>(surface); !c.IsNull())
        return std::make_unique<ConeModel>(c->Radius(), 0.0);
    if (const auto c = kind_of<Geom_ConicalSurface>(surface); !c.IsNull())
        return std::make_unique<ConeModel>(c->RefRadius(), core::sin(c->SemiAngle()));
    if (const auto s = kind_of<Geom_SphericalSurface>(surface); !s.IsNull())
        return std::make_unique<TorusModel>(0.0, s->Radius());
    if (const auto t = kind_of<Geom_ToroidalSurface>(surface); !t.IsNull())
        return std::make_unique<TorusModel>(t->MajorRadius(), t->MinorRadius());
    if (const auto b = kind_of<Geom_BSplineSurface>(surface); !b.IsNull())
        return std::make_unique<SplineModel>(b);
    if (const auto b = kind_of<Geom_BezierSurface>(surface); !b.IsNull())
        return model_of(GeomConvert::SurfaceToBSplineSurface(b));
    if (const auto o = kind_of<Geom_OffsetSurface>(surface); !o.IsNull() && !o->Surface().IsNull())
        return model_of(o->Surface());
    return swept_model(surface);
}

} // namespace core::cad
