#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "core/distance/body_distance.h"
#include "core/distance/distance_engine.h"
#include "core/geom/primitive.h"

namespace app {

/// A body to measure, in its own frame.
using MeasuredBody = std::variant<core::Primitive, core::SolidMesh>;

/// The boundary points of a body's model.
///
/// Errors: those of scanning it.
core::Result<std::vector<core::Vec3>> points_of(const MeasuredBody& body, double mesh_size);

/// Everything a search among scan points and the exact geometry say of two bodies.
struct BodyPairDistance {
    std::string engine;    // that searched
    double distance = 0.0; // of the closest pair of scan points
    double lower = 0.0;    // lower <= true distance <= upper
    double upper = 0.0;
    core::Vec3 on_a, on_b; // witness of `upper`, in A's frame
    double at = 0.0;       // of the witness, 0..1 of the sweep
    size_t points_a = 0, points_b = 0;
    uint64_t node_tests = 0; // pairs compared: of spheres by the paper's engine, else of boxes
    uint64_t point_tests = 0;
    double model_seconds = 0.0, build_seconds = 0.0;
    double query_seconds = 0.0; // of the search; what follows took exact_seconds
    double exact_seconds = 0.0;
};

/// Measures B, placed by `a_from_b` and moved on by `sweep`, against A. The engine takes in both.
///
/// Result: every part holds for the whole of the sweep.
/// Errors: those of scanning a body, and of the engine.
core::Result<BodyPairDistance> measure(const MeasuredBody& a, const MeasuredBody& b,
                                       const core::Transform& a_from_b, const core::Vec3& sweep,
                                       double mesh_size, core::DistanceEngine& engine);

} // namespace app
