#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/base/vec.h"
#include "core/dbm/dbm.h"
#include "core/distance/body_distance.h"
#include "core/distance/distance_engine.h"
#include "core/geom/primitive.h"

namespace app {

/// A ring about Z, centred on the origin, mm; the tube is thinner than the ring.
struct Torus {
    double ring = 0.0; // radius of the circle in the middle of the tube
    double tube = 0.0; // radius across
};

/// A cylinder about Z, centred on the origin, with a bore that is open at the top, mm.
struct Cup {
    double radius = 0.0, height = 0.0;
    double bore = 0.0, depth = 0.0; // radius and length of the bore
};

/// What a line along `axis` at (u, v) of the two other axes, cyclically, meets of the body.
core::IntervalList line_of(const Torus& torus, int axis, double u, double v);
core::IntervalList line_of(const Cup& cup, int axis, double u, double v);

core::Aabb bounds(const Torus& torus);
core::Aabb bounds(const Cup& cup);

using BenchBody = std::variant<core::Primitive, Torus, Cup>;

/// Where B stands, and how far from A its surface then really is.
struct BenchPlace {
    double separation = 0.0; // mm
    core::Transform a_from_b;
};

/// Two bodies whose distances are known by construction.
struct BenchScene {
    std::string name;      // of the bodies
    std::string direction; // "axis", "generic" (askew, not turned) or "turned"
    std::string title;     // both, for a person
    BenchBody a, b;
    std::vector<double> mesh_sizes; // mm
    std::vector<BenchPlace> places;
};

/// The paper's case study: two spheres of 50 mm, moved apart along X.
///
/// Source: Uddin, Yamazaki, Study of Distance Computation between Objects Represented by Discrete
///         Boundary Model, 2010, 5. It does not list its eight separations, nor the direction;
///         they are ours.
BenchScene paper_scene();

/// The paper's scene, then what it leaves out: the spheres askew and turned, bodies that are not
/// convex, flat face over flat face.
std::vector<BenchScene> bench_scenes();

/// The points of a body's model.
///
/// Errors: those of scan_lines_of.
core::Result<std::vector<core::Vec3>> points_of(const BenchBody& body, double mesh_size);

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
