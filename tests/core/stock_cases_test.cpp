#include <random>

#include <gtest/gtest.h>
#include <hwy/highway.h>
#include <hwy/targets.h>

#include "tests/support/raster_program.h"
#include "tests/support/stock_digest.h"
#include "tests/support/stock_oracle.h"

namespace core {
namespace {

using test_support::digest;

const RevolvedProfile flat{{{0, 3, 40, 3, 0}}};
const RevolvedProfile ball{{{3, 0, 3, 0, 3}, {3, 3, 40, 3, 0}}};
const RevolvedProfile t_slot{{{0, 6, 3, 6, 0}, {3, 2, 40, 2, 0}}};
const RevolvedProfile dovetail{{{0, 6, 6, 2, 0}, {6, 2, 40, 2, 0}}};

std::shared_ptr<const Cutter> cutter(const RevolvedProfile& flutes, double path_error = 0.0) {
    return std::make_shared<const Cutter>(make_cutter(flutes, path_error));
}

CutModel block(const Vec3& size, double spacing) {
    return make_cut_model({SolidBox{{{0, 0, -size.z}, {size.x, size.y, 0}}}, 0.0}, spacing).value();
}

/// The top of the material on the line along Z nearest to (x, y), and the position of that line.
struct Floor {
    double x, y, z;
};
Floor floor_at(const CutModel& model, double x, double y) {
    const ScanGrid& grid = model.lines.grid;
    const auto index = [&](int axis, double at) {
        return static_cast<int>(std::lround((at - grid.coordinate(axis, 0)) / grid.spacing));
    };
    const int u = index(0, x), v = index(1, y);
    return {grid.coordinate(0, u), grid.coordinate(1, v),
            model.lines.families[2].line(u, v).back().upper};
}

TEST(StockCase, ASlopeIsExactAllAlong) {
    // 60 mm long, from Z-1 to Z-9. At mid-length FreeCAD 0.20 cuts 17 mm too deep.
    for (const RevolvedProfile& tool : {flat, ball}) {
        CutModel model = block({80, 20, 30}, 0.5);
        cut(model, {cutter(tool), {10, 10, -1}, {70, 10, -9}});
        for (double x = 16.0; x < 64.0; x += 1.3) {
            const Floor floor = floor_at(model, x, 10.0);
            const double slope = -8.0 / 60.0, aside = floor.y - 10.0;
            const double half = std::sqrt(9.0 - aside * aside);
            // Flat: the last moment at which the rim is above the line. Ball: the cylinder it
            // sweeps.
            const double flat_z = -1.0 + slope * (floor.x + half - 10.0);
            const double ball_z =
                -1.0 + slope * (floor.x - 10.0) + 3.0 - half * std::sqrt(1.0 + slope * slope);
            EXPECT_NEAR(floor.z, tool.elements.size() == 1 ? flat_z : ball_z, 1e-9) << x;
        }
    }
}

TEST(StockCase, PecksGoDownStepByStep) {
    CutModel model = block({20, 20, 30}, 0.25);
    const auto drill = cutter({{{0, 0, 1.5, 2.5, 0}, {1.5, 2.5, 40, 2.5, 0}}});
    double removed = 0.0, z = 0.0;
    while (z > -25.0) {
        const double start = z == 0.0 ? 2.0 : z + 0.5;
        z -= 3.0;
        removed += cut(model, {drill, {10, 10, start}, {10, 10, z}});
        const Floor floor = floor_at(model, 10.0, 10.0);
        EXPECT_NEAR(floor.z, z + 1.5 / 2.5 * std::hypot(floor.x - 10.0, floor.y - 10.0), 1e-9);
        EXPECT_NEAR(cut(model, {drill, {10, 10, z}, {10, 10, 2}}), 0.0, 1e-9);
        EXPECT_NEAR(cut(model, {drill, {10, 10, 2}, {10, 10, z + 0.5}}), 0.0, 1e-9);
    }
    const double area = 2.5 * 2.5 * 3.14159265358979;
    const double whole = area * (-z - 1.5) + area * 1.5 / 3.0;
    EXPECT_NEAR(removed, whole, 0.01 * whole);
}

TEST(StockCase, AWallThinnerThanACellRemains) {
    constexpr double wall = 0.17;
    CutModel model = block({40, 30, 20}, 0.5);
    for (const double side : {-1.0, 1.0}) {
        const double y = 15.0 + side * (3.0 + 0.5 * wall);
        cut(model, {cutter(flat), {-5, y, -8}, {45, y, -8}});
    }
    const ScanGrid& grid = model.lines.grid;
    const ScanLines& across = model.lines.families[1]; // u: z, v: x
    for (int u = 0; u < across.u_count(); ++u) {
        if (grid.coordinate(2, u) < -8.0) continue;
        const LineView line = across.line(u, 20);
        ASSERT_EQ(line.size(), 3u);
        EXPECT_NEAR(line[1].length(), wall, 1e-9);
        EXPECT_NEAR(0.5 * (line[1].lower + line[1].upper), 15.0, 1e-9);
    }
}

TEST(StockCase, AScallopSmallerThanACellIsThere) {
    CutModel model = block({40, 30, 20}, 1.0);
    const auto tool = cutter(ball);
    for (double y = 1.0; y < 30.0; y += 0.8) cut(model, {tool, {-5, y, -6}, {45, y, -6}});
    int on_scallop = 0;
    for (double y = 6.5; y < 24.0; y += 1.0) {
        const Floor floor = floor_at(model, 20.0, y);
        const double nearest = std::abs(std::remainder(floor.y - 1.0, 0.8));
        EXPECT_NEAR(floor.z, -3.0 - std::sqrt(9.0 - nearest * nearest), 1e-9);
        on_scallop += nearest > 0.2;
    }
    EXPECT_GT(on_scallop, 4);
}

TEST(StockCase, UndercutsLeaveWhatIsAboveThem) {
    for (const RevolvedProfile& tool : {t_slot, dovetail}) {
        CutModel model = block({40, 40, 20}, 0.5);
        cut(model, {cutter(tool), {-10, 20, -10}, {50, 20, -10}});
        const double reach = tool.elements[0].r1; // at the upper end of the wide part
        const double top = -10.0 + tool.elements[0].z1;
        const ScanGrid& grid = model.lines.grid;
        int under = 0;
        for (int v = 0; v < grid.count(1); ++v) {
            const double aside = std::abs(grid.coordinate(1, v) - 20.0);
            const LineView line = model.lines.families[2].line(40, v);
            if (aside < 2.0) {
                EXPECT_EQ(line.size(), 1u);
                EXPECT_EQ(line.back().upper, -10.0);
            } else if (aside < 6.0) {
                ++under;
                ASSERT_EQ(line.size(), 2u);
                EXPECT_EQ(line[0].upper, -10.0);
                const double roof = reach == 6.0 ? top : -10.0 + (6.0 - aside) * 6.0 / 4.0;
                EXPECT_NEAR(line[1].lower, roof, 1e-9);
                EXPECT_EQ(line[1].upper, 0.0);
            } else {
                EXPECT_EQ(line.size(), 1u);
                EXPECT_EQ(line.back().upper, 0.0);
            }
        }
        EXPECT_EQ(under, 16);
    }
}

/// A tool that tilts while it moves, and the material removed at sampled positions.
struct Swarf {
    Mat3 orientation(double t) const { return rotation_xyz_deg({0.0, 10.0 + 20.0 * t, 5.0 * t}); }
    Vec3 tip(double t) const { return {5.0 + 30.0 * t, 15.0 + 2.0 * t, -12.0}; }
    double outside(const RevolvedProfile& tool, const Vec3& p) const {
        double least = infinity;
        for (int i = 0; i <= 400; ++i) {
            const Vec3 local = glm::transpose(orientation(i / 400.0)) * (p - tip(i / 400.0));
            least = std::min(least, test_support::outside(tool, local));
        }
        return least;
    }
};

TEST(StockCase, ASwarfMoveInStepsKeepsItsBound) {
    const RevolvedProfile tool{{{0, 3, 25, 3, 0}}};
    const Swarf swarf;
    constexpr int steps = 40;
    // Half a step of rotation, 20.6 degrees in all, at the upper end of the flutes; the path is
    // straight.
    const double error = 0.5 / steps * 20.7 / 57.29578 * std::hypot(25.0, 3.0) + 1e-6;
    CutModel model = block({40, 30, 20}, 0.8);
    const auto made = cutter(tool, error);
    for (int i = 0; i < steps; ++i) {
        const double from = double(i) / steps, to = double(i + 1) / steps;
        cut(model, {made, swarf.tip(from), swarf.tip(to), swarf.orientation(0.5 * (from + to))});
    }
    std::mt19937 rng(77);
    int held = 0, gone = 0;
    for (int k = 0; k < 4000; ++k) {
        const Vec3 p = test_support::random_point({{0, 0, -20}, {40, 30, 0}}, rng);
        const double outside = swarf.outside(tool, p);
        const int i = static_cast<int>(std::floor(p.x / 0.8 + 0.5));
        const int j =
            static_cast<int>(std::floor((p.y - model.lines.grid.coordinate(1, 0)) / 0.8)) + 1;
        const Square cell = cell_square(model, i, j);
        ASSERT_TRUE(cell.x0 <= p.x && p.x <= cell.x1 && cell.y0 <= p.y && p.y <= cell.y1);
        if (outside > 0.01) {
            ++held;
            EXPECT_TRUE(model.columns.line(i, j).contains(p.z));
        }
        const LineView line = model.lines.families[2].line(std::min(i, 49), 18);
        const Vec3 on_line = point_on_line(model.lines.grid, 2, std::min(i, 49), 18, p.z);
        if (swarf.outside(tool, on_line) < -0.01) {
            ++gone;
            EXPECT_FALSE(line.contains(p.z));
        }
        const bool kept = swarf.outside(tool, on_line) > 2.0 * error + 0.01;
        EXPECT_TRUE(!kept || line.contains(p.z));
    }
    EXPECT_GT(held, 1000);
    EXPECT_GT(gone, 300);
}

TEST(StockCase, AFullCircleHelixIsARoundBore) {
    constexpr double chord_error = 0.0025, radius = 5.0, turns = 6.0, pitch = 2.0;
    CutModel model = block({30, 30, 20}, 0.5);
    const auto tool = cutter(flat, chord_error);
    const double step = 2.0 * std::acos(1.0 - chord_error / radius);
    const auto at = [&](double angle) {
        return Vec3(15.0 + radius * std::cos(angle), 15.0 + radius * std::sin(angle),
                    -pitch * angle / 6.283185307179586);
    };
    double last = 0.0;
    for (double angle = 0.0; angle < turns * 6.283185307179586; angle = last) {
        last = std::min(angle + step, turns * 6.283185307179586);
        cut(model, {tool, at(angle), at(last)});
    }
    const ScanGrid& grid = model.lines.grid;
    int rounds = 0;
    for (int v = 0; v < grid.count(1); ++v)
        for (int u = 0; u < grid.count(2); ++u) {
            const double y = grid.coordinate(1, v) - 15.0, z = grid.coordinate(2, u);
            if (z < -pitch * (turns - 1.0) + 0.1 || std::abs(y) > 7.5) continue;
            const LineView line = model.lines.families[0].line(v, u); // u: y, v: z
            const double half = std::sqrt(64.0 - y * y);
            EXPECT_NEAR(line.front().upper, 15.0 - half, 0.02);
            EXPECT_NEAR(line.back().lower, 15.0 + half, 0.02);
            ++rounds;
        }
    EXPECT_GT(rounds, 300);
}

TEST(Removed, IsThatOfASlotOfAnyWidthAndDirection) {
    std::mt19937 rng(78);
    std::uniform_real_distribution<double> position(-0.5, 0.5);
    for (const double width : {6.3, 0.31, 1.0, 2.77}) {
        const RevolvedProfile tool{{{0, 0.5 * width, 40, 0.5 * width, 0}}};
        for (int along = 0; along < 2; ++along) {
            CutModel model = block({60, 60, 20}, 0.5);
            const double aside = 30.0 + position(rng), depth = 8.0 + position(rng);
            Vec3 from(aside, aside, -depth), to = from;
            from[along] = -10.0;
            to[along] = 70.0;
            const double truth = width * depth * 60.0;
            // Where the slot is narrower than a cell, no line may run down into it and give its
            // depth.
            const double fraction = width < 0.5 ? 0.5 * 0.5 / depth : 0.01;
            EXPECT_NEAR(cut(model, {cutter(tool), from, to}), truth, fraction * truth) << width;
        }
    }
}

TEST(Removed, IsUnbiasedForFacesOfAnyDirection) {
    // Material removed by tilted cylinders completely inside the block: closed form, many
    // directions.
    std::mt19937 rng(79);
    double sum = 0.0, squares = 0.0;
    constexpr int samples = 60;
    const RevolvedProfile tool{{{-4, 3, 4, 3, 0}}};
    const double truth = 3.14159265358979 * 9.0 * 8.0 + 6.0 * 8.0 * 5.0;
    for (int i = 0; i < samples; ++i) {
        CutModel model = block({30, 30, 30}, 0.5);
        const Mat3 turn = test_support::random_rotation(rng);
        const Vec3 from =
            Vec3(15, 15, -15) + 0.5 * test_support::random_point({Vec3(-1), Vec3(1)}, rng);
        const double volume = cut(model, {cutter(tool), from, from + 5.0 * turn[0], turn});
        const double off = volume / truth - 1.0;
        sum += off;
        squares += off * off;
    }
    EXPECT_NEAR(sum / samples, 0.0, 0.002);
    EXPECT_LT(std::sqrt(squares / samples), 0.01);
}

TEST(Removed, AddsUpOverManySmallMovesAndNeverShrinks) {
    const auto program = test_support::raster_program(2.0, 1.0);
    const auto sweeps = test_support::sweeps_of(program, test_support::raster_ball());
    CutModel model = make_cut_model({SolidBox{program.stock}, 0.0}, 1.0).value();
    double removed = 0.0;
    for (const CutterSweep& sweep : sweeps) {
        const double now = cut(model, sweep);
        ASSERT_GE(now, 0.0);
        removed += now;
    }
    std::array<double, 3> left{};
    for (size_t axis = 0; axis < 3; ++axis) {
        const ScanLines& family = model.lines.families[axis];
        for (int v = 0; v < family.v_count(); ++v)
            for (int u = 0; u < family.u_count(); ++u) left[axis] += family.line(u, v).length();
        EXPECT_NEAR(removed, 300000.0 - left[axis], 0.003 * removed) << axis;
    }
    for (const CutterSweep& sweep : sweeps) EXPECT_LT(cut(model, sweep), 1e-9);
}

TEST(CutOnThreads, GivesTheSameBitsForAnyNumber) {
    const auto program = test_support::raster_program(2.0, 1.0);
    auto sweeps = test_support::sweeps_of(program, test_support::raster_ball());
    sweeps.resize(1800);
    std::mt19937 rng(80);
    const auto world = test_support::random_tilted_cut_box(rng, 12, 0.05);
    for (size_t i = 0; i < world.cuts.size(); ++i) {
        CutterSweep other = world.sweep(i);
        other.from += Vec3(50, 50, 0);
        other.to += Vec3(50, 50, 0);
        sweeps.insert(sweeps.begin() + static_cast<long>(100 * i), other);
    }
    std::optional<uint64_t> hash;
    std::vector<double> volumes;
    for (const unsigned threads : {1U, 2U, 3U, 8U}) {
        CutModel model = make_cut_model({SolidBox{program.stock}, 0.0}, 1.0).value();
        const std::vector<double> now = cut(model, sweeps, threads);
        if (!hash) {
            hash = digest(model);
            volumes = now;
        }
        EXPECT_EQ(digest(model), *hash) << threads;
        EXPECT_EQ(now, volumes) << threads;
    }
    CutModel one_by_one = make_cut_model({SolidBox{program.stock}, 0.0}, 1.0).value();
    for (size_t i = 0; i < sweeps.size(); ++i)
        EXPECT_NEAR(cut(one_by_one, sweeps[i]), volumes[i], 1e-6);
}

TEST(LaneCut, GivesTheSameBitsOnEveryInstructionSet) {
    const auto program = test_support::raster_program(2.0, 1.0);
    auto sweeps = test_support::sweeps_of(program, test_support::raster_ball());
    sweeps.resize(400);
    const auto flat_ones = test_support::sweeps_of(program, flat);
    sweeps.insert(sweeps.end(), flat_ones.begin(), flat_ones.begin() + 400);
    std::optional<uint64_t> hash;
    const auto choose = [](int64_t targets) {
        hwy::SetSupportedTargetsForTest(targets);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    };
    int sets = 0;
    for (int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1) {
        const int64_t target = left & -left;
        choose(target);
        CutModel model = make_cut_model({SolidBox{program.stock}, 0.0}, 1.0).value();
        for (const CutterSweep& sweep : sweeps) cut(model, sweep);
        if (!hash) hash = digest(model);
        EXPECT_EQ(digest(model), *hash) << hwy::TargetName(target);
        ++sets;
        choose(0);
    }
    EXPECT_GT(sets, 1);
}

TEST(CutLog, GivesBackEveryMove) {
    std::mt19937 rng(81);
    const auto world = test_support::random_tilted_cut_box(rng, 200, 0.0);
    SweepLog log;
    std::vector<CutterSweep> all;
    for (size_t i = 0; i < world.cuts.size(); ++i) {
        CutterSweep sweep = world.sweep(i);
        if (i % 3 != 0) {
            sweep.cutter = all.back().cutter;
            sweep.from = all.back().to;
            sweep.orientation = all.back().orientation;
        }
        all.push_back(sweep);
        log.push_back(sweep);
    }
    ASSERT_EQ(log.size(), all.size());
    for (size_t i = 0; i < all.size(); ++i) {
        const LoggedSweep back = log[i];
        EXPECT_EQ(back.sweep.cutter, all[i].cutter);
        EXPECT_EQ(back.sweep.from, all[i].from);
        EXPECT_EQ(back.sweep.to, all[i].to);
        EXPECT_EQ(back.sweep.orientation, all[i].orientation);
        EXPECT_EQ(back.sweep.block, i);
        EXPECT_NEAR(glm::length(back.box.min - bounds(all[i]).min), 0.0, 1e-9);
        EXPECT_NEAR(glm::length(back.box.max - bounds(all[i]).max), 0.0, 1e-9);
    }
}

} // namespace
} // namespace core
