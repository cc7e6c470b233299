#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "core/dbm/cut_model.h"
#include "tests/support/convex_oracle.h"
#include "tests/support/stock_oracle.h"

namespace core {
namespace {

using test_support::CutBox;
using test_support::for_cells_at;
using test_support::random_cut_box;
using test_support::random_direction;
using test_support::random_point;
using test_support::random_tilted_cut_box;

constexpr double spacing = 0.7;

/// A random part of the square that contains the point.
Square part_round(const Square& s, const Vec3& p, std::mt19937& rng) {
    std::uniform_real_distribution<double> fraction(0.0, 1.0);
    return {p.x - fraction(rng) * (p.x - s.x0), p.x + fraction(rng) * (s.x1 - p.x),
            p.y - fraction(rng) * (p.y - s.y0), p.y + fraction(rng) * (s.y1 - p.y)};
}

void expect_held(const CutModel& model, const Vec3& p, std::mt19937& rng) {
    int cells = 0;
    for_cells_at(model, p, [&](int i, int j, const Square& s) {
        ++cells;
        EXPECT_TRUE(model.columns.line(i, j).contains(p.z)) << p.x << ' ' << p.y << ' ' << p.z;
        const Square part = part_round(s, p, rng);
        EXPECT_TRUE(fresh_column(model, i, j, part).contains(p.z))
            << p.x << ' ' << p.y << ' ' << p.z;
        const Aabb& box = model.column_boxes.boxes[model.column_boxes.index(i, j)];
        EXPECT_EQ(distance_squared(p, box), 0.0);
    });
    EXPECT_GE(cells, 1);
}

struct Seen {
    int stock = 0, close = 0, gone = 0;
};

/// All stock that remains for some path within the path error is inside the columns.
void expect_outer_model_holds(const CutBox& world, const CutModel& model, std::mt19937& rng,
                              Seen& seen) {
    const Vec3 off = world.path_error * random_direction(rng);
    for (int k = 0; k < 500; ++k) {
        const Vec3 p = random_point(world.box, rng);
        const double outside = world.outside_cuts(p, off);
        if (outside <= 0.0) {
            ++seen.gone;
            continue;
        }
        ++(outside < 0.1 ? seen.close : seen.stock);
        expect_held(model, p, rng);
    }
}

TEST(CutModelColumns, HoldEveryPointThatIsStillStock) {
    std::mt19937 rng(61);
    Seen seen;
    for (int i = 0; i < 60; ++i) {
        const CutBox world = random_cut_box(rng, 1 + i % 12, i % 3 ? 0.0 : 0.15);
        expect_outer_model_holds(world, world.model(spacing), rng, seen);
        ASSERT_FALSE(HasFailure()) << i;
    }
    EXPECT_GT(seen.stock, 4000);
    EXPECT_GT(seen.close, 500);
    EXPECT_GT(seen.gone, 4000);
}

TEST(CutModelLines, AreStockOverTheirWholeLength) {
    std::mt19937 rng(62);
    std::uniform_real_distribution<double> fraction(0.0, 1.0);
    size_t ends = 0;
    for (int i = 0; i < 30; ++i) {
        const CutBox world = random_cut_box(rng, 1 + i % 8, i % 3 ? 0.0 : 0.15);
        const CutModel model = world.model(spacing);
        const Vec3 off = world.path_error * random_direction(rng);
        for (int axis = 0; axis < 3; ++axis) {
            const ScanLines& family = model.lines.families[static_cast<size_t>(axis)];
            const TileBoxes& tiles = model.line_boxes[static_cast<size_t>(axis)];
            for (int v = 0; v < family.v_count(); ++v)
                for (int u = 0; u < family.u_count(); ++u)
                    for (const Interval& matter : family.line(u, v))
                        for (const double s : {0.0, 1.0, fraction(rng)}) {
                            const Vec3 p = point_on_line(model.lines.grid, axis, u, v,
                                                         matter.lower + s * matter.length());
                            ++ends;
                            ASSERT_LE(distance_squared(p, world.box), 1e-20);
                            ASSERT_GE(world.outside_cuts(p, off), -1e-7) << i << ' ' << axis;
                            const Aabb& box = tiles.boxes[tiles.index(u, v)];
                            ASSERT_LE(distance_squared(p, box), 1e-20);
                        }
        }
    }
    EXPECT_GT(ends, 20000u);
}

TEST(CutModelLines, AreAllThatIsStock) {
    // The lines are not shorter than the stock either, except for the path error, which is
    // subtracted twice.
    std::mt19937 rng(63);
    int held = 0;
    for (int i = 0; i < 30; ++i) {
        const CutBox world = random_cut_box(rng, 1 + i % 8, 0.0);
        const CutModel model = world.model(spacing);
        for (int k = 0; k < 400; ++k) {
            const int axis = k % 3;
            const ScanLines& family = model.lines.families[static_cast<size_t>(axis)];
            const int u = static_cast<int>(rng() % static_cast<unsigned>(family.u_count()));
            const int v = static_cast<int>(rng() % static_cast<unsigned>(family.v_count()));
            const Vec3 p =
                point_on_line(model.lines.grid, axis, u, v, random_point(world.box, rng)[axis]);
            if (world.outside_cuts(p) < 1e-7) continue;
            ++held;
            ASSERT_TRUE(family.line(u, v).contains(p[axis])) << i;
        }
    }
    EXPECT_GT(held, 3000);
}

TEST(FreshLine, IsStockOverItsWholeLengthAndMissesNone) {
    std::mt19937 rng(64);
    int in = 0, out = 0;
    for (int i = 0; i < 20; ++i) {
        const CutBox world = random_cut_box(rng, 1 + i % 8, 0.0);
        const CutModel model = world.model(spacing);
        for (int k = 0; k < 300; ++k) {
            const Vec3 p = random_point(world.box, rng);
            const double outside = world.outside_cuts(p);
            if (std::abs(outside) < 1e-7) continue;
            ++(outside > 0.0 ? in : out);
            for_cells_at(model, p, [&](int ci, int cj, const Square&) {
                EXPECT_EQ(fresh_line(model, ci, cj, p.x, p.y).contains(p.z), outside > 0.0);
            });
        }
    }
    EXPECT_GT(in, 1000);
    EXPECT_GT(out, 1000);
}

TEST(Cut, RemovesTheVolumeOfASlot) {
    const RevolvedProfile flutes{{{0, 5, 20, 5, 0}}};
    const CutBox world{{{0, 0, -20}, {100, 40, 0}}, 0.0, {{flutes, {-6, 20, -5}, {106, 20, -5}}}};
    CutModel model = world.uncut(0.5);
    EXPECT_NEAR(cut(model, world.sweep(0)), 5000.0, 1.0);
    EXPECT_EQ(cut(model, world.sweep(0)), 0.0);
}

TEST(Cut, RemovesWhatASampleSaysAndNothingTheSecondTime) {
    std::mt19937 rng(65);
    int cutting = 0;
    for (int i = 0; i < 24; ++i) {
        const CutBox world = random_cut_box(rng, 4, 0.0);
        CutModel model = world.uncut(0.5);
        double removed = 0.0;
        for (size_t k = 0; k < world.cuts.size(); ++k) {
            const double now = cut(model, world.sweep(k));
            ASSERT_GE(now, 0.0);
            removed += now;
        }
        for (size_t k = 0; k < world.cuts.size(); ++k) ASSERT_EQ(cut(model, world.sweep(k)), 0.0);
        int gone = 0;
        constexpr int samples = 1500;
        for (int k = 0; k < samples; ++k)
            gone += world.outside_cuts(random_point(world.box, rng)) < 0.0;
        const Vec3 size = world.box.size();
        const double whole = size.x * size.y * size.z;
        EXPECT_NEAR(removed, whole * gone / samples, 0.05 * whole) << i;
        cutting += removed > 10.0;
    }
    EXPECT_GT(cutting, 12);
}

TEST(CutModel, LosesWhatIsBetweenTwoElementsOfACutter) {
    const auto cutter = [](const RevolvedProfile& flutes, double path_error) {
        return std::make_shared<const Cutter>(make_cutter(flutes, path_error));
    };
    CutModel model = make_cut_model({SolidBox{{{0, 0, 1}, {20, 20, 9}}}, 0.0}, 0.5).value();
    // A sheet is left where the two elements of the second cutter, made slimmer, do not meet.
    const RevolvedProfile below{{{0, 3, 4.9997, 3, 0}}}, above{{{5.0003, 3, 20, 3, 0}}};
    for (const RevolvedProfile& flutes : {below, above})
        cut(model, {cutter(flutes, 0.0), {-5, 10, 0}, {25, 10, 0}});
    const ScanLines& columns = model.columns;
    ASSERT_EQ(columns.line(20, 20).size(), 1u);
    const RevolvedProfile stacked{{{0, 3, 5, 3, 0}, {5, 3, 12, 3, 0}}};
    cut(model, {cutter(stacked, 4e-4), {-5, 10, 0}, {25, 10, 0}});
    EXPECT_TRUE(columns.line(20, 20).empty());
    EXPECT_TRUE(model.lines.families[2].line(20, 20).empty());
}

TEST(CutModel, DoesNotDependOnTheOrderOfCuts) {
    std::mt19937 rng(66);
    for (int i = 0; i < 12; ++i) {
        CutBox world = random_cut_box(rng, 8, i % 2 ? 0.1 : 0.0);
        const CutModel one = world.model(spacing);
        std::shuffle(world.cuts.begin(), world.cuts.end(), rng);
        const CutModel other = world.model(spacing);
        EXPECT_TRUE(one.columns == other.columns);
        for (size_t axis = 0; axis < 3; ++axis)
            EXPECT_TRUE(one.lines.families[axis] == other.lines.families[axis]);
    }
}

/// What is kept is clipped to the column of the whole square. That may be sharper: between the
/// pieces of a slimmer cutter, a corner within the square can be covered less than those around it.
void expect_sharper(const IntervalList& kept, const IntervalList& fresh, bool again) {
    constexpr double rounding = 1e-7; // mm
    IntervalList rest = kept;
    for (const Interval& one : fresh) rest.subtract({one.lower - rounding, one.upper + rounding});
    EXPECT_TRUE(rest.empty()) << again;
}

/// A column has all material that the true cutter left at some points of its square.
void expect_held(const IntervalList& column, const CutBox& box, const Square& square,
                 std::mt19937& rng) {
    std::uniform_real_distribution<double> fraction(0.0, 1.0);
    for (int k = 0; k < 6; ++k) {
        const Vec3 p(square.x0 + fraction(rng) * (square.x1 - square.x0),
                     square.y0 + fraction(rng) * (square.y1 - square.y0),
                     box.box.min.z + fraction(rng) * box.box.size().z);
        if (box.outside_cuts(p) <= 0.0) continue;
        EXPECT_TRUE(std::any_of(column.begin(), column.end(), [&](const Interval& one) {
            return one.lower <= p.z && p.z <= one.upper;
        }));
    }
}

/// Divides a square and its quarters, and compares each with what the whole log leaves there.
void expect_same_quarters(const CutBox& box, const CutModel& model, int i, int j, SquareCuts cuts,
                          KeptSquare& kept, std::mt19937& rng, int depth) {
    const Square& s = cuts.square();
    EXPECT_EQ(cuts.line_at_centre(),
              fresh_line(model, i, j, 0.5 * (s.x0 + s.x1), 0.5 * (s.y0 + s.y1)));
    for (const bool again : {false, true}) // what is kept stays the same
        EXPECT_EQ(kept.line_at_centre(), cuts.line_at_centre()) << again;
    for (int quarter = 0; quarter < 4; ++quarter) {
        const Square part = cuts.quarter(quarter);
        EXPECT_EQ(cuts.column(quarter), fresh_column(model, i, j, part));
        for (const bool again : {false, true})
            expect_sharper(kept.column(quarter), cuts.column(quarter), again);
        expect_held(kept.column(quarter), box, part, rng);
        if (depth > 0)
            expect_same_quarters(box, model, i, j, cuts.within(quarter, {-infinity, infinity}),
                                 *kept.within(quarter), rng, depth - 1);
    }
}

void expect_same_quarters(const CutBox& box, const CutModel& model, KeptSquares& kept,
                          std::mt19937& rng) {
    std::uniform_int_distribution<int> start(0, 2);
    for (int j = start(rng); j < model.columns.v_count(); j += 3)
        for (int i = start(rng); i < model.columns.u_count(); i += 2) {
            const CellSweeps near = sweeps_near_cell(model, i, j);
            const SquareCuts cuts(model, near, cell_square(model, i, j), {-infinity, infinity});
            KeptSquare* const square = kept.of_cell(i, j);
            ASSERT_NE(square, nullptr);
            ASSERT_EQ(square, kept.of_cell(i, j));
            expect_same_quarters(box, model, i, j, cuts, *square, rng, 1);
        }
}

TEST(CutModel, QuartersOfASquareAreWhatTheWholeLogLeavesThere) {
    std::mt19937 rng(68);
    for (int k = 0; k < 12; ++k) {
        const double error = k % 2 ? 0.1 : 0.0;
        for (const CutBox& box :
             {random_cut_box(rng, 8, error), random_tilted_cut_box(rng, 8, error)}) {
            const CutModel model = box.model(spacing);
            KeptSquares kept(model);
            expect_same_quarters(box, model, kept, rng);
        }
    }
}

TEST(CutModel, KeptSquaresFollowLaterCuts) {
    std::mt19937 rng(70);
    for (int k = 0; k < 12; ++k) {
        const CutBox box =
            k % 2 ? random_cut_box(rng, 12, 0.1) : random_tilted_cut_box(rng, 12, 0.0);
        CutModel model = box.uncut(spacing);
        KeptSquares kept(model);
        for (size_t i = 0; i < box.cuts.size(); ++i) {
            {
                const TrialCut taken_back(model, box.sweep(box.cuts.size() - 1 - i));
                EXPECT_EQ(kept.of_cell(2, 2), nullptr) << "the cut may be taken back";
            }
            TrialCut trial(model, box.sweep(i));
            trial.keep();
            if (i % 3 != 2) continue;
            CutBox made = box;
            made.cuts.resize(i + 1);
            std::mt19937 same_cells(71);
            expect_same_quarters(made, model, kept, same_cells);
        }
    }
}

TEST(CutModel, KeptSquaresStayWithinTwiceTheirBudget) {
    std::mt19937 rng(72);
    const CutBox box = random_tilted_cut_box(rng, 40, 0.0);
    CutModel model = box.uncut(spacing);
    constexpr size_t most = 300;
    KeptSquares kept(model, most);
    size_t refused = 0, dropped = 0, before = 0, greatest = 0;
    for (size_t i = 0; i < box.cuts.size(); ++i) {
        TrialCut trial(model, box.sweep(i));
        trial.keep();
        for (int j = 0; j < model.columns.v_count(); ++j)
            for (int u = 0; u < model.columns.u_count(); ++u) {
                if (KeptSquare* const square = kept.of_cell(u, j))
                    EXPECT_EQ(square->line_at_centre(),
                              fresh_line(model, u, j,
                                         0.5 * (square->square().x0 + square->square().x1),
                                         0.5 * (square->square().y0 + square->square().y1)));
                else
                    ++refused;
                dropped += kept.used() < before;
                before = kept.used();
                greatest = std::max(greatest, before);
            }
    }
    EXPECT_GT(refused, 0U);
    EXPECT_GT(dropped, 0U);
    EXPECT_GT(greatest, most);
    EXPECT_LT(greatest, 2 * most + box.cuts.size()); // one square may grow by all cuts at once
}

/// A prism that misses a square says that no line through it meets the cutter.
TEST(CutModel, PrismsOfTiltedCuttersMissOnlyWhatTheyDoNotSweep) {
    std::mt19937 rng(69);
    int missed = 0, met = 0;
    for (int k = 0; k < 60; ++k) {
        const CutModel model = random_tilted_cut_box(rng, 1, k % 2 ? 0.1 : 0.0).model(spacing);
        if (model.log.size() == 0) continue; // the cut misses the box
        const LoggedSweep logged = model.log[0];
        const TiltedPrism box(logged.sweep);
        for (int i = 0; i < 300; ++i) {
            const Vec3 p = random_point(model.outer_box, rng);
            const Interval heights{p.z, p.z + 0.5};
            const bool comes = box.comes_to({p.x, p.x, p.y, p.y}, heights);
            ++(comes ? met : missed);
            if (comes) continue;
            for (const Cutter::Piece& piece : logged.sweep.cutter->pieces) {
                const auto swept = line_interval(piece.around, logged.sweep, 2, p.x, p.y);
                EXPECT_TRUE(!swept || swept->upper <= heights.lower
                            || swept->lower >= heights.upper);
            }
        }
    }
    EXPECT_GT(met, 1000);
    EXPECT_GT(missed, 1000);
}

void expect_same(const CutModel& one, const CutModel& other) {
    EXPECT_TRUE(one.columns == other.columns);
    EXPECT_EQ(one.log.size(), other.log.size());
    for (size_t axis = 0; axis < 3; ++axis)
        EXPECT_TRUE(one.lines.families[axis] == other.lines.families[axis]);
    for (int j = 0; j < one.columns.v_count(); ++j)
        for (int i = 0; i < one.columns.u_count(); ++i) {
            const Square s = cell_square(one, i, j);
            EXPECT_EQ(fresh_column(one, i, j, s), fresh_column(other, i, j, s));
        }
}

TEST(CutModel, CopyIsASnapshotThatLaterCutsDoNotChange) {
    std::mt19937 rng(67);
    CutBox world = random_cut_box(rng, 150, 0.0); // more than one chunk of the log
    for (CutBox::Cut& c : world.cuts) c.flutes = {{{0, 0.6, 12, 0.6, 0}}};
    CutModel model = world.uncut(spacing);
    std::vector<CutModel> copies;
    for (size_t k = 0; k < world.cuts.size(); ++k) {
        if (k % 30 == 0) copies.push_back(model);
        cut(model, world.sweep(k));
    }
    const std::vector<CutBox::Cut> all = world.cuts;
    for (size_t c = 0; c < copies.size(); ++c) {
        world.cuts.assign(all.begin(), all.begin() + static_cast<long>(30 * c));
        expect_same(world.model(spacing), copies[c]);
        CutModel branch = copies[c]; // another continuation from the snapshot
        world.cuts.push_back(all[149]);
        cut(branch, world.sweep(world.cuts.size() - 1));
        expect_same(world.model(spacing), branch);
    }
}

bool has_columns(const CutModel& model) {
    for (int j = 0; j < model.columns.v_count(); ++j)
        for (int i = 0; i < model.columns.u_count(); ++i)
            if (!model.columns.line(i, j).empty()) return true;
    return false;
}

TEST(CutModel, HasNoColumnsOnceAllOfItWasCut) {
    const RevolvedProfile wide{{{0, 40, 60, 40, 0}}};
    const CutBox world{{{0, 0, 0}, {10, 10, 10}}, 0.0, {{wide, {5, 5, -1}, {5, 5, -1}}}};
    EXPECT_TRUE(has_columns(world.uncut(1.0)));
    EXPECT_FALSE(has_columns(world.model(1.0)));
}

TEST(CutModelColumns, HoldTheToleranceThatNoLineMeets) {
    // The raw stock may extend 1 mm farther: where it was not cut there may be material.
    CutModel model = make_cut_model({SolidBox{{{0, 0, 0}, {10, 10, 10}}}, 1.0}, 0.5).value();
    const RevolvedProfile flat{{{0, 3, 30, 3, 0}}};
    const auto cutter = std::make_shared<Cutter>(make_cutter(flat, 0.0));
    cut(model, {cutter, {-5, 5, 2}, {20, 5, 2}});
    std::mt19937 rng(68);
    int in = 0;
    for (int k = 0; k < 3000; ++k) {
        const Vec3 p = random_point({Vec3(-1), Vec3(11)}, rng);
        if (distance_squared(p, {Vec3(0), Vec3(10)}) > 1.0) continue;
        if (test_support::outside_sweep(flat, {-5, 5, 2}, {20, 5, 2}, p) <= 0.0) continue;
        ++in;
        expect_held(model, p, rng);
    }
    EXPECT_GT(in, 1000);
    for_cells_at(model, {-0.9, 5.1, 0}, [&](int i, int j, const Square&) {
        EXPECT_FALSE(model.columns.line(i, j).contains(3.0)); // but not where it was cut
    });
}

bool holds_same(const SweepLog& a, const SweepLog& b) {
    if (a.size() != b.size()) return false;
    for (size_t i = 0; i < a.size(); ++i) {
        const LoggedSweep one = a[i], other = b[i];
        if (one.sweep.cutter != other.sweep.cutter || one.sweep.from != other.sweep.from
            || one.sweep.to != other.sweep.to || one.sweep.orientation != other.sweep.orientation
            || one.sweep.block != other.sweep.block || one.box.min != other.box.min
            || one.box.max != other.box.max)
            return false;
    }
    return true;
}

bool holds_same(const SharedLog<SweepRun>& a, const SharedLog<SweepRun>& b) {
    if (a.size() != b.size()) return false;
    for (size_t i = 0; i < a.size(); ++i)
        if (a[i].first != b[i].first || a[i].last != b[i].last) return false;
    return true;
}

void expect_same_state(const CutModel& a, const CutModel& b) {
    EXPECT_TRUE(a.columns == b.columns);
    EXPECT_TRUE(holds_same(a.log, b.log));
    EXPECT_EQ(a.volume_owed, b.volume_owed);
    for (size_t tile = 0; tile < a.history.size(); ++tile)
        EXPECT_TRUE(holds_same(a.history[tile], b.history[tile])) << tile;
    for (size_t axis = 0; axis < 3; ++axis) {
        EXPECT_TRUE(a.lines.families[axis] == b.lines.families[axis]);
        EXPECT_EQ(a.line_boxes[axis].stale, b.line_boxes[axis].stale);
        EXPECT_EQ(a.line_boxes[axis].stale_tiles, b.line_boxes[axis].stale_tiles);
    }
    EXPECT_EQ(a.column_boxes.stale, b.column_boxes.stale);
}

/// The cuts of a world, each in two moves of which the second continues the first.
std::vector<CutterSweep> moves_of(const CutBox& world) {
    std::vector<CutterSweep> moves;
    for (size_t i = 0; i < world.cuts.size(); ++i) {
        const CutterSweep whole = world.sweep(i);
        const Vec3 middle = 0.4 * whole.from + 0.6 * whole.to;
        moves.push_back(whole);
        moves.back().to = middle;
        moves.push_back(whole);
        moves.back().from = middle;
    }
    return moves;
}

TEST(TrialCut, LeavesNoTraceUnlessItIsKept) {
    std::mt19937 rng(25);
    int near = 0, kept = 0;
    double removed = 0.0;
    for (int round = 0; round < 40; ++round) {
        const CutBox world = random_cut_box(rng, 20, round % 3 ? 0.0 : 0.15);
        const std::vector<CutterSweep> moves = moves_of(world);
        CutModel tried = world.uncut(spacing), plain = tried;
        CutModel snapshot = tried, plain_snapshot = tried;
        for (const CutterSweep& move : moves) {
            if (rng() % 8 == 0) snapshot = tried, plain_snapshot = plain;
            for (unsigned others = rng() % 3; others > 0; --others) {
                const TrialCut trial(tried, rng() % 2 ? move : moves[rng() % moves.size()]);
                near += trial.is_near();
            }
            expect_same_state(tried, plain);
            const double volume = cut(plain, move);
            if (rng() % 2 == 0) {
                EXPECT_EQ(TrialCut(tried, move).keep(), volume);
                ++kept;
            } else {
                EXPECT_EQ(cut(tried, move), volume);
            }
            removed += volume;
            expect_same_state(tried, plain);
            ASSERT_FALSE(HasFailure()) << round;
        }
        expect_same_state(snapshot, plain_snapshot);
    }
    EXPECT_GT(near, 800);
    EXPECT_GT(kept, 500);
    EXPECT_GT(removed, 0.0);
}

} // namespace
} // namespace core
