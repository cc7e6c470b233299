#include "core/cad/reader/curve_model.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Geom2dConvert.hxx>
#include <Geom2dConvert_BSplineCurveToBezierCurve.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_BezierCurve.hxx>
#include <Geom2d_Circle.hxx>
#include <Geom2d_Ellipse.hxx>
#include <Geom2d_Hyperbola.hxx>
#include <Geom2d_Line.hxx>
#include <Geom2d_Parabola.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <GeomConvert.hxx>
#include <GeomConvert_BSplineCurveToBezierCurve.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_Circle.hxx>
#include <Geom_Ellipse.hxx>
#include <Geom_Hyperbola.hxx>
#include <Geom_Line.hxx>
#include <Geom_Parabola.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <gp_Lin.hxx>

#include "core/base/math.h"

namespace core::cad {

namespace {

DerivativeBounds unknown_bounds() {
    DerivativeBounds bounds;
    bounds.known = false;
    return bounds;
}

VectorBound same_in_all(double length) { return {length, Vec3(length)}; }

DerivativeBounds plain(double first, double second) {
    return {.first = same_in_all(first), .second = same_in_all(second), .kink = {}};
}

/// A line, a circle or an ellipse.
class RoundModel : public CurveModel {
public:
    RoundModel(double first, double second) : bounds_(plain(first, second)) {}
    explicit RoundModel(const DerivativeBounds& bounds) : bounds_(bounds) {}

    DerivativeBounds over(double, double) const override { return bounds_; }

private:
    DerivativeBounds bounds_;
};

/// t^2 / (4 focal) along the axis, t across it.
class ParabolaModel : public CurveModel {
public:
    explicit ParabolaModel(double focal) : focal_(focal) {}

    DerivativeBounds over(double from, double to) const override {
        const double slope = std::max(std::abs(from), std::abs(to)) / (2.0 * focal_);
        return plain(std::sqrt(1.0 + slope * slope), 1.0 / (2.0 * focal_));
    }

private:
    double focal_;
};

/// major cosh t along the axis, minor sinh t across it.
class HyperbolaModel : public CurveModel {
public:
    HyperbolaModel(double major, double minor) : sum_(major + minor) {}

    DerivativeBounds over(double from, double to) const override {
        const double most = std::max(std::abs(from), std::abs(to));
        const double growth = core::exp(most); // more than cosh and sinh
        return plain(sum_ * growth, sum_ * growth);
    }

private:
    double sum_;
};

/// A spline as Bezier arcs, each divided into four.
class ArcsModel : public CurveModel {
public:
    struct Span {
        double from, to;
        BezierArc arc;
    };

    ArcsModel(const std::vector<Span>& spans, bool is_periodic);

    DerivativeBounds over(double from, double to) const override;

private:
    struct Cell {
        double from, to;
        DerivativeBounds bounds;
    };
    struct Kink {
        double at;
        VectorBound jump;
    };

    void add_cells(const ArcsModel::Span& span);
    void add_kink(double at, const Span& before, const Span& after);
    DerivativeBounds within(double from, double to) const;

