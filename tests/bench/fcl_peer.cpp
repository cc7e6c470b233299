#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/distance.h>

#include "tests/bench/peers.h"

namespace bench {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSS<double>>;

std::shared_ptr<Model> model(const Points& points) {
    std::vector<fcl::Vector3d> vertices;
    std::vector<fcl::Triangle> triangles;
    for (const core::Vec3& p : points) {
        triangles.emplace_back(vertices.size(), vertices.size(), vertices.size());
        vertices.emplace_back(p.x, p.y, p.z);
    }
    auto made = std::make_shared<Model>();
    made->beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
    made->addSubModel(vertices, triangles);
    made->endModel();
    return made;
}

fcl::Transform3d pose(const core::Transform& t) {
    fcl::Transform3d result = fcl::Transform3d::Identity();
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row) result.linear()(row, column) = t.rotation[column][row];
    result.translation() = fcl::Vector3d(t.translation.x, t.translation.y, t.translation.z);
    return result;
}

double distance(const Model& a, const Model& b, const core::Transform& a_from_b, double limit) {
    const fcl::DistanceRequestd request(false, false);
    fcl::DistanceResultd result(std::min(limit, std::numeric_limits<double>::max()));
    fcl::distance(&a, fcl::Transform3d(fcl::Transform3d::Identity()), &b, pose(a_from_b), request,
                  result);
    return result.min_distance < limit ? result.min_distance : core::infinity;
}

} // namespace

Contestant fcl_peer() {
    return {"fcl", 1e-9,
            [](const Points& a, const Points& b) -> Prepared {
                return {[a = model(a), b = model(b)](const auto& a_from_b, const auto& goal) {
                            return distance(*a, *b, a_from_b, goal.limit);
                        },
                        {}};
            },
            [](const Points& points) { return model(points); }};
}

} // namespace bench
