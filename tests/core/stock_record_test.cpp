#include <random>

#include <gtest/gtest.h>

#include "core/dbm/stock_record.h"
#include "core/geom/mesh.h"
#include "tests/support/stock_oracle.h"

namespace core {
namespace {

using test_support::CutBox;
using test_support::random_cut_box;

bool same_stock(const CutModel& a, const CutModel& b) {
    bool same = a.columns == b.columns && a.lines.grid == b.lines.grid;
    for (size_t axis = 0; axis < 3; ++axis)
        same = same && a.lines.families[axis] == b.lines.families[axis];
    return same;
}

CutModel cut_again(const StockRecord& record, double spacing) {
    CutModel model = *make_cut_model(record.solid, spacing);
    for (const CutterSweep& sweep : record.sweeps) cut(model, sweep);
    return model;
}

TEST(StockRecord, GivesTheSameStockAgainAtAnyMeshSize) {
    std::mt19937 rng(5);
    for (int i = 0; i < 20; ++i) {
        const CutBox world = random_cut_box(rng, 1 + i % 9, i % 3 ? 0.0 : 0.1);
        const auto record = stock_record(bytes_of(record_of(world.model(0.7))));
        ASSERT_TRUE(record) << record.error().message;
        EXPECT_EQ(record->spacing, 0.7);
        EXPECT_TRUE(same_stock(cut_again(*record, 0.7), world.model(0.7)));
        EXPECT_TRUE(same_stock(cut_again(*record, 0.4), world.model(0.4)));
        for (const CutterSweep& sweep : record->sweeps) EXPECT_EQ(sweep.block, earlier_block);
    }
}

TEST(StockRecord, KeepsWhatACutterIsCertainToCut) {
    // Flutes of 10 mm that are only certain to cut 9 mm.
    const RevolvedProfile full{{{0.0, 5.0, 20.0, 5.0, 0.0}}}, certain{{{0.0, 4.5, 20.0, 4.5, 0.0}}};
    Cutter cutter = make_cutter(certain, 0.0);
    cutter.flutes = full;
    CutModel model = *make_cut_model({SolidBox{{{0, 0, 0}, {40, 40, 10}}}}, 0.7);
    cut(model, {.cutter = std::make_shared<const Cutter>(cutter),
                .from = {-10, 20, 4},
                .to = {50, 20, 4}});
    const auto again = stock_record(bytes_of(record_of(model)));
    ASSERT_TRUE(again);
    EXPECT_TRUE(same_stock(cut_again(*again, 0.7), model));
}

/// The lower bound of an uncertain stock counts what its cutters may have left, even all of it.
TEST(StockRecord, CountsHowFarItsCutsMayBeOff) {
    std::mt19937 rng(6);
    double more = 0.0;
    for (int i = 0; i < 20; ++i) {
        const CutBox world = random_cut_box(rng, 1 + i % 9, 0.0);
        const CutModel exact = world.model(0.7);
        const auto again = stock_record(bytes_of(record_of(exact, i % 4 == 3 ? 30.0 : 0.2)));
        ASSERT_TRUE(again) << again.error().message;
        const CutModel about = cut_again(*again, 0.7);
        for (int x = 0; x < exact.columns.u_count(); ++x)
            for (int y = 0; y < exact.columns.v_count(); ++y) {
                const auto height = [](const auto& column) {
                    double sum = 0.0;
                    for (const Interval& matter : column) sum += matter.length();
                    return sum;
                };
                const double before = height(exact.columns.line(x, y)),
                             after = height(about.columns.line(x, y));
                EXPECT_GE(after, before - 1e-9);
                more += after - before;
            }
        // What an earlier program has counted is not counted again.
        const StockRecord third = record_of(about, 0.5);
        for (size_t k = 0; k < third.sweeps.size(); ++k)
            EXPECT_EQ(third.sweeps[k].cutter->path_error, again->sweeps[k].cutter->path_error);
    }
    EXPECT_GT(more, 0.0);
}

TEST(StockRecord, KeepsCylindersMeshesAndTolerances) {
    const Solid round{SolidCylinder{{1, 2, 3}, 20.0, 50.0, 0}, 0.25};
    const auto again = stock_record(bytes_of({round, 0.5, {}}));
    ASSERT_TRUE(again);
    const auto& cylinder = std::get<SolidCylinder>(again->solid.shape);
    EXPECT_EQ(cylinder.base, Vec3(1, 2, 3));
    EXPECT_EQ(cylinder.height, 50.0);
    EXPECT_EQ(cylinder.axis, 0);
    EXPECT_EQ(again->solid.tolerance, 0.25);
    const Mesh mesh = mesh_of(Aabb{{0, 0, 0}, {1, 2, 3}});
    const auto solid = stock_record(bytes_of({{solid_mesh(mesh), 0.0}, 0.5, {}}));
    ASSERT_TRUE(solid);
    const auto& kept = *std::get<SolidMesh>(solid->solid.shape).mesh;
    EXPECT_EQ(kept.vertices, mesh.vertices);
    EXPECT_EQ(kept.triangles, mesh.triangles);
    EXPECT_EQ(solid->solid.deviation, 0.0);
}

TEST(StockRecord, KeepsTheDeviationOfAMeshWhereverItIsMoved) {
    const Mesh mesh = mesh_of(Aabb{{0, 0, 0}, {1, 2, 3}});
    const StockRecord record{
        {.shape = solid_mesh(mesh), .tolerance = 0.3, .deviation = 0.1}, 0.5, {}};
    const auto again = stock_record(bytes_of(record));
    ASSERT_TRUE(again);
    EXPECT_EQ(again->solid.deviation, 0.1);
    EXPECT_EQ(again->solid.tolerance, 0.3);
    const auto there = moved(*again, translation({5, 0, 0}));
    ASSERT_TRUE(there);
    EXPECT_EQ(there->solid.deviation, 0.1);
    // More than the tolerance is damage.
    const StockRecord wrong{
        {.shape = solid_mesh(mesh), .tolerance = 0.1, .deviation = 0.3}, 0.5, {}};
    EXPECT_FALSE(stock_record(bytes_of(wrong)));
}

TEST(StockRecord, WritesLittleForContinuedMoves) {
    CutModel model = *make_cut_model({SolidBox{{{0, 0, -10}, {50, 50, 0}}}, 0.0}, 2.0);
    const auto cutter = std::make_shared<Cutter>(make_cutter({{{0, 3, 20, 3, 0}}}, 0.0));
    Vec3 at(5, 5, -1);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 to = at + Vec3(0.04, 0.03, 0.0);
        cut(model, {cutter, at, to});
        at = to;
    }
    EXPECT_LT(bytes_of(record_of(model)).size(), 26'000u);
}

/// Whether a point of a box remains after cutting, or is too close to a cut to decide.
enum class Left { yes, no, near };

Left is_left(const CutBox& world, const Vec3& p) {
    const double inside = -std::sqrt(distance_squared(p, world.box));
    if (inside < 0.0) return Left::no;
    const double outside = world.outside_cuts(p);
    if (std::abs(outside) < 0.02) return Left::near;
    return outside > 0.0 ? Left::yes : Left::no;
}

TEST(StockRecord, TurnedOverKeepsEveryPointWhereItBelongs) {
    std::mt19937 rng(9);
    int left = 0, gone = 0;
    for (int i = 0; i < 12; ++i) {
        const CutBox world = random_cut_box(rng, 6, 0.0);
        const Transform over{rotation_xyz_deg(i % 2 ? Vec3(180, 0, 90) : Vec3(180, 25, 40)),
                             Vec3(10, -20, 5)};
        const auto turned = moved(record_of(world.model(0.7)), over);
        ASSERT_TRUE(turned);
        const CutModel model = cut_again(*turned, 0.7);
        for (int k = 0; k < 300; ++k) {
            const Vec3 p = test_support::random_point(world.box, rng);
            const Left truth = is_left(world, p);
            if (truth == Left::near) continue;
            const Vec3 q = over * p;
            for (int axis = 0; axis < 3; ++axis) {
                // The line exactly through the point, computed from the solid and the moves.
                IntervalList line = line_of(turned->solid, axis, q[u_axis(axis)], q[v_axis(axis)]);
                for (const CutterSweep& sweep : turned->sweeps)
                    for (const Cutter::Piece& piece : sweep.cutter->pieces)
                        if (const auto cut_away = line_interval(piece.around, sweep, axis,
                                                                q[u_axis(axis)], q[v_axis(axis)]))
                            line.subtract(*cut_away);
                EXPECT_EQ(line.contains(q[axis]), truth == Left::yes);
            }
            ++(truth == Left::yes ? left : gone);
        }
        EXPECT_GT(point_count(model.lines), 0U);
    }
    EXPECT_GT(left, 500);
    EXPECT_GT(gone, 500);
}

TEST(StockRecord, OfARoundStockTurnsByRightAnglesOnly) {
    const StockRecord record{{SolidCylinder{{0, 0, 0}, 20.0, 50.0, 2}, 0.0}, 0.5, {}};
    const auto lying = moved(record, {rotation_xyz_deg({90, 0, 0}), Vec3(0.0)});
    ASSERT_TRUE(lying);
    const auto& cylinder = std::get<SolidCylinder>(lying->solid.shape);
    EXPECT_EQ(cylinder.axis, 1);
    EXPECT_NEAR(cylinder.base.y, -50.0, 1e-12);
    const auto askew = moved(record, {rotation_xyz_deg({45, 0, 0}), Vec3(0.0)});
    ASSERT_FALSE(askew);
    EXPECT_NE(askew.error().message.find("round stock"), std::string::npos);
}

TEST(StockRecord, RefusesBytesThatWereChangedOrCutOff) {
    std::mt19937 rng(5);
    const std::string good = bytes_of(record_of(random_cut_box(rng, 4, 0.0).model(0.7)));
    EXPECT_NE(stock_record("solid cube\n").error().message.find("not a stock file"),
              std::string::npos);
    for (size_t length = 15; length < good.size(); length += 37)
        EXPECT_FALSE(stock_record(good.substr(0, length))) << length;
    for (int i = 0; i < 300; ++i) {
        std::string bad = good;
        bad[15 + rng() % (bad.size() - 15)] ^= static_cast<char>(1U << rng() % 8);
        const auto read = stock_record(bad);
        ASSERT_FALSE(read);
        EXPECT_NE(read.error().message.find("damaged"), std::string::npos);
    }
}

} // namespace
} // namespace core
