#pragma once

#include <vector>

#include "core/base/vec.h"

namespace core::cad {

/// Poles of a Bezier curve with their weights, which are 1 unless it is rational.
struct WeightedPole {
    Vec3 at;
    double weight = 1.0;
};
using BezierArc = std::vector<WeightedPole>;

/// Greatest absolute values of a vector: of its length, and of each coordinate.
struct VectorBound {
    double length = 0.0;
    Vec3 each = Vec3(0.0);

    void include(const Vec3& v);
    void include(const VectorBound& other);
};

/// Bounds on the derivatives of a curve over a range.
struct DerivativeBounds {
    VectorBound first, second;
    VectorBound kink; // sum over the kinks within the range: by how much the first derivative jumps
    bool known = true; // false: one of its weights is not positive, so that nothing is proven

    void include(const DerivativeBounds& other);
};

/// Bounds on the derivatives of an arc that is run through over a range of this length.
DerivativeBounds bounds_of(const BezierArc& arc, double length);

/// The two halves of an arc.
struct ArcHalves {
    BezierArc first, second;
};
ArcHalves halves(const BezierArc& arc);

/// The arc continued before its start by `before` of its range, as evaluation beyond the ends does.
BezierArc extended(const BezierArc& arc, double before);

/// By how much the first derivative jumps between two arcs that follow each other, run through over
/// ranges of these lengths.
VectorBound kink_between(const BezierArc& before, double length_before, const BezierArc& after,
                         double length_after);

/// Poles of a Bezier patch; u numbers the rows.
struct BezierPatch {
    std::vector<BezierArc> rows;
};

/// Bounds on the derivatives of a surface over a box of parameters.
struct SurfaceDerivativeBounds {
    double u = 0.0, v = 0.0, uu = 0.0, uv = 0.0, vv = 0.0; // lengths
    double kink_u = 0.0, kink_v = 0.0; // sums over the kinks within the box, see DerivativeBounds
    bool known = true;

    void include(const SurfaceDerivativeBounds& other);
};

/// Bounds on the derivatives of a patch over a box of parameters of these sides.
SurfaceDerivativeBounds bounds_of(const BezierPatch& patch, double length_u, double length_v);

/// The patch divided into `count` x `count` equal ones, row by row along u; `count` is a power
/// of 2.
std::vector<BezierPatch> divided(const BezierPatch& patch, int count);

/// By how much the derivative by u jumps between two patches that share a border of constant u.
double kink_between(const BezierPatch& before, double length_before, const BezierPatch& after,
                    double length_after);

/// The patch with u and v exchanged.
BezierPatch transposed(const BezierPatch& patch);

} // namespace core::cad
