#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/dbm/contour.h"
#include "core/dbm/cut_model.h"
#include "core/dbm/dual_cell.h"
#include "core/dbm/stock_mesh.h"
#include "core/geom/mesh.h"
#include "core/geom/mesh_file.h"
#include "tests/support/scoped_folder.h"

namespace core {
namespace {

constexpr double pi = std::numbers::pi;

const Aabb block{{0, 0, -20}, {60, 40, 0}};

CutModel block_model(double h) { return *make_cut_model({SolidBox{block}, 0.0}, h); }

std::shared_ptr<const Cutter> flat_cutter(double radius) {
    return std::make_shared<Cutter>(make_cutter({{{0, radius, 30, radius, 0}}}, 0.0));
}

std::shared_ptr<const Cutter> ball_cutter(double radius) {
    return std::make_shared<Cutter>(
        make_cutter({{{radius, 0, radius, 0, radius}, {radius, radius, 30, radius, 0}}}, 0.0));
}

/// Whether every edge is used equally often in both directions, as in a closed surface.
bool is_closed(const Mesh& mesh) {
    std::map<std::pair<uint32_t, uint32_t>, int> passes;
    for (const Mesh::Corners& t : mesh.triangles)
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t a = t[k], b = t[(k + 1) % 3];
            passes[std::minmax(a, b)] += a < b ? 1 : -1;
        }
    return std::all_of(passes.begin(), passes.end(), [](const auto& p) { return p.second == 0; });
}

/// The mean volume of the three families of lines.
double model_volume(const CutModel& model) {
    const ScanGrid& grid = model.lines.grid;
    double length = 0.0;
    for (const ScanLines& family : model.lines.families)
        for (int v = 0; v < family.v_count(); ++v)
            for (int u = 0; u < family.u_count(); ++u)
                for (const Interval& matter : family.line(u, v)) length += matter.length();
    return length * grid.spacing * grid.spacing / 3.0;
}

/// The volume of the surface after writing it to a file and reading it back.
double file_volume(const Mesh& mesh, const std::string& ending) {
    const test_support::ScopedFolder folder;
    const std::string bytes =
        ending == "stl" ? stl_bytes(mesh, "a test") : ply_bytes(mesh, {"a test"});
    const auto read = read_mesh(folder.write("stock." + ending, bytes));
    EXPECT_TRUE(read) << read.error().message;
    return read ? signed_volume(read->mesh) : 0.0;
}

TEST(StockMesh, IsTheBlockBeforeAnythingIsCut) {
    for (const double h : {0.5, 0.7, 3.0}) {
        const StockMesh surface = stock_mesh(block_model(h));
        EXPECT_TRUE(is_closed(surface.mesh));
        EXPECT_NEAR(signed_volume(surface.mesh), 60.0 * 40.0 * 20.0, 1e-6) << h;
        EXPECT_LT(surface.error, 1e-9);
        EXPECT_EQ(surface.lost, 0u);
        const Aabb box = surface.mesh.bounds();
        EXPECT_LT(glm::length(box.min - block.min) + glm::length(box.max - block.max), 1e-9);
    }
}

TEST(StockMesh, KeepsTheEdgesOfASlot) {
    CutModel model = block_model(0.5);
    cut(model, {flat_cutter(3.15), {-10, 20.1, -5.3}, {70, 20.1, -5.3}});
    const StockMesh surface = stock_mesh(model);
    EXPECT_TRUE(is_closed(surface.mesh));
    EXPECT_NEAR(signed_volume(surface.mesh), 60.0 * (40.0 * 20.0 - 6.3 * 5.3), 1e-3);
    EXPECT_LT(surface.error, 1e-6);
    EXPECT_EQ(surface.lost, 0u);
    for (const Vec3& p : surface.mesh.vertices) {
        const double out =
            std::max({std::abs(p.x - 30) - 30, std::abs(p.y - 20) - 20, -20 - p.z, p.z});
        const double in_slot = std::min(3.15 - std::abs(p.y - 20.1), p.z + 5.3);
        EXPECT_NEAR(std::max(out, in_slot), 0.0, 1e-5); // on the outside or the slot
    }
}

TEST(StockMesh, KeepsTheEdgesOfASlotThatRunsAskew) {
    CutModel model = block_model(0.5);
    const Vec3 along = glm::normalize(Vec3(3, 1, 0)), across(-along.y, along.x, 0);
    const Vec3 start = Vec3(30, 20, -4) - 100.0 * along;
    cut(model, {flat_cutter(4.0), start, start + 200.0 * along});
    const StockMesh surface = stock_mesh(model);
    EXPECT_TRUE(is_closed(surface.mesh));
    // The slot leaves the block through the sides 60 mm apart in X: its length inside is 60 /
    // along.x.
    EXPECT_NEAR(signed_volume(surface.mesh), 48'000.0 - 8.0 * 4.0 * 60.0 / along.x, 0.5);
    double beside = 0.0;
    for (const Vec3& p : surface.mesh.vertices) {
        if (p.z < -3.9 || p.z > -0.1 || std::abs(p.x - 30) > 29) continue;
        if (std::abs(p.y - 20) > 19.5) continue;
        beside = std::max(beside, std::abs(std::abs(glm::dot(p - Vec3(30, 20, 0), across)) - 4.0));
    }
    EXPECT_LT(beside, 1e-5);
    EXPECT_LT(surface.error, 1e-5);
}

TEST(StockMesh, KeepsTheBottomOfASlopedVee) {
    // Its bottom runs between the lines, and through cells in which no line crosses the surface.
    double volumes[2];
    for (const double h : {1.0, 0.4}) {
        CutModel model = block_model(h);
        const auto vee = std::make_shared<Cutter>(make_cutter({{{0, 0, 30, 20, 0}}}, 0.0));
        cut(model, {vee, {-10, 3, -5}, {70, 37, -9}});
        const StockMesh surface = stock_mesh(model);
        EXPECT_TRUE(is_closed(surface.mesh));
        EXPECT_LT(surface.error, 1e-4) << h;
        volumes[h < 1.0] = signed_volume(surface.mesh);
    }
    EXPECT_NEAR(volumes[0], volumes[1], 0.1);
}

TEST(StockMesh, RoundsABallPocketWithinItsBound) {
    const double r = 6.0;
    for (const double h : {1.0, 0.5, 0.25}) {
        CutModel model = block_model(h);
        cut(model, {ball_cutter(r), {30, 20, -r}, {30, 20, 20}});
        const StockMesh surface = stock_mesh(model);
        EXPECT_TRUE(is_closed(surface.mesh));
        // A vertex between lines deviates from the ball by at most the sag of a cell's diagonal.
        const double sag = 3.0 * h * h / (8.0 * r) * 4.0;
        EXPECT_NEAR(signed_volume(surface.mesh), 48'000.0 - 2.0 / 3.0 * pi * r * r * r,
                    2.0 * pi * r * r * sag);
        EXPECT_LT(surface.error, 0.005 * h);
        for (const Vec3& p : surface.mesh.vertices) {
            const double away = glm::distance(p, Vec3(30, 20, 0));
            if (p.z < -0.01 && away < 8.0) {
                EXPECT_NEAR(away, r, sag);
            }
        }
        EXPECT_NEAR(signed_volume(surface.mesh), model_volume(model), 48'000.0 * 0.02 * h);
    }
}

TEST(StockMesh, IsClosedAfterAnyCut) {
    std::mt19937_64 random(3);
    const auto between = [&](double low, double high) {
        return low + (high - low) * (static_cast<double>(random() >> 11U) * 0x1p-53);
    };
    for (int round = 0; round < 6; ++round) {
        CutModel model = block_model(1.0);
        for (int k = 0; k < 30; ++k) {
            const auto cutter = k % 2 ? flat_cutter(between(0.3, 4)) : ball_cutter(between(0.3, 4));
            const auto position = [&] {
                return Vec3(between(-5, 65), between(-5, 45), between(-22, 0));
            };
            cut(model, {cutter, position(), position()});
        }
        const StockMesh surface = stock_mesh(model);
        EXPECT_TRUE(is_closed(surface.mesh));
        const double volume = signed_volume(surface.mesh);
        EXPECT_NEAR(volume, model_volume(model), 0.02 * volume) << round;
        for (const std::string ending : {"stl", "ply"})
            EXPECT_NEAR(file_volume(surface.mesh, ending), volume, 1e-3 * volume) << ending;
        for (const Vec3& p : surface.mesh.vertices) EXPECT_LE(distance_squared(p, block), 1e-18);
    }
}

TEST(StockMesh, HasTheSameBitsEveryTime) {
    CutModel model = block_model(0.7);
    cut(model, {ball_cutter(4.0), {5, 5, -3}, {50, 30, -6}});
    const StockMesh once = stock_mesh(model), again = stock_mesh(model);
    EXPECT_EQ(ply_bytes(once.mesh, {}), ply_bytes(again.mesh, {}));
}

TEST(StockMesh, ReportsDetailsThatAreLost) {
    // A wall of 0.2 mm between two slots, thinner than the mesh size and between two lines.
    CutModel model = block_model(1.0);
    for (const double y : {15.0 - 3.1, 15.0 + 3.1})
        cut(model, {flat_cutter(3.0), {-10, y, -5}, {70, y, -5}});
    const StockMesh surface = stock_mesh(model);
    EXPECT_TRUE(is_closed(surface.mesh));
    EXPECT_GT(surface.lost, 100u);
}

TEST(StockMesh, IsEmptyWhenNothingIsLeft) {
    CutModel model = block_model(1.0);
    cut(model, {flat_cutter(80.0), {30, 20, -21}, {31, 20, -21}});
    const StockMesh surface = stock_mesh(model);
    EXPECT_TRUE(surface.mesh.triangles.empty());
}

TEST(StockMesh, KeepsAMeshAsItIs) {
    // The block as a mesh, made of its own surface.
    Mesh mesh = stock_mesh(block_model(5.0)).mesh;
    CutModel model = *make_cut_model({solid_mesh(std::move(mesh)), 0.0}, 0.9);
    const StockMesh surface = stock_mesh(model);
    EXPECT_TRUE(is_closed(surface.mesh));
    EXPECT_NEAR(signed_volume(surface.mesh), 48'000.0, 1e-5);
}

TEST(StockMesh, KeepsTheRimOfACylinder) {
    const CutModel model = *make_cut_model({SolidCylinder{{0, 0, 0}, 10, 20, 2}, 0.0}, 0.5);
    const StockMesh surface = stock_mesh(model);
    EXPECT_TRUE(is_closed(surface.mesh));
    EXPECT_NEAR(signed_volume(surface.mesh), pi * 100 * 20, 2.0);
    EXPECT_NEAR(surface.mesh.bounds().max.z, 20.0, 1e-9);
    EXPECT_NEAR(surface.mesh.bounds().min.z, 0.0, 1e-9);
}

TEST(DualCell, GivesEveryPassedEdgeToOnePiece) {
    size_t several = 0;
    for (unsigned inside = 0; inside < 256; ++inside) {
        const DualCell& cell = dual_cell(static_cast<uint8_t>(inside));
        for (size_t e = 0; e < 12; ++e) {
            const bool passes =
                (inside >> cell_edges[e].lower & 1U) != (inside >> cell_edges[e].upper & 1U);
            EXPECT_EQ(cell.piece[e] != DualCell::none, passes);
            if (passes) {
                EXPECT_LT(cell.piece[e], cell.count);
            }
        }
        several += cell.count > 1;
    }
    EXPECT_EQ(dual_cell(0b1000'0001).count, 2); // across the cell: two corners cut off
    EXPECT_EQ(dual_cell(0b0110'1001).count, 4); // every other corner
    EXPECT_EQ(dual_cell(0b0000'1111).count, 1); // a flat surface
    EXPECT_GT(several, 50u);
}

TEST(FeaturePoint, LiesOnTheEdgeOfTwoPlanesAndTheCornerOfThree) {
    const Aabb cell{{0, 0, 0}, {1, 1, 1}};
    const TangentPlane x{{0.3, 0.9, 0.5}, {1, 0, 0}}, y{{0.9, 0.7, 0.5}, {0, 1, 0}},
        z{{0.1, 0.1, 0.2}, {0, 0, 1}};
    const TangentPlane edge[] = {x, y, x, y}, all[] = {x, y, z}, one[] = {x, x};
    EXPECT_LT(glm::distance(feature_point(edge, cell), Vec3(0.3, 0.7, 0.5)), 1e-12);
    EXPECT_LT(glm::distance(feature_point(all, cell), Vec3(0.3, 0.7, 0.2)), 1e-12);
    EXPECT_LT(glm::distance(feature_point(one, cell), x.position), 1e-12);
}

} // namespace
} // namespace core
