#pragma once

#include <memory>

#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>

#include "core/cad/reader/bezier_bounds.h"

namespace core::cad {

/// A curve, as far as bounds on its derivatives need it.
class CurveModel {
public:
    virtual ~CurveModel() = default;

    /// Bounds over a range of the parameter. Not known for a range beyond the ends of a spline.
    virtual DerivativeBounds over(double from, double to) const = 0;
};

/// How far beyond its ends a spline is known, as a part of its first and last span.
constexpr double beyond_ends = 0.01;

/// The model of a curve in space; empty for offset curves and for kinds that are not known here.
std::unique_ptr<CurveModel> model_of(const Handle(Geom_Curve) & curve);

/// The model of a curve in the parameters of a surface, as a curve at z = 0.
std::unique_ptr<CurveModel> model_of(const Handle(Geom2d_Curve) & curve);

} // namespace core::cad
