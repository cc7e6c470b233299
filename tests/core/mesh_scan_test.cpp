#include <random>

#include <gtest/gtest.h>

#include "core/dbm/mesh_scan.h"
#include "tests/support/line_oracle.h"
#include "tests/support/meshes.h"

namespace core {
namespace {

using test_support::ball_mesh;
using test_support::box_mesh;
using test_support::inside_out;
using test_support::line_oracle;
using test_support::moved;
using test_support::random_pose;
using test_support::together;
using test_support::torus_mesh;

/// Expects equality except for depths; `slack` also bounds slivers that only one side has.
void expect_near(const IntervalList& found, const IntervalList& expected, double slack) {
    IntervalList more = found, less = expected;
    for (const Interval& i : expected) more.subtract({i.lower - slack, i.upper + slack});
    for (const Interval& i : found) less.subtract({i.lower - slack, i.upper + slack});
    EXPECT_LT(LineView(more).length(), 1e-12);
    EXPECT_LT(LineView(less).length(), slack);
}

/// Expects that the scan of every line equals the oracle, and scan_line to the last bit.
void expect_as_oracle(const Mesh& mesh, double spacing, double slack = 1e-6) {
    const Dbm dbm = scan(mesh, spacing).value();
    for (int axis = 0; axis < 3; ++axis) {
        const ScanLines& family = dbm.families[static_cast<size_t>(axis)];
        for (int v = 0; v < family.v_count(); ++v)
            for (int u = 0; u < family.u_count(); ++u) {
                const double at_u = dbm.grid.coordinate(u_axis(axis), u);
                const double at_v = dbm.grid.coordinate(v_axis(axis), v);
                expect_near(family.line(u, v).list(), line_oracle(mesh, axis, at_u, at_v), slack);
                ASSERT_EQ(family.line(u, v), scan_line(mesh, axis, at_u, at_v).value());
            }
    }
}

Mesh tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    Mesh mesh{{a, b, c, d}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
    return signed_volume(mesh) < 0.0 ? inside_out(mesh) : mesh;
}

TEST(MeshScan, OfABoxIsThatOfThePrimitive) {
    // With h = 1 the lines of the 5 mm sides are exactly in the faces.
    for (const double spacing : {1.0, 0.7, 0.25, 2.0}) {
        const Vec3 size(5.0, 4.0, 3.0);
        const Dbm mesh = scan(box_mesh(-0.5 * size, 0.5 * size), spacing).value();
        const Dbm box = scan(Box{size}, spacing).value();
        EXPECT_EQ(boundary_points(mesh), boundary_points(box));
    }
}

TEST(MeshScan, DecidesLinesInFacesAndEdgesAsIfShifted) {
    const Mesh box = box_mesh(Vec3(0.0), Vec3(4.0));
    for (int axis = 0; axis < 3; ++axis)
        for (const double u : {-1.0, 0.0, 2.0, 4.0, 5.0})
            for (const double v : {-1.0, 0.0, 2.0, 4.0, 5.0}) {
                const bool inside = u >= 0.0 && u < 4.0 && v >= 0.0 && v < 4.0;
                const IntervalList expected =
                    inside ? IntervalList(Interval{0.0, 4.0}) : IntervalList();
                EXPECT_EQ(scan_line(box, axis, u, v).value(), expected);
            }
}

TEST(MeshScan, AgreesWithTheOracleOnGridAlignedTetrahedra) {
    std::mt19937 rng(5);
    std::uniform_int_distribution<int> position(-4, 4);
    const auto corner = [&] { return 0.5 * Vec3(position(rng), position(rng), position(rng)); };
    int scanned = 0;
    for (int i = 0; i < 200; ++i) {
        const Mesh mesh = tetrahedron(corner(), corner(), corner(), corner());
        if (signed_volume(mesh) < 1e-9) continue;
        ++scanned;
        // Half-integer corners and lines, so that lines frequently hit edges and corners.
        for (int axis = 0; axis < 3; ++axis)
            for (double u = -2.0; u <= 2.0; u += 0.25)
                for (double v = -2.0; v <= 2.0; v += 0.25)
                    expect_near(scan_line(mesh, axis, u, v).value(), line_oracle(mesh, axis, u, v),
                                1e-6);
        if (scan(mesh, 0.5)) expect_as_oracle(mesh, 0.5);
    }
    EXPECT_GT(scanned, 100);
}

TEST(MeshScan, AgreesWithTheOracleOnRotatedMeshes) {
    std::mt19937 rng(6);
    for (int i = 0; i < 4; ++i) {
        expect_as_oracle(moved(torus_mesh(10.0, 3.0, 24, 12), random_pose(rng, 100.0)), 1.6);
        expect_as_oracle(moved(ball_mesh(8.0, 12, 16), random_pose(rng, 100.0)), 1.3);
    }
}

TEST(MeshScan, AgreesWithTheOracleOnAnUnturnedTorus) {
    expect_as_oracle(torus_mesh(10.0, 3.0, 24, 12), 1.0); // many edges are along the lines
    expect_as_oracle(torus_mesh(8.0, 2.0, 4, 4), 0.5);
}

TEST(MeshScan, IsWatertightAlongEverySharedEdge) {
    // Steep slivers in fans around points that lines pass through exactly.
    const Mesh ball = ball_mesh(1000.0, 24, 48);
    for (int axis = 0; axis < 3; ++axis)
        for (const Vec3& p : ball.vertices) {
            const auto line = scan_line(ball, axis, p[u_axis(axis)], p[v_axis(axis)]);
            ASSERT_TRUE(line) << line.error().message;
            ASSERT_LE(line->size(), 1u);
        }
}

TEST(MeshScan, ApproachesTheBallItWasMadeOf) {
    const auto points = boundary_points(scan(ball_mesh(25.0, 200, 400), 1.0).value());
    EXPECT_EQ(points.size(), 11856u);
    for (const Vec3& p : points) EXPECT_NEAR(glm::length(p), 25.0, 0.01);
}

TEST(MeshScan, LeavesCavitiesEmpty) {
    const Mesh hollow =
        together(box_mesh(Vec3(-5.0), Vec3(5.0)), inside_out(box_mesh(Vec3(-2.0), Vec3(2.0))));
    const IntervalList line = scan_line(hollow, 2, 0.5, 0.5).value();
    ASSERT_EQ(line.size(), 2u);
    EXPECT_EQ(line[0], (Interval{-5.0, -2.0}));
    EXPECT_EQ(line[1], (Interval{2.0, 5.0}));
    EXPECT_FALSE(scan_mesh(hollow, 1.0)->shells_overlap);
}

TEST(MeshScan, UnitesShellsThatOverlapAndSaysSo) {
    const Mesh both = together(box_mesh(Vec3(0.0), Vec3(4.0)), box_mesh(Vec3(2.0), Vec3(6.0)));
    EXPECT_EQ(scan_line(both, 0, 3.0, 3.0).value(), IntervalList(Interval{0.0, 6.0}));
    EXPECT_TRUE(scan_mesh(both, 1.0)->shells_overlap);
}

TEST(MeshScan, LeavesNoSeamWhereShellsTouch) {
    const Mesh touching = together(box_mesh(Vec3(0.0), Vec3(4.0)),
                                   box_mesh(Vec3(4.0, 0.0, 0.0), Vec3(8.0, 4.0, 4.0)));
    EXPECT_EQ(scan_line(touching, 0, 1.0, 1.0).value(), IntervalList(Interval{0.0, 8.0}));
    EXPECT_FALSE(scan_mesh(touching, 0.7)->shells_overlap);
    std::mt19937 rng(8);
    for (int i = 0; i < 10; ++i) // rotated, so that the common face is rounded differently
        for (const Vec3& p :
             boundary_points(scan(moved(touching, random_pose(rng, 50.0)), 1.0).value()))
            EXPECT_TRUE(is_finite(p));
}

TEST(MeshScan, RefusesAMeshThatIsInsideOut) {
    EXPECT_FALSE(scan(inside_out(box_mesh(Vec3(0.0), Vec3(4.0))), 1.0));
    EXPECT_FALSE(scan_line(inside_out(box_mesh(Vec3(0.0), Vec3(4.0))), 0, 2.0, 2.0));
}

TEST(MeshScan, RefusesAnOpenMesh) {
    Mesh open = box_mesh(Vec3(0.0), Vec3(4.0));
    open.triangles.pop_back();
    const auto refused = scan(open, 0.5);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("open or partly inside out"), std::string::npos);
}

TEST(MeshScan, RefusesAMeshSizeThatMissesTheBody) {
    EXPECT_FALSE(scan(box_mesh(Vec3(0.0), Vec3(4.0)), 4.5));
    EXPECT_FALSE(scan(box_mesh(Vec3(0.0), Vec3(4.0)), 0.0));
    EXPECT_FALSE(scan(Mesh{}, 1.0));
}

} // namespace
} // namespace core
