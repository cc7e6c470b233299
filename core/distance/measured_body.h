#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "core/distance/body_distance.h"
#include "core/distance/box_tree.h"
#include "core/distance/distance_engine.h"
#include "core/distance/outer_model.h"

namespace core {

/// A body whose geometry is known, in its own frame.
using BodyShape = std::variant<Primitive, RevolvedProfile, SolidMesh>;

/// A part of a body, exactly. Of a convex part a ball within it is known: `depth` round `centre`;
/// of a mesh none (0).
struct ExactPart {
    ExactBody body;
    Vec3 centre = Vec3(0.0);
    double depth = 0.0;
};

/// What is known of a body from its scan lines.
struct ScannedMatter {
    BoxTree lines;                // the stretches of matter, boxes without width
    std::optional<BoxTree> outer; // boxes that hold every point of the body
};

/// A body to measure: its scan points, and beside them what bounds its distances. Either its parts
/// are known exactly, or it is known by scan lines only.
struct MeasuredBody {
    double reach = 0.0;       // no point is farther from the origin of its frame, mm
    std::vector<Vec3> points; // the boundary points of its scan
    std::optional<PointBody> in_engine;
    std::vector<ExactPart> parts; // together the body; empty for a scanned one
    std::optional<ScannedMatter> scanned;
};

/// Scans a body of known geometry and keeps the geometry.
///
/// Errors: sizes that are not positive lengths, a profile without pieces or with one that is none,
///         no triangles, coordinates that are not finite or beyond 1e12 mm; a mesh size that is
///         none, that no line of which meets the body, or with which measuring would take more
///         memory than `memory_limit` bytes: it says what it would take, and nothing is tried.
Result<MeasuredBody> measured_body(const BodyShape& shape, double spacing,
                                   double memory_limit = default_memory_limit);

/// A body that is known by its scan lines, and by an outer model if there is one.
///
/// Errors: no matter on any line; a grid or matter that is not finite, beyond 1e12 mm or not of one
///         size; an outer model of another grid, or that does not hold the lines; as above for
///         memory.
Result<MeasuredBody> measured_body(const Dbm& lines, const std::optional<OuterModel>& outer = {},
                                   double memory_limit = default_memory_limit);

/// The same body with its points taken into an engine, so that it can be measured against others of
/// that engine.
///
/// Errors: those of DistanceEngine::add.
Result<MeasuredBody> taken_into(DistanceEngine& engine, MeasuredBody body);

} // namespace core
