#include <cstdlib>

#include <embree3/rtcore.h>

#include "tests/bench/peers.h"

namespace bench {
namespace {

/// The points of a body in an Embree scene, as user geometry, because Embree's own points answer no
/// point queries. Built on one thread.
class Scene {
public:
    explicit Scene(const Points& points)
        : device_(rtcNewDevice("threads=1,set_affinity=0")), scene_(rtcNewScene(device_)) {
        for (const core::Vec3& p : points)
            points_.push_back({float(p.x), float(p.y), float(p.z), 0.0f});
        const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(points_.size()));
        rtcSetGeometryUserData(geometry, points_.data());
        rtcSetGeometryBoundsFunction(geometry, bound, nullptr);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
    }
    ~Scene() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    double distance(const Points& b, const core::Transform& a_from_b, const core::PairGoal& goal) {
        RTCPointQueryContext context;
        rtcInitPointQueryContext(&context);
        const float limit = static_cast<float>(goal.limit);
        float best = limit;
        for (const core::Vec3& point : b) {
            const core::Vec3 p = a_from_b * point;
            RTCPointQuery query = {float(p.x), float(p.y), float(p.z), 0.0f, best};
            rtcPointQuery(scene_, &query, &context, shrink_to, points_.data());
            best = query.radius;
            if (goal.any && best < limit) break;
        }
        return best < limit ? best : core::infinity;
    }

private:
    struct Point {
        float x, y, z, unused; // 16 bytes, as in Embree
    };

    static void bound(const RTCBoundsFunctionArguments* asked) {
        const Point& p = static_cast<const Point*>(asked->geometryUserPtr)[asked->primID];
        *asked->bounds_o = {p.x, p.y, p.z, 0.0f, p.x, p.y, p.z, 0.0f};
    }

    /// Shrinks the query to the point that was hit, if it is nearer.
    static bool shrink_to(RTCPointQueryFunctionArguments* found) {
        const Point& p = static_cast<const Point*>(found->userPtr)[found->primID];
        RTCPointQuery& query = *found->query;
        const float x = p.x - query.x, y = p.y - query.y, z = p.z - query.z;
        const float squared = x * x + y * y + z * z;
        if (!(squared < query.radius * query.radius)) return false;
        query.radius = std::sqrt(squared);
        return true;
    }

    RTCDevice device_;
    RTCScene scene_;
    std::vector<Point> points_;
};

} // namespace

Contestant embree_peer() {
    return {"embree", 2e-5,
            [](const Points& a, const Points& b) -> Prepared {
                return {
                    [a = std::make_shared<Scene>(a), b](const auto& a_from_b, const auto& goal) {
                        return a->distance(b, a_from_b, goal);
                    },
                    {}};
            },
            [](const Points& points) { return std::make_shared<Scene>(points); }};
}

} // namespace bench
