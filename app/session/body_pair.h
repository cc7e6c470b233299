#pragma once

#include <variant>

#include "core/distance/body_distance.h"
#include "core/geom/primitive.h"

namespace app {

/// A body to measure, in its own frame.
using MeasuredBody = std::variant<core::Primitive, core::SolidMesh>;

/// Everything the paper's search and the exact geometry say of two bodies.
struct BodyPairDistance {
    double distance = 0.0; // of the closest pair of scan points
    double lower = 0.0;    // lower <= true distance <= upper
    double upper = 0.0;
    core::Vec3 on_a, on_b; // witness of `upper`, in A's frame
    double at = 0.0;       // of the witness, 0..1 of the sweep
    size_t points_a = 0, points_b = 0;
    uint64_t sphere_tests = 0, point_tests = 0;
    size_t poses = 1; // at which the scan points were compared
    double model_seconds = 0.0, build_seconds = 0.0, query_seconds = 0.0;
};

/// Measures B, placed by `a_from_b` and moved on by `sweep`, against A.
///
/// Result: `distance` over poses no more than the mesh size apart, for a sweep; the bounds hold for
///         every moment of it.
/// Errors: those of scanning a body.
core::Result<BodyPairDistance> measure(const MeasuredBody& a, const MeasuredBody& b,
                                       const core::Transform& a_from_b, const core::Vec3& sweep,
                                       double mesh_size);

} // namespace app
