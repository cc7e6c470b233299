#include "core/distance/body_features.h"

#include "core/geom/shape_features.h"

namespace core {
namespace {

MeshFeatures features_of_mesh(const SolidMesh& solid) {
    return solid.mesh ? features_of(*solid.mesh) : MeshFeatures{};
}

MeshFeatures features_of_cylinder(const SolidCylinder& cylinder) {
    Vec3 top = cylinder.base;
    top[cylinder.axis] += cylinder.height;
    return cone_features(cylinder.base, top, cylinder.radius, cylinder.radius);
}

} // namespace

MeshFeatures features_of(const ExactBody& body) {
    if (const auto* shape = std::get_if<ConvexShape>(&body)) return features_of(*shape);
    return features_of_mesh(std::get<SolidMesh>(body));
}

MeshFeatures features_of(const Solid& solid) {
    if (const auto* box = std::get_if<SolidBox>(&solid.shape)) return features_of(box->box);
    if (const auto* cylinder = std::get_if<SolidCylinder>(&solid.shape))
        return features_of_cylinder(*cylinder);
    return features_of_mesh(std::get<SolidMesh>(solid.shape));
}

} // namespace core
