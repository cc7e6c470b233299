#pragma once

#include <string>
#include <variant>
#include <vector>

#include "app/bench/hollow_body.h"
#include "core/base/transform.h"

namespace app {

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

} // namespace app
