#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/geom/mesh_features.h"

namespace core {

enum class FeatureKind : uint8_t { corner, circle, wall, edge, face };

/// A feature that a click can mean.
struct FeaturePick {
    FeatureKind kind = FeatureKind::face;
    uint32_t index = 0;         // in the list of its kind in MeshFeatures
    Vec3 point = Vec3(0.0);     // the corner; the centre; the place on the edge, on the face or on
                                // the axis of the wall that is nearest to the click
    Vec3 direction = Vec3(0.0); // outwards from the face, along the edge or the axis; zero: corner
    double radius = 0.0;        // of a circle or wall (there) through its vertices, mm
    double distance = 0.0;      // from the click to the corner, rim or edge, mm

    bool operator==(const FeaturePick&) const = default;
};

/// What a click on a body can mean, the most likely first: corners, whole circles, the round wall
/// that was hit, edges, arcs, a part of a round wall, the face, and the circle that the face fills.
///
/// `triangle` is the one that was hit; it is not used for boxes and cylinders, or if it is
/// no_index: then the surface nearest to `hit` counts. Corners, rims and edges are offered within
/// `reach` of `hit`, the nearest first, if the surface that was hit ends there.
///
/// Frame:   the body's.
/// Result:  empty on a curved surface without features nearby. Distances that differ by less than
///          1e-6 mm are equal; the feature with the lower index comes first.
/// Cost:    O(features).
std::vector<FeaturePick> feature_candidates(const MeshFeatures& features, uint32_t triangle,
                                            const Vec3& hit, double reach);

/// The first of the candidates.
std::optional<FeaturePick> pick_feature(const MeshFeatures& features, uint32_t triangle,
                                        const Vec3& hit, double reach);

/// The same feature in another frame.
FeaturePick moved(const FeaturePick& pick, const Transform& target_from_body);

} // namespace core
