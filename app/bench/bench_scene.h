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
    double ring = 0.0; // radius of the centre circle of the tube
    double tube = 0.0; // radius of the tube
};

/// A cylinder about Z, centred on the origin, with a bore that is open at the top, mm.
struct Cup {
    double radius = 0.0, height = 0.0;
    double bore = 0.0, depth = 0.0; // radius and length of the bore
};

/// The intervals of a scan line along `axis` inside the body; (u, v) are the other two coordinates
/// in cyclic order.
core::IntervalList line_of(const Torus& torus, int axis, double u, double v);
core::IntervalList line_of(const Cup& cup, int axis, double u, double v);

core::Aabb bounds(const Torus& torus);
core::Aabb bounds(const Cup& cup);

using BenchBody = std::variant<core::Primitive, Torus, Cup>;

/// The pose of B, and its true distance from A.
struct BenchPose {
    double separation = 0.0; // mm
    core::Transform a_from_b;
};

/// Two bodies whose distances are known by construction.
struct BenchScene {
    std::string name;      // name of the bodies
    std::string direction; // "axis", "generic" (oblique, not turned) or "turned"
    std::string title;     // description of both
    BenchBody a, b;
    std::vector<double> mesh_sizes; // mm
    std::vector<BenchPose> poses;
};

/// The paper's case study: two spheres of 50 mm, moved apart along X.
///
/// Source: Uddin, Yamazaki, Study of Distance Computation between Objects Represented by Discrete
///         Boundary Model, 2010, 5. It lists neither its eight separations nor the direction; those
///         here are ours.
BenchScene paper_scene();

/// The paper's scene, then cases that it omits: oblique and turned spheres, non-convex bodies,
/// parallel flat faces.
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

/// The distance of two bodies by a search among scan points and by exact geometry.
struct BodyPairDistance {
    std::string engine;    // name of the search engine
    double distance = 0.0; // between the closest scan points
    double lower = 0.0;    // lower <= true distance <= upper
    double upper = 0.0;
    double deviation = 0.0; // of meshes of CAD files, included in the bounds
    core::Vec3 on_a, on_b;  // witness of `upper`, in A's frame
    double at = 0.0;        // position of the witness in the sweep, 0..1
    size_t points_a = 0, points_b = 0;
    uint64_t node_tests = 0; // pairs tested: spheres in the paper's engine, else boxes
    uint64_t point_tests = 0;
    double model_seconds = 0.0, build_seconds = 0.0;
    double query_seconds = 0.0; // of the search alone
    double exact_seconds = 0.0;
};

/// Measures the distance from A to B, placed by `a_from_b` and then moved by `sweep`. Loads both
/// bodies into the engine.
///
/// Result: all values hold for the whole sweep.
/// Errors: those of scanning a body, and of the engine.
core::Result<BodyPairDistance> measure(const MeasuredBody& a, const MeasuredBody& b,
                                       const core::Transform& a_from_b, const core::Vec3& sweep,
                                       double mesh_size, core::DistanceEngine& engine);

} // namespace app
