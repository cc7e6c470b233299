#include <algorithm>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "core/dbm/stock_mesh.h"
#include "render/stock_surface.h"
#include "tests/render/sample_scene.h"

namespace render {
namespace {

using core::CutModel;
using core::Vec3;

using Place = std::array<float, 3>;

Place place_of(const StockBrick& brick, uint32_t vertex) {
    const glm::vec3& p = brick.mesh.vertices[vertex].position;
    return {p.x, p.y, p.z};
}

/// Whether all bricks together pass every edge as often one way as the other.
bool is_watertight(const StockBricks& bricks) {
    std::map<std::pair<Place, Place>, int> passes;
    for (const auto& brick : bricks)
        for (const TriangleMesh::Corners& t : brick->mesh.triangles)
            for (size_t k = 0; k < 3; ++k) {
                const Place a = place_of(*brick, t[k]), b = place_of(*brick, t[(k + 1) % 3]);
                if (a != b) passes[std::minmax(a, b)] += a < b ? 1 : -1;
            }
    return std::all_of(passes.begin(), passes.end(), [](const auto& p) { return p.second == 0; });
}

bool are_same(const StockBricks& a, const StockBricks& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
        return x->mesh.vertices == y->mesh.vertices && x->mesh.triangles == y->mesh.triangles
               && x->mesh.edges == y->mesh.edges && x->blocks == y->blocks;
    });
}

double volume(const StockBricks& bricks) {
    double six = 0.0;
    for (const auto& brick : bricks)
        for (const TriangleMesh::Corners& t : brick->mesh.triangles) {
            const auto at = [&](size_t i) { return Vec3(brick->mesh.vertices[t[i]].position); };
            six += glm::dot(at(0), glm::cross(at(1), at(2)));
        }
    return six / 6.0;
}

CutModel block_model(double h) {
    return *core::make_cut_model({core::SolidBox{{{-45, -30, -30}, {45, 30, 0}}}, 0.0}, h);
}

/// The sample's stock after each so many moves; the last one is finished.
std::vector<CutModel> snapshots(double h, size_t step) {
    std::vector<PathPoint> path;
    const std::vector<core::CutterSweep> moves = sample_moves(path);
    std::vector<CutModel> made = {block_model(h)};
    CutModel model = made[0];
    for (size_t i = 0; i < moves.size(); ++i) {
        cut(model, moves[i]);
        if (i % step == step - 1 || i + 1 == moves.size()) made.push_back(model);
    }
    return made;
}

TEST(StockSurface, IsTheBlockBeforeAnythingIsCut) {
    const StockBricks bricks = stock_bricks(block_model(0.7));
    EXPECT_GT(bricks.size(), 8u);
    EXPECT_TRUE(is_watertight(bricks));
    EXPECT_NEAR(volume(bricks), 90.0 * 60.0 * 30.0, 0.5);
    for (const auto& brick : bricks)
        for (const uint32_t block : brick->blocks) EXPECT_EQ(block, StockBrick::raw);
}

TEST(StockSurface, HasNoCracksBetweenBricks) {
    const std::vector<CutModel> models = snapshots(0.9, 40);
    for (const CutModel& model : models) EXPECT_TRUE(is_watertight(stock_bricks(model)));
}

