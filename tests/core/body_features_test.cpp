#include <gtest/gtest.h>

#include "core/distance/body_features.h"
#include "tests/support/meshes.h"

namespace core {
namespace {

TEST(BodyFeatures, AreThoseOfEachKindOfBody) {
    const Aabb box{{0, 0, 0}, {10, 20, 30}};
    for (const MeshFeatures& f :
         {features_of(ExactBody(convex(box))), features_of(Solid{SolidBox{box}, 0.5, {}}),
          features_of(ExactBody(solid_mesh(test_support::box_mesh(box.min, box.max))))}) {
        EXPECT_EQ(f.faces.size(), 6u);
        EXPECT_EQ(f.edges.size(), 12u);
        EXPECT_EQ(f.corners.size(), 8u);
    }
    for (const int axis : {0, 1, 2}) {
        const MeshFeatures f =
            features_of(Solid{SolidCylinder{{1, 2, 3}, 5.0, 40.0, axis}, 0.0, {}});
        Vec3 top(1, 2, 3), up(0.0);
        top[axis] += 40.0;
        up[axis] = 1.0;
        ASSERT_EQ(f.faces.size(), 2u);
        EXPECT_EQ(f.faces[1].center, top);
        EXPECT_EQ(f.faces[1].normal, up);
        ASSERT_EQ(f.circles.size(), 2u);
        EXPECT_EQ(f.circles[1].center, top);
        EXPECT_EQ(f.circles[1].radius, 5.0);
    }
    EXPECT_TRUE(features_of(ExactBody(convex_sphere(2.0))).faces.empty());
    EXPECT_TRUE(features_of(ExactBody(SolidMesh{})).faces.empty());
}

} // namespace
} // namespace core
