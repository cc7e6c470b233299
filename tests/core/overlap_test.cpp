#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/distance/inner_depth.h"
#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"

namespace core {
namespace {

constexpr double tool_length = 95.0;

/// A block of 100 x 100 x 30 with its top at Z 0, in the machine frame, and a 10 mm end mill, 95 mm
/// long: flutes 0-20, shank 20-45, 40 mm holder 45-95 above the tip.
Setup plain_setup() {
    Setup setup;
    setup.stock = {SolidBox{{{0, 0, -30}, {100, 100, 0}}}, 0.0};
    ToolDescription tool;
    tool.number = ToolNumber{1};
    tool.diameter = 10;
    tool.flute_length = 20;
    tool.shank = {{10, 10, 25}};
    tool.holder = {{40, 40, 50}};
    setup.tools.emplace(tool.number, *assemble(tool));
    return setup;
}

/// Runs motions of one tool; positions are those of the tip.
struct ToolRun {
    Setup setup;
    SimulatorState state;
    uint32_t block = 0;

    explicit ToolRun(Setup with) : setup(std::move(with)), state(*start_of_run(setup, {})) {
        give({ToolChange{ToolNumber{1}}});
        give({SpindleChange{SpindleDirection::clockwise, 6000.0}});
    }

    BlockResult give(const std::vector<Event>& events) {
        return run_block(setup, {BlockIndex{block++}, false, events}, state);
    }
    BlockResult move(MotionKind kind, const Vec3& from, const Vec3& to) {
        return give({Motion{.kind = kind,
                            .from = {from.x, from.y, from.z + tool_length},
                            .to = {to.x, to.y, to.z + tool_length},
                            .feed = kind == MotionKind::rapid ? 0.0 : 600.0}});
    }
};

/// The finding about the clearance of a pair; null if there is none.
const Finding* finding_about(const BlockResult& result, const std::string& part,
                             const std::string& body) {
    for (const Finding& finding : result.findings)
        if (finding.pair == std::array{part, body} && finding.rule != "low-retract")
            return &finding;
    return nullptr;
}

/// An upright cylinder, by its lower and upper end above the tip.
struct Cylinder {
    double radius, low, high;
};

/// Length of the shortest translation of a cylinder, its tip at `tip`, out of a box: the smallest
/// over many directions, each moved until a plane separates the two. An upper bound that exceeds
/// the true length by little.
double true_depth(const Cylinder& body, const Vec3& tip, const Aabb& box) {
    constexpr int around = 72, upwards = 36;
    double least = infinity;
    for (int i = 0; i < around; ++i)
        for (int j = 0; j <= upwards; ++j) {
            const double turn = 2.0 * std::numbers::pi * i / around;
            const double rise = std::numbers::pi * (static_cast<double>(j) / upwards - 0.5);
            const Vec3 u(std::cos(rise) * std::cos(turn), std::cos(rise) * std::sin(turn),
                         std::sin(rise));
            const Vec3 corner(u.x > 0 ? box.max.x : box.min.x, u.y > 0 ? box.max.y : box.min.y,
                              u.z > 0 ? box.max.z : box.min.z);
            const double backmost = glm::dot(tip, u) - body.radius * std::hypot(u.x, u.y)
                                    + std::min(body.low * u.z, body.high * u.z);
            least = std::min(least, glm::dot(corner, u) - backmost);
        }
    return std::max(least, 0.0);
}

/// The greatest depth on a straight motion, from many moments.
double true_depth(const Cylinder& body, const Vec3& from, const Vec3& to, const Aabb& box) {
    double depth = 0.0;
    for (int i = 0; i <= 200; ++i)
        depth = std::max(depth, true_depth(body, from + (i / 200.0) * (to - from), box));
    return depth;
}

const Cylinder flutes{5.0, 0.0, 20.0}, holder{20.0, 45.0, 95.0};

Setup with_box(const Aabb& box) {
    Setup setup = plain_setup();
    setup.fixtures.push_back({"clamp", convex(box)});
    return setup;
}

TEST(Overlap, OfAPlungeIsAsDeepAsThePlunge) {
    ToolRun run(with_box({{120, 0, -30}, {180, 100, 20}}));
    const BlockResult result = run.move(MotionKind::rapid, {150, 50, 60}, {150, 50, 13});
    const Finding* finding = finding_about(result, "flutes", "clamp");
    ASSERT_TRUE(finding && finding->overlap && finding->overlap->most);
    EXPECT_NEAR(finding->overlap->least, 7.0, 0.01);
    EXPECT_NEAR(*finding->overlap->most, 7.0, 0.01);
    EXPECT_NEAR(finding->overlap->way_out.z, 1.0, 1e-6);
    EXPECT_NE(finding->message.find("deep; the shortest way out is towards Z+."), std::string::npos)
        << finding->message;
}

TEST(Overlap, OfARapidIntoTheStockIsMeasuredInTheUncutStock) {
    ToolRun run(plain_setup());
    const BlockResult result = run.move(MotionKind::rapid, {50, 50, 20}, {50, 50, -8});
    const Finding* finding = finding_about(result, "flutes", "stock");
    ASSERT_TRUE(finding && finding->overlap && finding->overlap->most);
    EXPECT_NEAR(finding->overlap->least, 8.0, 0.1);
    EXPECT_LE(finding->overlap->least, 8.0);
    EXPECT_NEAR(*finding->overlap->most, 8.0, 0.01);
}

TEST(Overlap, OfFlutesInTheirOwnSlotEndsWhereOnlyContactIsLeft) {
    ToolRun run(plain_setup());
    run.move(MotionKind::feed, {-20, 50, -5}, {60, 50, -5});
    run.move(MotionKind::rapid, {60, 50, -5}, {60, 50, 20});
    // Back into the slot, and 2 mm too deep.
    const BlockResult result = run.move(MotionKind::rapid, {60, 50, 20}, {60, 50, -7});
    const Finding* finding = finding_about(result, "flutes", "stock");
    ASSERT_TRUE(finding && finding->overlap && finding->overlap->most);
    EXPECT_NEAR(*finding->overlap->most, 2.0, 0.1);
    EXPECT_LE(finding->overlap->least, 2.0);
    EXPECT_GE(finding->overlap->least, 1.5);
}

TEST(Overlap, OfTheHolderIsMeasuredWhereTheFlutesHaveNotCut) {
    ToolRun run(plain_setup());
    // The flutes are 60 deep at the end: the holder, 45 above the tip, is 15 deep in the wall.
    const BlockResult result = run.move(MotionKind::feed, {50, 50, 5}, {50, 50, -60});
    const Finding* finding = finding_about(result, "holder", "stock");
    ASSERT_TRUE(finding && finding->overlap && finding->overlap->most);
    EXPECT_NEAR(*finding->overlap->most, 15.0, 0.1);
    EXPECT_LE(finding->overlap->least, 15.0);
    EXPECT_GE(finding->overlap->least, 13.0);
}

/// Random straight motions past and into a box, fixture or stock.
struct RandomPassage {
    std::mt19937 random;
    double number(double low, double high) {
        return std::uniform_real_distribution<>(low, high)(random);
    }
    Vec3 point(const Vec3& low, const Vec3& high) {
        return {number(low.x, high.x), number(low.y, high.y), number(low.z, high.z)};
    }
};

TEST(Overlap, EnclosesTheTrueDepthInAFixture) {
    RandomPassage random{std::mt19937(7)};
    int deep = 0, sharp = 0;
    for (int i = 0; i < 60; ++i) {
        const Vec3 corner = random.point({120, 0, -20}, {140, 20, 0});
        const Aabb box{corner, corner + random.point({5, 5, 5}, {60, 60, 40})};
        const Vec3 from = random.point(box.min - Vec3(15), box.max + Vec3(15));
        const Vec3 to = i % 3 == 0 ? from + Vec3(0, 0, -random.number(1, 20))
                                   : random.point(box.min - Vec3(15), box.max + Vec3(15));
        ToolRun run(with_box(box));
        const BlockResult result = run.move(MotionKind::rapid, from, to);
        for (const auto& [name, body] :
             {std::pair{"flutes", flutes}, std::pair{"holder", holder}}) {
            const Finding* finding = finding_about(result, name, "clamp");
            if (!finding || !finding->overlap) continue;
            const double depth = true_depth(body, from, to, box);
            const double between = glm::length(to - from) / 400.0; // of the moments of the oracle
            EXPECT_LE(finding->overlap->least, depth + between + 1e-6) << i << " " << name;
            ASSERT_TRUE(finding->overlap->most) << i << " " << name;
            EXPECT_GE(*finding->overlap->most, 0.98 * depth - 0.02) << i << " " << name;
            EXPECT_LE(finding->overlap->least, *finding->overlap->most);
            EXPECT_NEAR(glm::length(finding->overlap->way_out), 1.0, 1e-9);
            ++deep;
            sharp += *finding->overlap->most - finding->overlap->least < 0.1 * depth + 0.05;
        }
    }
    EXPECT_GT(deep, 40);
    EXPECT_GT(sharp, deep * 8 / 10);
}

TEST(Overlap, EnclosesTheTrueDepthInTheStock) {
    RandomPassage random{std::mt19937(11)};
    const Aabb box{{0, 0, -30}, {100, 100, 0}};
    int deep = 0, sharp = 0;
    for (int i = 0; i < 24; ++i) {
        const Vec3 from = random.point({-10, -10, 1}, {110, 110, 10});
        const Vec3 to = random.point({-10, -10, -12}, {110, 110, 4});
        ToolRun run(plain_setup());
        const BlockResult result = run.move(MotionKind::rapid, from, to);
        const Finding* finding = finding_about(result, "flutes", "stock");
        if (!finding || !finding->overlap) continue;
        const double depth = true_depth(flutes, from, to, box);
        EXPECT_LE(finding->overlap->least, depth + glm::length(to - from) / 400.0 + 1e-6) << i;
        ASSERT_TRUE(finding->overlap->most) << i;
        EXPECT_GE(*finding->overlap->most, 0.98 * depth - 0.06) << i; // contact of 0.05 mm
        ++deep;
        sharp += *finding->overlap->most - finding->overlap->least < 0.15 * depth + 0.4;
    }
    EXPECT_GT(deep, 10);
    EXPECT_GT(sharp, deep * 7 / 10);
}

// Cures that were tried.

/// The shift that a cure names; zero if it names none.
Vec3 shift_in(const std::string& cure) {
    double amount = 0.0;
    char axis = 0, sign = 0;
    if (std::sscanf(cure.c_str(), "Move the tool path at least %lf mm towards %c%c", &amount, &axis,
                    &sign)
        != 3)
        return Vec3(0.0);
    Vec3 shift(0.0);
    shift[axis - 'X'] = sign == '+' ? amount : -amount;
    return shift;
}

/// The clearance that a cure says is kept; -1 if it says none.
double kept_in(const std::string& cure) {
    const size_t at = cure.find("keeps ");
    return at == std::string::npos ? -1.0 : std::stod(cure.substr(at + 6));
}

TEST(CureTrial, GivesShiftsThatClearTheBlock) {
    RandomPassage random{std::mt19937(3)};
    int cured = 0, bad = 0;
    for (int i = 0; i < 60; ++i) {
        const Vec3 corner = random.point({110, 0, -20}, {120, 20, 0});
        const Aabb box{corner, corner + random.point({5, 5, 5}, {30, 60, 40})};
        const Vec3 from = random.point(box.min - Vec3(9), box.max + Vec3(9));
        const Vec3 to = from + random.point(Vec3(-10), Vec3(10));
        ToolRun run(with_box(box));
        const BlockResult result = run.move(MotionKind::rapid, from, to);
        if (result.verdict == Verdict::clear) continue;
        for (const Finding& finding : result.findings) {
            if (finding.pair[1] != "clamp") continue;
            ++bad;
            const Vec3 shift = shift_in(finding.cure);
            EXPECT_EQ(finding.cure.find(" mm ") != std::string::npos, shift != Vec3(0.0))
                << finding.cure;
            if (shift == Vec3(0.0)) continue;
            ++cured;
            ToolRun again(with_box(box));
            const BlockResult other = again.move(MotionKind::rapid, from + shift, to + shift);
            EXPECT_EQ(other.verdict, Verdict::clear) << i << " " << finding.cure;
            for (const PairClearance& pair : other.pairs)
                if (part_name(again.setup, pair.pair) == finding.pair[0] && pair.pair.fixture) {
                    EXPECT_GE(pair.lower, kept_in(finding.cure) - 1e-9) << i;
                    EXPECT_GE(pair.lower, 2.0 - resolution) << i;
                }
        }
    }
    EXPECT_GT(bad, 20);
    EXPECT_GT(cured, bad * 8 / 10);
}

TEST(CureTrial, UsesTheStockBeforeTheBlock) {
    // The flutes of the trial must meet the material that the real block has removed: a rapid at Z
    // -3 through uncut stock is cured by 3.5 mm more height, not by less.
    ToolRun run(plain_setup());
    run.move(MotionKind::feed, {-20, 20, -5}, {120, 20, -5});
    const BlockResult result = run.move(MotionKind::rapid, {-20, 50, -3}, {120, 50, -3});
    const Finding* finding = finding_about(result, "flutes", "stock");
    ASSERT_TRUE(finding);
    double higher = 0.0;
    ASSERT_EQ(std::sscanf(finding->cure.c_str(), "Rapid at least %lf mm higher", &higher), 1)
        << finding->cure;
    EXPECT_NEAR(higher, 3.5, 0.02);
    EXPECT_NEAR(kept_in(finding->cure), 0.5, 0.02);
}

TEST(CureTrial, SaysNoAmountForARapidThatBeginsInTheStock) {
    ToolRun run(plain_setup());
    run.move(MotionKind::feed, {50, 50, 5}, {50, 50, -60}); // the holder ends in the stock
    const BlockResult result = run.move(MotionKind::rapid, {50, 50, -60}, {50, 50, 20});
    const Finding* finding = finding_about(result, "holder", "stock");
    ASSERT_TRUE(finding);
    EXPECT_NE(finding->cure.find("already where this rapid begins"), std::string::npos)
        << finding->cure;
    EXPECT_EQ(finding->cure.find(" mm"), std::string::npos);
}

TEST(CureTrial, FindsTheSameAgainFromACopyOfTheState) {
    ToolRun run(plain_setup());
    run.move(MotionKind::feed, {-20, 20, -5}, {120, 20, -5});
    ToolRun copy = run;
    const auto first = run.move(MotionKind::feed, {50, 50, 5}, {50, 50, -60});
    const auto again = copy.move(MotionKind::feed, {50, 50, 5}, {50, 50, -60});
    EXPECT_EQ(first.findings, again.findings);
    ASSERT_FALSE(first.findings.empty());
}

// Depths of points.

TEST(InnerDepth, IsTheDistanceToTheSurface) {
    const ExactBody box = convex(Aabb{{0, 0, 0}, {10, 20, 30}});
    EXPECT_NEAR(inner_depth(box, {5, 10, 27}), 3.0, 1e-9);
    EXPECT_NEAR(inner_depth(box, {13, 24, 15}), -5.0, 1e-6);
    const ExactBody mesh = solid_mesh(mesh_of({{0, 0, 0}, {10, 20, 30}}));
    EXPECT_NEAR(inner_depth(mesh, {5, 10, 27}), 3.0, 1e-6);
    EXPECT_NEAR(inner_depth(mesh, {13, 24, 15}), -5.0, 1e-6);
    const RevolvedProfile cone{.elements = {{0, 10, 20, 0}}};
    EXPECT_NEAR(inner_depth(cone, {0, 0, 1}), 1.0, 1e-9);
    EXPECT_NEAR(inner_depth(cone, {0, 0, 10}), 5.0 * 2.0 / std::sqrt(5.0), 1e-9);
}

TEST(CoveredRadius, IsNoLargerThanTheTrueOne) {
    // In a box, a ball of radius r at depth d is covered within d + r of its centre.
    const CutModel stock = *make_cut_model({SolidBox{{{0, 0, -30}, {100, 100, 0}}}, 0.0}, 0.5);
    std::mt19937 random(5);
    const auto number = [&](double low, double high) {
        return std::uniform_real_distribution<>(low, high)(random);
    };
    int sharp = 0;
    for (int i = 0; i < 200; ++i) {
        const Vec3 centre(number(-4, 104), number(-4, 104), number(-34, 4));
        const double reach = number(0.5, 8.0);
        const Vec3 inside = glm::min(centre - Vec3(0, 0, -30), Vec3(100, 100, 0) - centre);
        const double truth = std::min({inside.x, inside.y, inside.z}) + reach;
        const double found = covered_radius(stock.lines, centre, reach, {.limit = 50}).radius;
        EXPECT_LE(found, std::max(truth, 0.0) + 1e-9) << i;
        sharp += found > 0.9 * truth - 0.5;
    }
    EXPECT_GT(sharp, 150);
}

} // namespace
} // namespace core