TEST(StockSurface, HasTheTrianglesOfTheWholeMesh) {
    const CutModel model = snapshots(0.9, 1000).back();
    const core::StockMesh whole = stock_mesh(model);
    const StockBricks bricks = stock_bricks(model);
    using Corners = std::array<Place, 3>;
    const auto turned = [](Corners t) {
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        return t;
    };
    std::multiset<Corners> expected, found;
    for (const core::Mesh::Corners& t : whole.mesh.triangles) {
        Corners corners;
        for (size_t i = 0; i < 3; ++i) {
            const glm::vec3 p(whole.mesh.vertices[t[i]]);
            corners[i] = {p.x, p.y, p.z};
        }
        expected.insert(turned(corners));
    }
    for (const auto& brick : bricks)
        for (const TriangleMesh::Corners& t : brick->mesh.triangles)
            found.insert(
                turned({place_of(*brick, t[0]), place_of(*brick, t[1]), place_of(*brick, t[2])}));
    EXPECT_GT(found.size(), 20'000u);
    EXPECT_TRUE(expected == found);
}

TEST(StockSurface, IsTheSameHoweverItWasReached) {
    const std::vector<CutModel> models = snapshots(1.0, 12);
    std::vector<StockBricks> afresh;
    for (const CutModel& model : models) afresh.push_back(stock_bricks(model));
    StockSurface surface;
    for (size_t i = 0; i < models.size(); ++i) { // forwards
        surface.update(models[i]);
        EXPECT_TRUE(are_same(surface.bricks(), afresh[i])) << i;
    }
    for (size_t i = models.size(); i-- > 0;) { // backwards
        surface.update(models[i]);
        EXPECT_TRUE(are_same(surface.bricks(), afresh[i])) << i;
    }
    std::mt19937 random(7);
    for (int jump = 0; jump < 40; ++jump) {
        const size_t i = random() % models.size();
        surface.update(models[i]);
        EXPECT_TRUE(are_same(surface.bricks(), afresh[i])) << i;
    }
}

TEST(StockSurface, RebuildsOnlyWhatABlockHasTouched) {
    CutModel model = block_model(0.5);
    StockSurface surface;
    const size_t all = surface.update(model);
    EXPECT_EQ(surface.update(model), 0u);
    const StockBricks before = surface.bricks();
    cut(model, {flat_cutter(3.0), {-40, -25, -2}, {-38, -25, -2}, core::Mat3(1.0), 5});
    const size_t touched = surface.update(model);
    EXPECT_GE(touched, 1u);
    EXPECT_LE(touched, 4u);
    EXPECT_GT(all, 40u);
    const StockBricks& after = surface.bricks();
    const auto kept = std::count_if(after.begin(), after.end(), [&](const auto& brick) {
        return std::find(before.begin(), before.end(), brick) != before.end();
    });
    EXPECT_EQ(static_cast<size_t>(kept), after.size() - touched);
}

TEST(StockSurface, KnowsTheBlockThatMadeATriangle) {
    CutModel model = block_model(0.5);
    cut(model, {flat_cutter(3.0), {-60, 10, -2}, {60, 10, -2}, core::Mat3(1.0), 17});
    cut(model, {flat_cutter(3.0), {-60, -10, -4}, {60, -10, -4}, core::Mat3(1.0), 23});
    size_t first = 0, second = 0;
    for (const auto& brick : stock_bricks(model)) {
        ASSERT_EQ(2 * brick->blocks.size(), brick->mesh.triangles.size());
        for (size_t t = 0; t < brick->mesh.triangles.size(); ++t) {
            const auto& corners = brick->mesh.triangles[t];
            const uint32_t block = brick->blocks[t / 2];
            for (const uint32_t corner : corners)
                EXPECT_EQ(brick->mesh.vertices[corner].tint, block == StockBrick::raw ? 0 : 1);
            if (block == StockBrick::raw) continue;
            const float y = brick->mesh.vertices[corners[0]].position.y;
            EXPECT_EQ(block, y > 0.0F ? 17u : 23u);
            ++(y > 0.0F ? first : second);
        }
    }
    EXPECT_GT(first, 1000u);
    EXPECT_GT(second, 1000u);
}

TEST(StockSurface, KeepsEdgesCrispAndRoundsSmooth) {
    CutModel model = block_model(0.5);
    cut(model, {ball_cutter(8.0), {-60, 0, -6}, {60, 0, -6}, core::Mat3(1.0), 1});
    size_t round = 0, flat = 0;
    for (const auto& brick : stock_bricks(model)) {
        for (const MeshVertex& v : brick->mesh.vertices) {
            const Vec3 p(v.position), n = unpacked_normal(v);
            if (std::abs(p.x) > 44.0) continue;
            if (v.tint == 1) { // towards the axis of the groove
                const Vec3 expected = glm::normalize(Vec3(0, -p.y, 2.0 - p.z));
                EXPECT_GT(glm::dot(n, expected), 0.995) << p.x << ' ' << p.y << ' ' << p.z;
                ++round;
            } else if (p.z > -0.01) {
                const double along = std::max({n.z, n.y, -n.y});
                EXPECT_GT(along, 0.999);
                ++flat;
            }
        }
        for (const auto& [a, b] : brick->mesh.edges) // rims of the groove and edges of the block
            EXPECT_TRUE(std::abs(std::abs(a.y) - 7.746F) < 0.1F || std::abs(a.y) > 29.9F
                        || std::abs(a.x) > 44.9F || a.z < -29.9F)
                << a.x << ' ' << a.y << ' ' << a.z;
    }
    EXPECT_GT(round, 3000u);
    EXPECT_GT(flat, 3000u);
}

TEST(StockSurface, HasNoEdgesWithinAFaceThatPassesMeet) {
    // Lines run exactly where one pass ends within another, and in the plane of the first floor.
    CutModel model = block_model(0.5);
    for (const double z : {-2.75, -5.75})
        for (const double y : {-8.1, -4.0, 0.1})
            cut(model, {flat_cutter(4.25), {-30, y, z}, {30, y, z}, core::Mat3(1.0), 1});
    size_t edges = 0;
    for (const auto& brick : stock_bricks(model))
        for (const auto& [a, b] : brick->mesh.edges) {
            const Vec3 middle = 0.5 * (Vec3(a) + Vec3(b));
            const bool in_floor = middle.z < -5.7 && middle.z > -5.8;
            if (std::abs(middle.x) > 25.0 || (!in_floor && middle.z < -6.0)) continue;
            ++edges;
            if (in_floor) {
                EXPECT_NEAR(std::abs(middle.y + 4.0), 8.35, 0.02); // the feet of the walls
            } else {
                EXPECT_GT(middle.z, -0.1);
            }
        }
    EXPECT_GT(edges, 300u);
}

TEST(StockSurface, HasNoEdgesWhereALevelEndsOnARoundWall) {
    CutModel model = block_model(0.5);
    for (const double z : {-2.75, -5.75}) // lines run in the plane of the first floor
        cut(model, {flat_cutter(8.1), {0, 0, z + 20}, {0, 0, z}, core::Mat3(1.0), 1});
    size_t rims = 0;
    for (const auto& brick : stock_bricks(model))
        for (const auto& [a, b] : brick->mesh.edges) {
            if (std::max(std::abs(a.x), std::abs(a.y)) > 20.0F || a.z < -20.0F) continue;
            EXPECT_TRUE(std::abs(a.z) < 0.01F || std::abs(a.z + 5.75F) < 0.01F) << a.z;
            ++rims;
        }
    EXPECT_GT(rims, 150u);
}

TEST(StockSurface, StartsAgainForAnotherGrid) {
    StockSurface surface;
    surface.update(block_model(0.9));
    const CutModel other = block_model(1.1);
    surface.update(other);
    EXPECT_TRUE(are_same(surface.bricks(), stock_bricks(other)));
}

} // namespace
} // namespace render
