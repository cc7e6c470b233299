#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/dbm/cut_model.h"
#include "core/dbm/stock_mesh.h"
#include "core/geom/mesh_file.h"
#include "core/geom/triangle_distance.h"
#include "core/sim/part_comparison.h"
#include "core/sim/setup.h"
#include "tests/support/meshes.h"

namespace core {
namespace {

/// The block of 60 x 40 x 20 with its top at Z 0; the slot of 6.3 x 5.3 runs along X at Y 20.1.
const Aabb block{{0, 0, -20}, {60, 40, 0}};
constexpr double slot_low = 20.1 - 3.15, slot_high = 20.1 + 3.15, floor_z = -5.3;

CutModel block_model(double h = 0.5) { return *make_cut_model({SolidBox{block}, 0.0}, h); }

std::shared_ptr<const Cutter> flat_cutter(double radius) {
    return std::make_shared<Cutter>(make_cutter({{{0, radius, 30, radius, 0}}}, 0.0));
}

void cut_in_block(CutModel& model, uint32_t number, double radius, const Vec3& from,
                  const Vec3& to) {
    CutterSweep sweep{flat_cutter(radius), from, to};
    sweep.block = number;
    cut(model, sweep);
}

CutModel slotted_model() {
    CutModel model = block_model();
    cut_in_block(model, 7, 3.15, {-10, 20.1, floor_z}, {70, 20.1, floor_z});
    return model;
}

Part part_of(Mesh mesh, double tolerance = 0.05) {
    std::vector<std::string> repairs;
    return {solid_mesh(*checked_solid(std::move(mesh), repairs)), tolerance};
}

/// The block with its slot, moved along Y; exact corners, from an outline across X.
Mesh slotted_part(double moved = 0.0) {
    const double outline[8][2] = {{0, -20},
                                  {40, -20},
                                  {40, 0},
                                  {slot_high, 0},
                                  {slot_high, floor_z},
                                  {slot_low, floor_z},
                                  {slot_low, 0},
                                  {0, 0}};
    const uint32_t caps[6][3] = {{0, 1, 4}, {0, 4, 5}, {0, 5, 7}, {5, 6, 7}, {1, 2, 4}, {2, 3, 4}};
    Mesh mesh;
    for (const double x : {0.0, 60.0})
        for (const auto& p : outline) mesh.vertices.emplace_back(x, p[0] + moved, p[1]);
    for (const auto& t : caps) {
        mesh.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
        mesh.triangles.push_back({t[2], t[1], t[0]});
    }
    for (uint32_t i = 0; i < 8; ++i) {
        const uint32_t next = (i + 1) % 8;
        mesh.triangles.push_back({i, next, next + 8});
        mesh.triangles.push_back({i, next + 8, i + 8});
    }
    return mesh;
}

PartComparison compare(const CutModel& stock, const Part& part) {
    return compare_with_part(stock, stock_mesh(stock), part);
}

size_t count(const PartComparison& result, Deviation kind) {
    return static_cast<size_t>(std::count_if(result.regions.begin(), result.regions.end(),
                                             [&](const auto& r) { return r.kind == kind; }));
}

TEST(PartComparison, FindsNothingWhereTheResultIsThePart) {
    const PartComparison result = compare(slotted_model(), part_of(slotted_part(), 0.001));
    EXPECT_LT(result.largest_gouge, 1e-5);
    EXPECT_LT(result.largest_excess, 1e-5);
    EXPECT_TRUE(result.regions.empty());
    EXPECT_GT(result.samples, 40'000u);
    EXPECT_LT(result.between_samples, 0.5 * std::sqrt(3.0));
}

TEST(PartComparison, SeesAPartThatIsMoved) {
    const PartComparison result = compare(slotted_model(), part_of(slotted_part(0.1)));
    EXPECT_NEAR(result.largest_gouge, 0.1, 1e-5);
    EXPECT_NEAR(result.largest_excess, 0.1, 1e-5);
    // One side of the slot and one side of the block each.
    ASSERT_EQ(count(result, Deviation::gouge), 2u);
    ASSERT_EQ(count(result, Deviation::excess), 2u);
    for (const DeviationRegion& region : result.regions) {
        const bool in_slot = std::abs(region.position.y - 20.1) < 4.0;
        EXPECT_EQ(region.block, in_slot ? std::optional(7u) : std::nullopt);
        const bool low = region.position.y < 20.1;
        EXPECT_EQ(region.kind, low == in_slot ? Deviation::gouge : Deviation::excess);
        EXPECT_NEAR(region.area, 60.0 * (in_slot ? 5.3 : 20.0), 60.0 * 1.2);
    }
}

TEST(PartComparison, IsContentWithinTheTolerance) {
    const PartComparison result = compare(slotted_model(), part_of(slotted_part(0.1), 0.11));
    EXPECT_TRUE(result.regions.empty());
    EXPECT_NEAR(result.largest_excess, 0.1, 1e-5);
}

TEST(PartComparison, NamesTheBlockOfAPocketTooMany) {
    CutModel stock = slotted_model();
    cut_in_block(stock, 9, 4.0, {45, 8, -3}, {45, 8, 5});
    const PartComparison result = compare(stock, part_of(slotted_part()));
    ASSERT_EQ(result.regions.size(), 1u);
    const DeviationRegion& pocket = result.regions[0];
    EXPECT_EQ(pocket.kind, Deviation::gouge);
    EXPECT_NEAR(pocket.amount, 3.0, 1e-5);
    EXPECT_EQ(pocket.block, 9u);
    EXPECT_LT(glm::distance(pocket.position, Vec3(45, 8, -1.5)), 4.5);
}

TEST(PartComparison, MeasuresAGougedWall) {
    CutModel stock = slotted_model();
    cut_in_block(stock, 11, 1.0, {20, slot_high - 0.7, -4}, {30, slot_high - 0.7, -4});
    const PartComparison result = compare(stock, part_of(slotted_part()));
    ASSERT_EQ(result.regions.size(), 1u);
    EXPECT_EQ(result.regions[0].kind, Deviation::gouge);
    // Where the gouge is narrower than the mesh size, the mesh of the stock is coarse.
    EXPECT_NEAR(result.regions[0].amount, 0.3, 0.02);
    EXPECT_EQ(result.regions[0].block, 11u);
}

TEST(PartComparison, NamesTheBlockOfTheDeepestGouge) {
    CutModel stock = slotted_model();
    cut_in_block(stock, 9, 4.0, {45, 8, -3}, {45, 8, 5});
    cut_in_block(stock, 12, 2.0, {49, 8, -1}, {52, 8, -1});
    const PartComparison result = compare(stock, part_of(slotted_part()));
    ASSERT_EQ(result.regions.size(), 1u);
    EXPECT_EQ(result.regions[0].block, 9u);
}

/// The mesh of the stock is as coarse as its lines; that of the part is ten times as fine.
TEST(PartComparison, TakesACoarseMeshForNoGouge) {
    const auto bumps = [](double h) {
        CutModel model = *make_cut_model({SolidBox{block}, 0.0}, h);
        for (double y = 4.0; y < 40.0; y += 4.0) {
            const RevolvedProfile ball{{{3, 0, 3, 0, 3}, {3, 3, 30, 3, 0}}};
            cut(model,
                {std::make_shared<Cutter>(make_cutter(ball, 0.0)), {-10, y, -4}, {70, y, -4}});
        }
        return model;
    };
    const Part part = part_of(stock_mesh(bumps(0.4)).mesh, 0.02);
    const PartComparison result = compare(bumps(1.6), part);
    EXPECT_EQ(count(result, Deviation::gouge), 0u);
    EXPECT_LT(result.largest_excess, 0.02);
}

TEST(PartComparison, SeesWhatWasNeverCut) {
    const PartComparison result = compare(block_model(), part_of(slotted_part()));
    EXPECT_EQ(result.largest_gouge, 0.0);
    ASSERT_EQ(result.regions.size(), 1u);
    EXPECT_EQ(result.regions[0].kind, Deviation::excess);
    EXPECT_NEAR(result.regions[0].amount, 3.15, 0.25); // from the opening's middle to the walls
    EXPECT_FALSE(result.regions[0].block);
}

TEST(PartComparison, SeesAFinThatIsGone) {
    // The part is the block with a fin of 0.3 mm, thinner than the mesh size, 10 mm high.
    Mesh part = test_support::box_mesh({0, 0, -20}, {60, 40, -10});
    const Mesh fin = test_support::box_mesh({20, 20, -10.5}, {40, 20.3, 0});
    const auto first = static_cast<uint32_t>(part.vertices.size());
    part.vertices.insert(part.vertices.end(), fin.vertices.begin(), fin.vertices.end());
    for (const Mesh::Corners& t : fin.triangles)
        part.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    CutModel stock = block_model();
    cut_in_block(stock, 3, 60.0, {30, 20, -10}, {31, 20, -10});
    const PartComparison result = compare(stock, part_of(std::move(part)));
    EXPECT_NEAR(result.largest_gouge, 10.0, 1e-6);
    ASSERT_FALSE(result.regions.empty());
    EXPECT_EQ(result.regions[0].block, 3u);
}

TEST(PartComparison, SaysThatAllIsMissingWhereNothingIsLeft) {
    CutModel stock = block_model(1.0);
    cut_in_block(stock, 5, 80.0, {30, 20, -21}, {31, 20, -21});
    const PartComparison result = compare(stock, part_of(slotted_part()));
    ASSERT_EQ(result.regions.size(), 1u);
    EXPECT_GT(result.largest_gouge, 60.0);
    EXPECT_EQ(result.regions[0].block, 5u);
}

TEST(PartComparison, GivesVerticesTheWorstThatIsNear) {
    const CutModel stock = slotted_model();
    const StockMesh surface = stock_mesh(stock);
    const PartComparison result = compare_with_part(stock, surface, part_of(slotted_part(0.1)));
    ASSERT_EQ(result.deviations.size(), surface.mesh.vertices.size());
    for (size_t i = 0; i < result.deviations.size(); ++i) {
        const Vec3& p = surface.mesh.vertices[i];
        EXPECT_LE(std::abs(result.deviations[i]), 0.1 + 1e-5);
        if (std::abs(p.y - slot_high) < 1e-6 && p.z > floor_z + 1.0) {
            EXPECT_NEAR(result.deviations[i], 0.1, 1e-5);
        }
        if (std::abs(p.y - slot_low) < 1e-6 && p.z > floor_z + 1.0) {
            EXPECT_NEAR(result.deviations[i], -0.1, 1e-5);
        }
    }
}

TEST(NearestSurface, FindsWhatLookingAtEveryTriangleFinds) {
    const Mesh mesh = slotted_part();
    const TriangleBvh bvh = build_bvh(mesh);
    SurfaceTracker tracker(bvh);
    std::mt19937_64 random(4);
    const auto between = [&](double low, double high) {
        return low + (high - low) * (static_cast<double>(random() >> 11U) * 0x1p-53);
    };
    for (int k = 0; k < 2000; ++k) {
        const Vec3 p(between(-20, 80), between(-20, 60), between(-40, 20));
        double nearest = infinity;
        for (size_t i = 0; i < mesh.triangles.size(); ++i)
            nearest = std::min(nearest, separation(convex_segment(p, p), convex(mesh.triangle(i)),
                                                   {.tolerance = 1e-10})
                                            .upper);
        EXPECT_NEAR(nearest_surface(bvh, p).distance, nearest, 1e-6);
        EXPECT_NEAR(tracker.at(p).distance, nearest, 1e-6);
        EXPECT_EQ(nearest_surface(bvh, p, nearest * 0.99).distance, infinity);
    }
}

} // namespace
} // namespace core