    std::vector<Cell> cells_;
    std::vector<Kink> kinks_;
    double period_ = 0.0; // 0: not periodic
};

ArcsModel::ArcsModel(const std::vector<Span>& spans, bool is_periodic) {
    for (const Span& span : spans) add_cells(span);
    for (size_t i = 1; i < spans.size(); ++i) add_kink(spans[i].from, spans[i - 1], spans[i]);
    if (!is_periodic) return;
    period_ = spans.back().to - spans.front().from;
    add_kink(spans.front().from, spans.back(), spans.front());
    add_kink(spans.back().to, spans.back(), spans.front());
}

void ArcsModel::add_cells(const Span& span) {
    const ArcHalves outer = halves(span.arc);
    const ArcHalves low = halves(outer.first), high = halves(outer.second);
    const double length = 0.25 * (span.to - span.from);
    double at = span.from;
    for (const BezierArc& arc : {low.first, low.second, high.first, high.second}) {
        cells_.push_back({at, at + length, bounds_of(arc, length)});
        at += length;
    }
    cells_.back().to = span.to;
}

void ArcsModel::add_kink(double at, const Span& before, const Span& after) {
    const VectorBound jump =
        kink_between(before.arc, before.to - before.from, after.arc, after.to - after.from);
    kinks_.push_back({at, jump});
}

DerivativeBounds ArcsModel::within(double from, double to) const {
    DerivativeBounds bounds;
    const auto first = std::partition_point(cells_.begin(), cells_.end(),
                                            [&](const Cell& cell) { return cell.to < from; });
    for (auto cell = first; cell != cells_.end() && cell->from <= to; ++cell)
        bounds.include(cell->bounds);
    for (const Kink& kink : kinks_)
        if (from < kink.at && kink.at < to) {
            bounds.kink.length += kink.jump.length;
            bounds.kink.each += kink.jump.each;
        }
    return bounds;
}

DerivativeBounds ArcsModel::over(double from, double to) const {
    const double first = cells_.front().from, last = cells_.back().to;
    if (period_ > 0.0) {
        const double shift = std::floor((0.5 * (from + to) - first) / period_) * period_;
        from -= shift;
        to -= shift;
        // Across the ends, the whole curve with the kink there.
        if (from < first || to > last) return within(first - period_, last + period_);
        return within(from, to);
    }
    if (from < first || to > last) return unknown_bounds();
    return within(from, to);
}

template <typename Handle, typename Point>
BezierArc arc_of(const Handle& bezier, Point point) {
    BezierArc arc;
    for (int i = 1; i <= bezier->NbPoles(); ++i)
        arc.push_back({point(bezier->Pole(i)), bezier->Weight(i)});
    return arc;
}

/// Continues the first and the last span a little: curves of files end beyond their splines.
void extend_ends(std::vector<ArcsModel::Span>& spans) {
    ArcsModel::Span &first = spans.front(), &last = spans.back();
    const auto turned = [](BezierArc arc) {
        std::reverse(arc.begin(), arc.end());
        return arc;
    };
    first.arc = extended(first.arc, beyond_ends);
    first.from -= beyond_ends * (first.to - first.from);
    last.arc = turned(extended(turned(last.arc), beyond_ends));
    last.to += beyond_ends * (last.to - last.from);
}

/// The spans of a spline; `Converter` is the one for its dimension.
template <typename Converter, typename Spline, typename Point>
std::unique_ptr<CurveModel> spline_model(const Spline& spline, Point point) {
    Converter converter(spline);
    const int count = converter.NbArcs();
    TColStd_Array1OfReal knots(1, count + 1);
    converter.Knots(knots);
    std::vector<ArcsModel::Span> spans;
    for (int i = 1; i <= count; ++i)
        spans.push_back({knots(i), knots(i + 1), arc_of(converter.Arc(i), point)});
    if (!spline->IsPeriodic()) extend_ends(spans);
    return std::make_unique<ArcsModel>(spans, spline->IsPeriodic());
}

Vec3 in_space(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }
Vec3 in_plane(const gp_Pnt2d& p) { return {p.X(), p.Y(), 0.0}; }

template <typename Kind, typename Base>
Handle(Kind) as(const Base& geometry) {
    return Handle(Kind)::DownCast(geometry);
}

} // namespace

std::unique_ptr<CurveModel> model_of(const Handle(Geom_Curve) & curve) {
    if (const auto trimmed = as<Geom_TrimmedCurve>(curve); !trimmed.IsNull())
        return model_of(trimmed->BasisCurve());
    if (const auto l = as<Geom_Line>(curve); !l.IsNull()) {
        const gp_Dir along = l->Lin().Direction();
        DerivativeBounds bounds;
        bounds.first.include(Vec3(along.X(), along.Y(), along.Z()));
        return std::make_unique<RoundModel>(bounds);
    }
    if (const auto c = as<Geom_Circle>(curve); !c.IsNull())
        return std::make_unique<RoundModel>(c->Radius(), c->Radius());
    if (const auto e = as<Geom_Ellipse>(curve); !e.IsNull())
        return std::make_unique<RoundModel>(e->MajorRadius(), e->MajorRadius());
    if (const auto p = as<Geom_Parabola>(curve); !p.IsNull())
        return std::make_unique<ParabolaModel>(p->Focal());
    if (const auto h = as<Geom_Hyperbola>(curve); !h.IsNull())
        return std::make_unique<HyperbolaModel>(h->MajorRadius(), h->MinorRadius());
    if (const auto b = as<Geom_BSplineCurve>(curve); !b.IsNull())
        return spline_model<GeomConvert_BSplineCurveToBezierCurve>(b, in_space);
    if (const auto b = as<Geom_BezierCurve>(curve); !b.IsNull())
        return model_of(GeomConvert::CurveToBSplineCurve(b));
    return {};
}

std::unique_ptr<CurveModel> model_of(const Handle(Geom2d_Curve) & curve) {
    if (const auto trimmed = as<Geom2d_TrimmedCurve>(curve); !trimmed.IsNull())
        return model_of(trimmed->BasisCurve());
    if (const auto l = as<Geom2d_Line>(curve); !l.IsNull()) {
        DerivativeBounds bounds;
        bounds.first.include(Vec3(l->Direction().X(), l->Direction().Y(), 0.0));
        return std::make_unique<RoundModel>(bounds);
    }
    if (const auto c = as<Geom2d_Circle>(curve); !c.IsNull())
        return std::make_unique<RoundModel>(c->Radius(), c->Radius());
    if (const auto e = as<Geom2d_Ellipse>(curve); !e.IsNull())
        return std::make_unique<RoundModel>(e->MajorRadius(), e->MajorRadius());
    if (const auto p = as<Geom2d_Parabola>(curve); !p.IsNull())
        return std::make_unique<ParabolaModel>(p->Focal());
    if (const auto h = as<Geom2d_Hyperbola>(curve); !h.IsNull())
        return std::make_unique<HyperbolaModel>(h->MajorRadius(), h->MinorRadius());
    if (const auto b = as<Geom2d_BSplineCurve>(curve); !b.IsNull())
        return spline_model<Geom2dConvert_BSplineCurveToBezierCurve>(b, in_plane);
    if (const auto b = as<Geom2d_BezierCurve>(curve); !b.IsNull())
        return model_of(Geom2dConvert::CurveToBSplineCurve(b));
    return {};
}

} // namespace core::cad
