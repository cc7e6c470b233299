#include <random>

#include <gtest/gtest.h>

#include "core/dbm/stock_pieces.h"
#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"

namespace core {
namespace {

const Aabb block{{0, 0, -20}, {60, 40, 0}};

CutModel block_model(double h) { return *make_cut_model({SolidBox{block}, 0.0}, h); }

void mill(CutModel& model, double radius, const Vec3& from, const Vec3& to, double height = 30.0) {
    cut(model,
        {std::make_shared<Cutter>(make_cutter({{{0, radius, height, radius, 0}}}, 0.0)), from, to});
}

/// A slow method: grid nodes as a graph, connected where a line has material from one to the next.
/// Returns the number of nodes in each piece, the largest first, without pieces below `least`
/// nodes.
std::vector<size_t> pieces_by_nodes(const CutModel& model, size_t least) {
    const ScanGrid& grid = model.lines.grid;
    const int n[3] = {grid.count(0), grid.count(1), grid.count(2)};
    const auto id = [&](int i, int j, int k) {
        return static_cast<size_t>((k * n[1] + j) * n[0] + i);
    };
    const auto has = [&](int axis, int u, int v, double low, double high) {
        for (const Interval& m : model.lines.families[static_cast<size_t>(axis)].line(u, v))
            if (m.lower <= low && m.upper >= high) return true;
        return false;
    };
    const auto inside = [&](int i, int j, int k) {
        const double z = grid.coordinate(2, k);
        return has(2, i, j, z, z);
    };
    std::vector<char> seen(id(0, 0, n[2]), 0);
    std::vector<size_t> sizes;
    for (int k0 = 0; k0 < n[2]; ++k0)
        for (int j0 = 0; j0 < n[1]; ++j0)
            for (int i0 = 0; i0 < n[0]; ++i0) {
                if (seen[id(i0, j0, k0)] || !inside(i0, j0, k0)) continue;
                std::vector<std::array<int, 3>> open = {{i0, j0, k0}};
                seen[id(i0, j0, k0)] = 1;
                size_t size = 0;
                while (!open.empty()) {
                    const auto at = open.back();
                    open.pop_back();
                    ++size;
                    for (int axis = 0; axis < 3; ++axis)
                        for (const int step : {-1, 1}) {
                            auto to = at;
                            const auto a = static_cast<size_t>(axis);
                            to[a] += step;
                            if (to[a] < 0 || to[a] >= n[axis]) continue;
                            if (seen[id(to[0], to[1], to[2])] || !inside(to[0], to[1], to[2]))
                                continue;
                            const double p = grid.coordinate(axis, at[a]);
                            const double q = grid.coordinate(axis, to[a]);
                            if (!has(axis, at[static_cast<size_t>(u_axis(axis))],
                                     at[static_cast<size_t>(v_axis(axis))], std::min(p, q),
                                     std::max(p, q)))
                                continue;
                            seen[id(to[0], to[1], to[2])] = 1;
                            open.push_back(to);
                        }
                }
                if (size >= least) sizes.push_back(size);
            }
    std::sort(sizes.rbegin(), sizes.rend());
    return sizes;
}

TEST(StockPieces, CountWhatASawPartsEvenIfItIsThinnerThanTheMeshSize) {
    for (const double x : {20.0, 20.3, 20.6, 20.97}) {
        CutModel model = block_model(1.0);
        PieceMap map;
        EXPECT_EQ(map.pieces(model).size(), 1u);
        mill(model, 0.1, {x, -5, -21}, {x, 45, -21});
        map.note_cut(model, {{x - 0.1, -6, -21}, {x + 0.1, 46, 9}});
        const auto pieces = map.pieces(model);
        ASSERT_EQ(pieces.size(), 2u) << x;
        EXPECT_NEAR(pieces[0].volume, (60.0 - x) * 800.0, 800.0);
        EXPECT_NEAR(pieces[1].volume, x * 800.0, 800.0);
    }
}

TEST(StockPieces, HangTogetherByATab) {
    CutModel model = block_model(1.0);
    PieceMap map;
    mill(model, 1.0, {20, -5, -21}, {20, 17, -21});
    mill(model, 1.0, {20, 23, -21}, {20, 45, -21});
    EXPECT_EQ(map.pieces(model).size(), 1u);
    mill(model, 1.0, {20, 15, -21}, {20, 25, -21});
    map.note_cut(model, {{19, 14, -21}, {21, 26, 9}});
    EXPECT_EQ(map.pieces(model).size(), 2u);
}

TEST(StockPieces, AreTheSameWhetherFollowedOrLookedAtAfresh) {
    std::mt19937_64 random(8);
    const auto between = [&](double low, double high) {
        return low + (high - low) * (static_cast<double>(random() >> 11U) * 0x1p-53);
    };
    size_t parted = 0, doubts = 0, together = 0;
    for (int round = 0; round < 8; ++round) {
        CutModel model = block_model(1.0);
        PieceMap followed;
        followed.pieces(model);
        size_t before = 1;
        for (int k = 0; k < 25; ++k) {
            const double z = k % 3 == 0 ? between(-19, -1) : -21.0;
            const Vec3 from(between(-5, 65), between(-5, 45), z),
                to(between(-5, 65), between(-5, 45), z);
            mill(model, between(0.3, 2.0), from, to, k % 2 ? 30.0 : between(2.0, 6.0));
            const Aabb box = model.log.size() ? model.log[model.log.size() - 1].box : Aabb{};
            followed.note_cut(model, box);
            PieceMap nearby = followed;
            const bool doubtful = nearby.may_have_separated(model);
            PieceMap afresh;
            const auto pieces = followed.pieces(model), expected = afresh.pieces(model);
            ASSERT_EQ(pieces.size(), expected.size()) << round << ' ' << k;
            double volume = 0.0;
            for (size_t i = 0; i < pieces.size(); ++i) {
                EXPECT_NEAR(pieces[i].volume, expected[i].volume, 1e-6);
                volume += pieces[i].volume;
                double length = 0.0;
                for (const auto& [a, b] : followed.stretches(model, i)) length += b.z - a.z;
                EXPECT_NEAR(length, pieces[i].volume, 1e-6);
            }
            if (is_still_connected(model, box)) {
                EXPECT_LE(pieces.size(), before);
            }
            if (!doubtful) {
                EXPECT_LE(pieces.size(), before);
            }
            if (before == 1 && hangs_together_within(model, box)) {
                EXPECT_EQ(pieces.size(), 1u);
                ++together;
            }
            doubts += doubtful;
            EXPECT_EQ(nearby.pieces(model).size(), pieces.size()) << "followed by the shorter way";
            before = pieces.size();
            // Compares nodes only: pieces without any are ignored by both.
            if (k % 6 == 5) {
                const auto by_nodes = pieces_by_nodes(model, 30);
                const auto large = std::count_if(pieces.begin(), pieces.end(),
                                                 [](const auto& p) { return p.volume > 60.0; });
                EXPECT_LE(static_cast<size_t>(large), by_nodes.size());
                EXPECT_NEAR(static_cast<double>(by_nodes[0]), pieces[0].volume,
                            0.1 * pieces[0].volume + 50.0);
            }
        }
        parted += before > 1;
    }
    EXPECT_GT(parted, 4u);
    EXPECT_LT(doubts, 150u); // of 200
    EXPECT_GT(together, 10u);
}

TEST(StockPieces, AreNotInDoubtWhereARoofHangsOnTheSides) {
    // A slot below the surface, as a T-slot cutter leaves it: a roof above every move.
    CutModel model = block_model(0.5);
    PieceMap map;
    map.pieces(model);
    for (int i = 0; i < 40; ++i) {
        const Vec3 from(10.0 + i, 20.0, -12.0), to(11.0 + i, 20.0, -12.0);
        const size_t first = model.log.size();
        mill(model, 5.0, from, to, 4.0);
        const Aabb box = box_of_cuts(model, first);
        EXPECT_FALSE(is_still_connected(model, box));
        map.note_cut(model, box);
        EXPECT_FALSE(map.may_have_separated(model)) << i;
        EXPECT_TRUE(hangs_together_within(model, box)) << i;
    }
    // Two cuts from above part the roof over a piece of the slot from the rest.
    for (const double x : {15.0, 45.0}) {
        mill(model, 1.0, {x, 5.0, -10.0}, {x, 35.0, -10.0});
        map.note_cut(model, {{x - 1, 4, -10}, {x + 1, 36, 20}});
        EXPECT_FALSE(map.may_have_separated(model));
    }
    for (const double y : {15.5, 24.5}) {
        mill(model, 1.0, {15.0, y, -10.0}, {45.0, y, -10.0});
        map.note_cut(model, {{14, y - 1, -10}, {46, y + 1, 20}});
        EXPECT_EQ(map.may_have_separated(model), y > 20.0);
        if (y > 20.0) {
            EXPECT_FALSE(hangs_together_within(model, {{14, y - 1, -10}, {46, y + 1, 20}}));
        }
    }
    EXPECT_EQ(map.pieces(model).size(), 2u);
}

TEST(StockPieces, NeedNoLookWhereSolidMatterIsBelow) {
    CutModel model = block_model(0.5);
    mill(model, 3.0, {10, 20, -5}, {50, 20, -5});
    EXPECT_TRUE(is_still_connected(model, {{7, 17, -5}, {53, 23, 25}}));
    mill(model, 3.0, {10, 20, -21}, {50, 20, -21});
    EXPECT_FALSE(is_still_connected(model, {{7, 17, -21}, {53, 23, 9}}));
}

TEST(StockPieces, NeedALookWhereAnOverhangIsCut) {
    CutModel model = block_model(1.0);
    mill(model, 8.0, {60, -10, -15}, {60, 50, -15}, 5.0); // a plate of 10 mm overhangs X 52 to 60
    mill(model, 0.6, {54, -5, -10.5}, {54, 45, -10.5});
    EXPECT_FALSE(is_still_connected(model, {{53.4, -5.6, -10.5}, {54.6, 45.6, 19.5}}));
    EXPECT_EQ(PieceMap().pieces(model).size(), 2u);
}

TEST(StockPieces, NeedALookWhereAThinSlotIsBelow) {
    // Sawn from below between two lines, leaving a bridge of 3 mm; then the bridge is cut.
    CutModel model = block_model(1.0);
    mill(model, 0.1, {20.0, -5, -21}, {20.0, 45, -21}, 18.0);
    EXPECT_EQ(PieceMap().pieces(model).size(), 1u);
    mill(model, 2.0, {20.0, -5, -4}, {20.0, 45, -4});
    EXPECT_FALSE(is_still_connected(model, {{18, -7, -4}, {22, 47, 26}}));
    EXPECT_EQ(PieceMap().pieces(model).size(), 2u);
}

/// The simulator with a 4 mm mill that saws through the block at X 20.
struct Saw {
    Setup setup;

