#pragma once

#include <memory>
#include <optional>

#include <Geom_Surface.hxx>

#include "core/cad/reader/bezier_bounds.h"

namespace core::cad {

/// A box of the parameters of a surface.
struct ParameterBox {
    double u0, u1, v0, v1;
};

/// A surface, as far as bounds on its derivatives need it.
class SurfaceModel {
public:
    virtual ~SurfaceModel() = default;

    /// Bounds over a box. Not known for a box beyond the borders of a spline.
    virtual SurfaceDerivativeBounds over(const ParameterBox& box) const = 0;
};

/// A cone: its radius at v is |radius + v slope|, and u is the angle.
struct Cone {
    double radius = 0.0, slope = 0.0;

    double radius_at(double v) const { return radius + v * slope; }
};

/// The cone that a surface is, if it is one; a cylinder is none.
std::optional<Cone> cone_of(const Handle(Geom_Surface) & surface);

/// A sphere whose angles are u around its axis and v from its equator.
struct Ball {
    Vec3 centre = Vec3(0.0);
    double radius = 0.0;
};

/// The sphere that a surface is, if it is one.
std::optional<Ball> ball_of(const Handle(Geom_Surface) & surface);

/// The model of a surface; empty for an offset of a spline and for kinds that are not known here.
std::unique_ptr<SurfaceModel> model_of(const Handle(Geom_Surface) & surface);

} // namespace core::cad
