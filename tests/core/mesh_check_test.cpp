#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geom/mesh_file.h"
#include "tests/support/meshes.h"

namespace core {
namespace {

using test_support::box_mesh;
using test_support::inside_out;
using test_support::together;
using test_support::torus_mesh;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Checked {
    Result<Mesh> mesh;
    std::vector<std::string> repairs;
};

Checked check(const Mesh& mesh) {
    std::vector<std::string> repairs;
    auto result = checked_solid(mesh, repairs);
    return {std::move(result), std::move(repairs)};
}

Mesh cube(double from, double to) { return box_mesh(Vec3(from), Vec3(to)); }

TEST(MeshCheck, LeavesASoundMeshAlone) {
    const Mesh torus = torus_mesh(10.0, 3.0, 12, 8);
    const auto [mesh, repairs] = check(torus);
    EXPECT_DOUBLE_EQ(signed_volume(mesh.value()), signed_volume(torus));
    EXPECT_THAT(repairs, IsEmpty());
}

TEST(MeshCheck, SharesCornersThatCoincide) {
    Mesh soup;
    const Mesh box = cube(-0.0, 5.0);
    for (size_t i = 0; i < box.triangles.size(); ++i) {
        const Triangle t = box.triangle(i);
        const auto at = static_cast<uint32_t>(soup.vertices.size());
        soup.vertices.insert(soup.vertices.end(), {t.a, i % 2 ? -0.0 + t.b : t.b, t.c});
        soup.triangles.push_back({at, at + 1, at + 2});
    }
    const auto [mesh, repairs] = check(soup);
    EXPECT_EQ(mesh->vertices.size(), 8u);
    EXPECT_THAT(repairs, IsEmpty());
}

TEST(MeshCheck, SaysHowManyEdgesAreOpenAndWhereOneIs) {
    Mesh open = cube(0.0, 5.0);
    open.triangles.pop_back(); // the corners 3, 7, 5
    EXPECT_EQ(check(open).mesh.error().message,
              "the mesh is not closed: 3 edges have no second triangle, one of them from (5, 5, 0) "
              "to (5, 0, 5)");
}

TEST(MeshCheck, TurnsAMeshThatFacesInwards) {
    const auto [mesh, repairs] = check(inside_out(cube(0.0, 5.0)));
    EXPECT_EQ(signed_volume(mesh.value()), 125.0);
    EXPECT_THAT(repairs, ElementsAre("1 of its shells faced inwards and were flipped"));
}

TEST(MeshCheck, TurnsOnlyTheShellThatFacesInwards) {
    const auto [mesh, repairs] = check(together(cube(0.0, 5.0), inside_out(cube(7.0, 9.0))));
    EXPECT_EQ(signed_volume(mesh.value()), 125.0 + 8.0);
    EXPECT_THAT(repairs, ElementsAre(HasSubstr("1 of its shells")));
}

TEST(MeshCheck, KeepsACavity) {
    const auto [mesh, repairs] = check(together(cube(0.0, 5.0), inside_out(cube(1.0, 2.0))));
    EXPECT_EQ(signed_volume(mesh.value()), 125.0 - 1.0);
    EXPECT_THAT(repairs, IsEmpty());
}

TEST(MeshCheck, KeepsTheCavityOfAMeshThatIsInsideOutAsAWhole) {
    const Mesh hollow = together(cube(0.0, 5.0), inside_out(cube(1.0, 2.0)));
    const auto [mesh, repairs] = check(inside_out(hollow));
    EXPECT_EQ(signed_volume(mesh.value()), 125.0 - 1.0);
    EXPECT_THAT(repairs, ElementsAre("2 of its shells faced inwards and were flipped"));
}

TEST(MeshCheck, KeepsABodyInsideACavity) {
    const Mesh rattle =
        together(together(cube(0.0, 9.0), inside_out(cube(1.0, 8.0))), cube(3.0, 5.0));
    EXPECT_EQ(signed_volume(check(rattle).mesh.value()), 729.0 - 343.0 + 8.0);
    EXPECT_EQ(signed_volume(check(inside_out(rattle)).mesh.value()), 729.0 - 343.0 + 8.0);
}

TEST(MeshCheck, KeepsACavityThatFillsNearlyAllOfItsBox) {
    // The cavity's box is not inside the material of a U-shaped body, but inside its box.
    const Mesh torus = torus_mesh(10.0, 3.0, 24, 12);
    const auto [mesh, repairs] = check(together(torus, inside_out(cube(-0.5, 0.5))));
    // In the hole of the torus it is no cavity: it faces inwards with no material around it.
    EXPECT_GT(signed_volume(mesh.value()), signed_volume(torus) + 0.9);
    EXPECT_THAT(repairs, ElementsAre(HasSubstr("1 of its shells")));
}

TEST(MeshCheck, TurnsSingleTrianglesThatFaceTheWrongWay) {
    Mesh mixed = torus_mesh(10.0, 3.0, 12, 8);
    const double volume = signed_volume(mixed);
    for (const size_t i : {3u, 17u, 40u}) std::swap(mixed.triangles[i][0], mixed.triangles[i][1]);
    const auto [mesh, repairs] = check(mixed);
    EXPECT_DOUBLE_EQ(signed_volume(mesh.value()), volume);
    EXPECT_THAT(repairs, ElementsAre("3 triangles faced opposite to their neighbours and "
                                     "were flipped"));
}

TEST(MeshCheck, KeepsShellsApartThatShareAnEdge) {
    const Mesh other = box_mesh(Vec3(5.0, 5.0, 0.0), Vec3(10.0, 10.0, 5.0));
    EXPECT_EQ(signed_volume(check(together(cube(0.0, 5.0), other)).mesh.value()), 250.0);
    const auto [mesh, repairs] = check(together(cube(0.0, 5.0), inside_out(other)));
    EXPECT_EQ(signed_volume(mesh.value()), 250.0);
    EXPECT_EQ(repairs.size(), 1u);
}

TEST(MeshCheck, RefusesASurfaceWithOneSide) {
    // A closed surface that cannot be oriented consistently: a projective plane of ten triangles.
    Mesh mesh;
    for (int i = 0; i < 6; ++i) mesh.vertices.emplace_back(i * i, i % 3, i % 2 + 0.1 * i * i * i);
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 1},
                      {1, 2, 4}, {2, 3, 5}, {3, 4, 1}, {4, 5, 2}, {5, 1, 3}};
    const auto [checked, repairs] = check(mesh);
    ASSERT_FALSE(checked);
    EXPECT_THAT(checked.error().message, HasSubstr("triangles that face opposite ways"));
}

TEST(MeshCheck, RefusesAMeshWithoutVolume) {
    Mesh flat{{Vec3(0.0), Vec3(1.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0)}, {{0, 1, 2}, {0, 2, 1}}};
    EXPECT_THAT(check(flat).mesh.error().message, HasSubstr("no volume"));
    EXPECT_FALSE(check(Mesh{}).mesh);
    flat.triangles = {{0, 1, 1}};
    EXPECT_THAT(check(flat).mesh.error().message, HasSubstr("no volume"));
}

TEST(MeshCheck, RefusesCoordinatesThatCannotBe) {
    for (const double bad : {std::nan(""), infinity, 1.1e6}) {
        Mesh mesh = cube(0.0, 5.0);
        mesh.vertices[7].y = bad;
        EXPECT_THAT(check(mesh).mesh.error().message, HasSubstr("triangle 4 ")) << bad;
    }
    Mesh mesh = cube(0.0, 5.0);
    mesh.triangles[4][1] = 8;
    EXPECT_THAT(check(mesh).mesh.error().message, HasSubstr("refers to vertex 8"));
}

} // namespace
} // namespace core