    Saw() {
        setup.stock = {SolidBox{block}, 0.0};
        ToolDescription tool;
        tool.number = ToolNumber{1};
        tool.diameter = 4;
        tool.flute_length = 25;
        setup.tools.emplace(tool.number, *assemble(tool));
    }

    std::vector<Finding> run(const std::vector<Vec3>& tips) const {
        const double length = setup.tools.at(ToolNumber{1}).length;
        SimulatorState state = *start_of_run(setup, {});
        std::vector<Finding> found;
        const auto give = [&](const Event& event, uint32_t number) {
            const Event events[] = {event};
            for (Finding& finding :
                 run_block(setup, {BlockIndex{number}, false, events}, state).findings)
                if (finding.rule == "loose-piece") found.push_back(finding);
        };
        give(ToolChange{ToolNumber{1}}, 0);
        give(SpindleChange{SpindleDirection::clockwise, 5000.0}, 1);
        for (size_t i = 1; i < tips.size(); ++i) {
            Motion motion{.kind = MotionKind::feed, .feed = 600.0};
            for (int k = 0; k < 3; ++k) {
                const double up = k == 2 ? length : 0.0;
                motion.from[static_cast<size_t>(k)] = tips[i - 1][k] + up;
                motion.to[static_cast<size_t>(k)] = tips[i][k] + up;
            }
            give(motion, static_cast<uint32_t>(i + 1));
        }
        return found;
    }
};

const std::vector<Vec3> sawing = {{20, -10, -10}, {20, 50, -10},  {20, 50, -21},
                                  {20, -10, -21}, {20, -10, -21}, {20, 10, -21}};

TEST(LoosePieces, AreNamedByTheBlockThatCutsThemLoose) {
    const auto found = Saw().run(sawing);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].block, BlockIndex{4});
    EXPECT_EQ(found[0].severity, Severity::warning);
    EXPECT_NE(found[0].message.find("18.0 x 40.0 x 20.0 mm, 14400 mm3"), std::string::npos)
        << found[0].message;
    EXPECT_NE(found[0].message.find("describes no fixture"), std::string::npos);
}

