#include <random>

#include <gtest/gtest.h>

#include "core/dbm/solid.h"
#include "tests/support/convex_oracle.h"
#include "tests/support/line_oracle.h"
#include "tests/support/meshes.h"

namespace core {
namespace {

using test_support::box_mesh;
using test_support::line_oracle;
using test_support::moved;
using test_support::random_direction;

struct Named {
    std::string name;
    Mesh mesh;
};

std::vector<Named> meshes() {
    const Transform turned{rotation_xyz_deg({33, 21, 57}), Vec3(0.1, -0.2, 0.3)};
    Mesh needle; // thin, inclined, between the corners of a square
    needle.vertices = {{0.21, 0.22, -3}, {0.24, 0.22, -3}, {0.22, 0.25, -3}, {0.26, 0.27, 3}};
    needle.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    return {
        {"torus", test_support::torus_mesh(3.0, 1.0, 12, 8)},
        {"turned torus", moved(test_support::torus_mesh(3.0, 1.0, 12, 8), turned)},
        {"turned box", moved(box_mesh({-3, -2, -1}, {3, 2, 1}), turned)},
        {"thin wall", moved(box_mesh({-3, -0.01, -1}, {3, 0.01, 1}), turned)},
        {"thin plate", moved(box_mesh({-3, -2, -0.01}, {3, 2, 0.01}), turned)},
        {"upright wall", box_mesh({0.1, -3, -1}, {0.12, 3, 1})},
        {"needle", needle},
        {"hollow", test_support::together(box_mesh(Vec3(-3), Vec3(3)),
                                          test_support::inside_out(box_mesh(Vec3(-2), Vec3(2))))},
    };
}

/// Whether every interval of `inner` is inside one of `outer`, with a tolerance.
bool within(const IntervalList& inner, const IntervalList& outer, double nearly = 1e-8) {
    for (const Interval& i : inner) {
        bool held = false;
        for (const Interval& o : outer)
            held = held || (o.lower <= i.lower + nearly && i.upper - nearly <= o.upper);
        if (!held) return false;
    }
    return true;
}

Square random_square(std::mt19937& rng, double side) {
    std::uniform_real_distribution<double> position(-4.5, 4.0);
    const double x = position(rng), y = position(rng);
    if (rng() % 4 == 0) return {std::round(x), std::round(x) + side, std::round(y), std::round(y)};
    return {x, x + side, y, y + side};
}

Vec3 point_in(const Square& s, std::mt19937& rng) {
    std::uniform_real_distribution<double> fraction(0.0, 1.0);
    const auto pick = [&](double low, double high) {
        const auto kind = rng() % 6;
        return kind == 0 ? low : kind == 1 ? high : low + fraction(rng) * (high - low);
    };
    return {pick(s.x0, s.x1), pick(s.y0, s.y1), 0.0};
}

TEST(ColumnOfAMesh, HoldsEveryLineAboveTheSquare) {
    std::mt19937 rng(51);
    for (const Named& named : meshes()) {
        const Solid solid{solid_mesh(named.mesh), 0.0};
        int met = 0, empty = 0;
        for (const double side : {0.5, 0.05, 2.0})
            for (int i = 0; i < 80; ++i) {
                const Square square = random_square(rng, side);
                const IntervalList column = column_of(solid, square);
                for (int k = 0; k < 5; ++k) {
                    const Vec3 p = point_in(square, rng);
                    const IntervalList line = line_oracle(named.mesh, 2, p.x, p.y);
                    ++(line.empty() ? empty : met);
                    ASSERT_TRUE(within(line, column)) << named.name << " at " << p.x << ' ' << p.y;
                }
            }
        EXPECT_GT(empty, 50) << named.name;
        if (named.mesh.bounds().size().x > 1.0) {
            EXPECT_GT(met, 5) << named.name;
        }
    }
}

TEST(ColumnOfAMesh, HoldsANeedleThatNoCornerMeets) {
    const Solid solid{solid_mesh(meshes()[6].mesh), 0.0};
    const IntervalList column = column_of(solid, {0.0, 0.5, 0.0, 0.5});
    ASSERT_EQ(column.size(), 1u);
    EXPECT_NEAR(column[0].lower, -3.0, 1e-6);
    EXPECT_NEAR(column[0].upper, 3.0, 1e-6);
    EXPECT_TRUE(column_of(solid, {0.3, 0.5, 0.3, 0.5}).empty());
}

TEST(ColumnOfAMesh, LeavesAClosedCavityOpen) {
    const Solid solid{solid_mesh(meshes()[7].mesh), 0.0};
    const IntervalList column = column_of(solid, {0.1, 0.6, 0.1, 0.6});
    ASSERT_EQ(column.size(), 2u);
    EXPECT_NEAR(column[0].upper, -2.0, 1e-6);
    EXPECT_NEAR(column[1].lower, 2.0, 1e-6);
}

bool in_cylinder(const SolidCylinder& c, const Vec3& p) {
    const Vec3 d = p - c.base;
    const double along = d[c.axis];
    Vec3 across = d;
    across[c.axis] = 0.0;
    return along >= 0.0 && along <= c.height && glm::length(across) <= c.radius;
}

bool in_solid(const Solid& solid, const Vec3& p) {
    if (const auto* c = std::get_if<SolidCylinder>(&solid.shape)) return in_cylinder(*c, p);
    return distance_squared(p, std::get<SolidBox>(solid.shape).box) == 0.0;
}

std::vector<Solid> simple_solids(double tolerance) {
    std::vector<Solid> solids = {{SolidBox{{{-3, -2, -1}, {3, 2, 1}}}, tolerance},
                                 {SolidBox{{{0.1, -3, -1}, {0.12, 3, 1}}}, tolerance}};
    for (int axis = 0; axis < 3; ++axis) {
        solids.push_back({SolidCylinder{{-1, 0.5, -2}, 2.5, 3.7, axis}, tolerance});
        solids.push_back({SolidCylinder{{0.2, 0.3, 0.1}, 0.05, 2.0, axis}, tolerance});
    }
    return solids;
}

TEST(ColumnOf, HoldsEveryPointOfTheSolidAndItsTolerance) {
    std::mt19937 rng(52);
    std::uniform_real_distribution<double> fraction(0.0, 1.0);
    for (const double tolerance : {0.0, 0.3}) {
        for (const Solid& solid : simple_solids(tolerance)) {
            int met = 0;
            for (int i = 0; i < 20000; ++i) {
                const Aabb box = bounds(solid);
                const Vec3 p =
                    box.min + Vec3(fraction(rng), fraction(rng), fraction(rng)) * box.size();
                if (!in_solid(solid, p)) continue;
                const Vec3 grown = p + tolerance * random_direction(rng);
                const double side = i % 2 ? 0.5 : 0.02;
                const double x0 = grown.x - (i % 5 ? fraction(rng) : i % 3 / 2.0) * side;
                const double y0 = grown.y - fraction(rng) * side;
                const IntervalList column = column_of(solid, {x0, x0 + side, y0, y0 + side});
                ++met;
                ASSERT_TRUE(column.contains(grown.z)) << grown.x << ' ' << grown.y;
            }
            EXPECT_GT(met, 5000);
        }
    }
}

TEST(ColumnOf, IsNoHigherThanTheSolid) {
    for (const Solid& solid : simple_solids(0.3)) {
        const Vec3 centre = bounds(solid).center();
        const IntervalList column =
            column_of(solid, {centre.x - 0.01, centre.x + 0.01, centre.y - 0.01, centre.y + 0.01});
        ASSERT_EQ(column.size(), 1u);
        EXPECT_NEAR(column[0].upper, bounds(solid).max.z + 0.3, 1e-6);
        EXPECT_NEAR(column[0].lower, bounds(solid).min.z - 0.3, 1e-6);
        EXPECT_TRUE(column_of(solid, {20, 21, 20, 21}).empty());
    }
}

TEST(LineOf, IsTheMatterOnTheLine) {
    std::mt19937 rng(53);
    std::uniform_real_distribution<double> position(-4.5, 4.5);
    for (const Solid& solid : simple_solids(0.0)) {
        int in = 0;
        for (int i = 0; i < 20000; ++i) {
            const Vec3 p = i % 2 ? Vec3(position(rng), position(rng), position(rng))
                                 : bounds(solid).center()
                                       + 0.3 * Vec3(position(rng), position(rng), position(rng));
            const int axis = static_cast<int>(rng() % 3);
            const bool held =
                line_of(solid, axis, p[(axis + 1) % 3], p[(axis + 2) % 3]).contains(p[axis]);
            ASSERT_EQ(held, in_solid(solid, p));
            in += held;
        }
        EXPECT_GT(in, 3);
    }
}

TEST(LineOf, IsTheMatterOfAMeshOnTheLine) {
    std::mt19937 rng(55);
    std::uniform_real_distribution<double> position(-3.5, 3.5);
    int met = 0;
    for (const Named& named : meshes()) {
        const Solid solid{solid_mesh(named.mesh), 0.0};
        for (int i = 0; i < 200; ++i) {
            const double u = position(rng), v = position(rng);
            const IntervalList found = line_of(solid, i % 3, u, v);
            const IntervalList truth = line_oracle(named.mesh, i % 3, u, v);
            // The oracle shifts the line by 2^-30; flanks are up to 100 times as steep.
            EXPECT_TRUE(within(found, truth, 1e-7) && within(truth, found, 1e-7)) << named.name;
            met += !truth.empty();
        }
    }
    EXPECT_GT(met, 200);
}

TEST(Holds, AgreesWithTheLineThroughThePoint) {
    std::mt19937 rng(54);
    std::uniform_real_distribution<double> position(-4.0, 4.0);
    for (const Named& named : meshes()) {
        const SolidMesh solid = solid_mesh(named.mesh);
        for (int i = 0; i < 400; ++i) {
            const Vec3 p(position(rng), position(rng), position(rng));
            EXPECT_EQ(holds(solid, p), line_oracle(named.mesh, 2, p.x, p.y).contains(p.z));
        }
    }
    EXPECT_FALSE(holds(solid_mesh({}), Vec3(0.0)));
}

TEST(Holds, SeesTheMaterialNextToAFoldOfTheSurface) {
    const SolidMesh folded = solid_mesh(test_support::cube_with_a_fold());
    EXPECT_TRUE(holds(folded, {3.5, 0.229, 5.0}));
    EXPECT_FALSE(holds(folded, {3.5, 0.229, 11.0}));
    EXPECT_FALSE(holds(folded, {3.5, 0.229, -11.5})); // in the fold
}

TEST(ColumnOfAMesh, ContainsTheMaterialNextToAFoldOfTheSurface) {
    const Solid folded{solid_mesh(test_support::cube_with_a_fold()), 0.0};
    EXPECT_TRUE(column_of(folded, {3.5, 3.501, 0.229, 0.2291}).contains(5.0));
}

TEST(SolidMesh, HasAPointOfEveryShell) {
    const SolidMesh solid = solid_mesh(test_support::together(
        box_mesh(Vec3(-3), Vec3(3)), test_support::together(box_mesh({10, 0, 0}, {11, 1, 1}),
                                                            box_mesh({20, 0, 0}, {21, 1, 1}))));
    ASSERT_EQ(solid.shell_points.size(), 3u);
    std::vector<int> seen;
    for (const Vec3& p : solid.shell_points) seen.push_back(static_cast<int>(p.x + 5) / 10);
    std::sort(seen.begin(), seen.end());
    EXPECT_EQ(seen, (std::vector<int>{0, 1, 2}));
}

} // namespace
} // namespace core
