#include <fstream>

#include <gtest/gtest.h>

#include "app/setup/kept_meshes.h"
#include "tests/support/meshes.h"
#include "tests/support/scoped_folder.h"

namespace {

using core::Vec3;

/// About 30,000 triangles, enough to be kept.
core::Mesh ball(double radius) { return test_support::ball_mesh(radius, 100, 150); }

void write_stl(const std::filesystem::path& path, const core::Mesh& mesh) {
    std::ofstream(path, std::ios::binary) << core::stl_bytes(mesh, "ball");
}

TEST(KeptMeshes, AreMadeOfTheSameBytesOnlyOnce) {
    const test_support::ScopedFolder folder;
    const std::filesystem::path path = folder / "ball.stl";
    write_stl(path, ball(10.0));
    const auto first = app::kept_mesh(path).value();
    EXPECT_EQ(app::kept_mesh(path).value(), first);
    write_stl(folder / "copy.stl", ball(10.0));
    EXPECT_EQ(app::kept_mesh(folder / "copy.stl").value(), first);
    write_stl(path, ball(11.0));
    const auto second = app::kept_mesh(path).value();
    EXPECT_NE(second, first);
    EXPECT_NEAR(second->mesh.bounds().max.z, 11.0, 1e-6);
    std::filesystem::remove(path);
    EXPECT_FALSE(app::kept_mesh(path)) << "a file that is gone is not found in memory";
    std::ofstream(path) << "solid damaged";
    EXPECT_FALSE(app::kept_mesh(path));
}

TEST(KeptMeshes, ReadTheSameBytesByTheFormatOfTheName) {
    const test_support::ScopedFolder folder;
    write_stl(folder / "ball.stl", ball(12.0));
    write_stl(folder / "ball.ply", ball(12.0));
    EXPECT_TRUE(app::kept_mesh(folder / "ball.stl"));
    EXPECT_FALSE(app::kept_mesh(folder / "ball.ply"));
}

TEST(KeptMeshes, AreOneSolidWhereTheyAreTheSame) {
    const core::SolidMesh first = app::kept_solid(ball(13.0));
    EXPECT_EQ(app::kept_solid(ball(13.0)).bvh, first.bvh);
    core::Mesh moved = ball(13.0);
    for (Vec3& vertex : moved.vertices) vertex.x += 1e-9;
    const core::SolidMesh other = app::kept_solid(moved);
    EXPECT_NE(other.bvh, first.bvh);
    EXPECT_EQ(other.mesh->vertices[5].x, moved.vertices[5].x);
}

TEST(KeptMeshes, AreDroppedWhenThereAreTooMany) {
    const core::SolidMesh first = app::kept_solid(ball(14.0));
    for (int i = 0; i < 110; ++i) app::kept_solid(ball(15.0 + i)); // more than 3,000,000 triangles
    EXPECT_NE(app::kept_solid(ball(14.0)).bvh, first.bvh);
    EXPECT_EQ(app::kept_solid(ball(15.0 + 109)).bvh, app::kept_solid(ball(15.0 + 109)).bvh);
}

} // namespace