TEST(LoosePieces, AreHeldByTheFixturesThatTouchThem) {
    Saw saw;
    const auto clamp = [](const Vec3& min, const Vec3& max) {
        Mesh mesh;
        for (unsigned i = 0; i < 8; ++i)
            mesh.vertices.emplace_back(i & 1U ? max.x : min.x, i & 2U ? max.y : min.y,
                                       i & 4U ? max.z : min.z);
        mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                          {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
        return solid_mesh(std::move(mesh));
    };
    saw.setup.fixtures.push_back({"far", clamp({58, 10, 0}, {70, 30, 10})});
    auto found = saw.run(sawing);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NE(found[0].message.find("No fixture touches it"), std::string::npos);
    // Inside the box of the piece, but above its step.
    saw.setup.fixtures.push_back({"above", clamp({1, 15, -4}, {6, 25, 0})});
    std::vector<Vec3> stepped = {
        {2, -10, -10}, {2, 50, -10}, {6, 50, -10}, {6, -10, -10}, {10, -10, -10}};
    stepped.insert(stepped.end(), sawing.begin(), sawing.end());
    found = saw.run(stepped);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NE(found[0].message.find("No fixture touches it"), std::string::npos);
    saw.setup.fixtures.push_back({"near", clamp({-10, 10, -20}, {0, 30, -10})});
    saw.setup.fixtures.back().is_there = false;
    found = saw.run(stepped);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NE(found[0].message.find("No fixture touches it"), std::string::npos);
    saw.setup.fixtures.back().is_there = true;
    found = saw.run(stepped);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NE(found[0].message.find("Still touched by near"), std::string::npos);
}

TEST(LoosePieces, AreReportedOnceEach) {
    // Sawn at X 20, along the same path again, then at X 40.
    std::vector<Vec3> tips = sawing;
    tips.insert(tips.end(), {{20, -10, 20}, {40, -10, -21}, {40, 50, -21}});
    EXPECT_EQ(Saw().run(tips).size(), 2u);
}

TEST(LoosePieces, AreNotSoughtWhereTheRuleIsOff) {
    Saw saw;
    saw.setup.rules["loose-piece"] = Severity::off;
    EXPECT_TRUE(saw.run(sawing).empty());
}

} // namespace
} // namespace core
