#include <random>

#include <gtest/gtest.h>

#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"

namespace core {
namespace {

ToolDescription random_tool(std::mt19937& random, ToolNumber number) {
    std::uniform_real_distribution<double> fraction(0.0, 1.0);
    ToolDescription tool;
    tool.number = number;
    tool.diameter = 4.0 + 8.0 * fraction(random);
    tool.shape = fraction(random) < 0.5 ? ToolShape::flat : ToolShape::ball;
    tool.flute_length = 8.0 + 10.0 * fraction(random);
    const double shank = tool.diameter * (fraction(random) < 0.5 ? 1.0 : 1.3);
    tool.shank = {{shank, shank, 5.0 + 10.0 * fraction(random)}};
    tool.holder = {{20, 32, 20}, {40, 40, 30}};
    return tool;
}

/// A block of 60 x 60 x 20 between two jaws and under a clamp, and two tools.
Setup random_setup(std::mt19937& random) {
    std::uniform_real_distribution<double> fraction(0.0, 1.0);
    Setup setup;
    setup.mesh_size = 1.0;
    setup.stock = {SolidBox{{{0, 0, -20}, {60, 60, 0}}}, 0.0};
    for (const int number : {1, 2}) {
        const ToolNumber tool{number};
        setup.tools.emplace(tool, *assemble(random_tool(random, tool)));
    }
    const auto add = [&](const char* name, const Aabb& box) {
        Fixture fixture;
        fixture.name = name;
        fixture.body = convex(box);
        setup.fixtures.push_back(std::move(fixture));
    };
    add("jaw-1", {{-30, -20, -30}, {90, 0, -12}});
    add("jaw-2", {{-30, 60, -30}, {90, 80, -12}});
    const double x = 50.0 * fraction(random);
    add("clamp", {{x, 40, 0}, {x + 15, 75, 8.0 + 10.0 * fraction(random)}});
    setup.fixtures.back().expendable = fraction(random) < 0.2;
    return setup;
}

/// A program of events above and in that block: rapids, feeds, arcs, tool changes, fixtures that
/// are added and removed.
std::vector<std::vector<Event>> random_program(std::mt19937& random, const Setup& setup) {
    std::uniform_real_distribution<double> fraction(0.0, 1.0);
    std::vector<std::vector<Event>> blocks;
    int tool = 1;
    Vec3 gauge(0, 0, 200);
    blocks.push_back(
        {ToolChange{ToolNumber{tool}}, SpindleChange{SpindleDirection::clockwise, 1e4}});
    for (int i = 0; i < 120; ++i) {
        const double choice = fraction(random);
        if (choice < 0.03) {
            tool = 3 - tool;
            blocks.push_back({ToolChange{ToolNumber{tool}}});
            continue;
        }
        if (choice < 0.05) {
            blocks.push_back({FixtureChange{2, fraction(random) < 0.5}});
            continue;
        }
        const double length = setup.tools.at(ToolNumber{tool}).length;
        const double step = fraction(random) < 0.8 ? 4.0 : 60.0;
        Vec3 to = gauge;
        for (int axis = 0; axis < 3; ++axis)
            if (fraction(random) < 0.6) to[axis] += step * (fraction(random) - 0.5);
        to = glm::clamp(to, Vec3(-15, -15, length - 12.0), Vec3(75, 75, length + 30.0));
        Motion motion{.kind = fraction(random) < 0.7 ? MotionKind::feed : MotionKind::rapid,
                      .from = {gauge.x, gauge.y, gauge.z},
                      .to = {to.x, to.y, to.z}};
        motion.feed = motion.kind == MotionKind::feed ? 800.0 : 0.0;
        if (motion.kind == MotionKind::feed && fraction(random) < 0.2) {
            motion.kind = MotionKind::arc;
            motion.to = motion.from;
            motion.arc = ArcPath{2, gauge + Vec3(3, 1, 0), 6.283185307179586};
            to = gauge;
        }
        gauge = to;
        blocks.push_back({motion});
    }
    return blocks;
}

std::vector<BlockResult> carried_out(Setup setup, Detail detail,
                                     const std::vector<std::vector<Event>>& program) {
    setup.detail = detail;
    SimulatorState state = *start_of_run(setup, {0.0, 0.0, 200.0});
    std::vector<BlockResult> results;
    for (const auto& events : program)
        results.push_back(run_block(
            setup, {BlockIndex{static_cast<uint32_t>(results.size())}, false, events}, state));
    return results;
}

/// The findings as the user of a set-up sees them.
std::vector<std::pair<std::string, std::string>> findings(const BlockResult& result) {
    std::vector<std::pair<std::string, std::string>> found;
    for (const Finding& finding : result.findings)
        found.emplace_back(finding.rule, finding.pair[0] + "/" + finding.pair[1]);
    return found;
}

class Details : public testing::TestWithParam<unsigned> {};

TEST_P(Details, OfThePairThatDecidesAreThoseOfAFullCheck) {
    std::mt19937 random(GetParam());
    const core::Setup setup = random_setup(random);
    const auto program = random_program(random, setup);
    const auto full = carried_out(setup, Detail::every_pair, program);
    const auto brief = carried_out(setup, Detail::deciding_pair, program);
    size_t loose = 0, decided = 0;
    for (size_t i = 0; i < full.size(); ++i) {
        SCOPED_TRACE(i);
        EXPECT_EQ(full[i].verdict, brief[i].verdict);
        EXPECT_EQ(full[i].removed, brief[i].removed);
        EXPECT_EQ(findings(full[i]), findings(brief[i]));
        ASSERT_EQ(full[i].deciding.has_value(), brief[i].deciding.has_value());
        if (!full[i].deciding) continue;
        const PairClearance& a = full[i].pairs[*full[i].deciding];
        const PairClearance& b = brief[i].pairs[*brief[i].deciding];
        EXPECT_NEAR(a.margin(), b.margin(), 1e-6);
        if (!(a.pair == b.pair)) continue; // equal distance
        EXPECT_NEAR(a.upper, b.upper, 1e-6);
        EXPECT_LE(b.lower, a.upper + 1e-6);
        loose += a.lower - b.lower > 0.5;
        ++decided;
    }
    EXPECT_LE(loose, decided / 20);
}

TEST_P(Details, LeaveOutNothingThatIsNotClear) {
    std::mt19937 random(GetParam());
    const core::Setup setup = random_setup(random);
    const auto program = random_program(random, setup);
    const auto full = carried_out(setup, Detail::every_pair, program);
    const auto verdicts = carried_out(setup, Detail::verdict, program);
    size_t measured = 0;
    for (size_t i = 0; i < full.size(); ++i) {
        SCOPED_TRACE(i);
        EXPECT_EQ(full[i].verdict, verdicts[i].verdict);
        EXPECT_EQ(findings(full[i]), findings(verdicts[i]));
        for (const PairClearance& pair : verdicts[i].pairs) {
            measured += pair.found();
            for (const PairClearance& known : full[i].pairs)
                if (known.pair == pair.pair) {
                    EXPECT_LE(pair.lower, known.upper + 1e-6);
                }
        }
    }
    size_t all = 0;
    for (const BlockResult& block : full)
        for (const PairClearance& pair : block.pairs) all += pair.found();
    EXPECT_LT(measured, all);
}

TEST_P(Details, OfPairsNeverSayMoreThanAFullCheckMeasures) {
    std::mt19937 random(GetParam());
    const core::Setup setup = random_setup(random);
    const auto program = random_program(random, setup);
    const auto full = carried_out(setup, Detail::every_pair, program);
    const auto brief = carried_out(setup, Detail::deciding_pair, program);
    for (size_t i = 0; i < full.size(); ++i)
        for (const PairClearance& pair : brief[i].pairs)
            for (const PairClearance& known : full[i].pairs)
                if (known.pair == pair.pair) {
                    EXPECT_LE(pair.lower, known.upper + 1e-6) << i;
                }
}

INSTANTIATE_TEST_SUITE_P(Random, Details, testing::Range(0U, 24U));

} // namespace
} // namespace core
