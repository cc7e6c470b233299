#include <cmath>
#include <numbers>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "gcode/cycles/threading.h"
#include "tests/support/reference.h"

namespace gcode {
namespace {

/// An external thread with its crest 1 mm and its root 2 mm below the drive line.
ThreadingWords external() {
    ThreadingWords words;
    words.pitch = 1.5;
    words.i = -1.0;
    words.j = 0.75;
    words.k = 1.0;
    return words;
}

std::vector<ThreadingMove> moves_of(const ThreadingWords& words) {
    const auto moves = threading_moves({10, 0}, {10, -5}, words);
    EXPECT_TRUE(moves) << moves.error().message;
    return moves.value_or(std::vector<ThreadingMove>{});
}

TEST(Threading, CutsToTheFullDepthAndReturns) {
    const std::vector<ThreadingMove> expected = {
        {{10.25, 0}, {}}, {{8.25, 0}, {}}, {{8.25, -5}, 1.5}, {{10.25, -5}, {}}, // 0.75 deep
        {{10, 0}, {}},    {{8, 0}, {}},    {{8, -5}, 1.5},    {{10, -5}, {}},    // 1 deep
        {{10, -5}, {}}};
    EXPECT_EQ(moves_of(external()), expected);
}

TEST(Threading, InternalIsOnTheOtherSide) {
    ThreadingWords words = external();
    words.i = 1.0;
    const auto moves = moves_of(words);
    EXPECT_EQ(moves[0].end, (TurningPoint{9.75, 0}));
    EXPECT_EQ(moves[1].end, (TurningPoint{11.75, 0}));
}

TEST(Threading, TaperSlowsZDownToThePitch) {
    ThreadingWords words = external();
    words.j = 0.5;
    words.taper_length = 1.0;
    words.tapered_ends = 3;
    const double ramp = 1.5 * std::numbers::sqrt2; // 1 mm down over 1 mm along
    const auto moves = moves_of(words);
    const std::vector<ThreadingMove> first_pass = {{{10.5, 0}, {}},   {{9.5, 0}, ramp},
                                                   {{8.5, -1}, ramp}, {{8.5, -4}, 1.5},
                                                   {{9.5, -5}, ramp}, {{10.5, -5}, {}}};
    EXPECT_EQ(std::vector<ThreadingMove>(moves.begin(), moves.begin() + 6), first_pass);
}

TEST(Threading, CompoundAngleShiftsThePassesAlongTheFlank) {
    ThreadingWords words = external();
    words.compound_angle = std::numbers::pi / 4;
    const auto moves = moves_of(words);
    EXPECT_NEAR(moves[0].end.z, -0.75, 1e-12);
    EXPECT_NEAR(moves[2].end.z, -4.75, 1e-12);
    EXPECT_NEAR(moves[4].end.z, -1.0, 1e-12);
    EXPECT_NEAR(moves[6].end.z, -5.0, 1e-12);
}

TEST(Threading, DegressionOfTwoCutsEqualAreas) {
    ThreadingWords words = external();
    words.j = 0.25;
    words.degression = 2.0;
    const auto moves = moves_of(words);
    EXPECT_EQ(moves.size(), 16u * 4 + 1); // 0.25 sqrt(n) reaches 1 at the 16th pass
    EXPECT_NEAR(moves[4 * 3 + 1].end.x, 8.5,
                1e-12); // the fourth pass is twice as deep as the first
}

TEST(Threading, SpringPassesRepeatTheFullDepth) {
    ThreadingWords words = external();
    words.spring_passes = 2;
    EXPECT_EQ(moves_of(words).size(), 4u * 4 + 1);
    words.spring_passes = -1;
    EXPECT_EQ(moves_of(words).size(), 1u * 4 + 1);
}

TEST(Threading, RefusesWordsThatMakeNoThread) {
    const auto refuses = [](auto change) {
        ThreadingWords words = external();
        change(words);
        return !threading_moves({10, 0}, {10, -5}, words);
    };
    EXPECT_TRUE(refuses([](ThreadingWords& w) { w.pitch.reset(); }));
    EXPECT_TRUE(refuses([](ThreadingWords& w) { w.i.reset(); }));
    EXPECT_TRUE(refuses([](ThreadingWords& w) { w.j.reset(); }));
    EXPECT_TRUE(refuses([](ThreadingWords& w) { w.k.reset(); }));
    EXPECT_TRUE(refuses([](ThreadingWords& w) { w.i = 0.0; }));
    EXPECT_TRUE(refuses([](ThreadingWords& w) { w.j = 0.0; }));
    EXPECT_TRUE(refuses([](ThreadingWords& w) { w.k = w.j; }));
    EXPECT_TRUE(refuses([](ThreadingWords& w) { w.spring_passes = -2; }));
    EXPECT_TRUE(refuses([](ThreadingWords& w) { w.tapered_ends = -1; }));
    EXPECT_TRUE(refuses([](ThreadingWords& w) { w.compound_angle = std::numbers::pi / 2; }));
}

TEST(Threading, RefusesPassesWithoutEnd) {
    ThreadingWords words = external();
    words.j = 1e-9;
    EXPECT_FALSE(threading_moves({10, 0}, {10, -5}, words));
    words = external();
    words.spring_passes = 2'000'000'000;
    EXPECT_FALSE(threading_moves({10, 0}, {10, -5}, words));
}

struct ThreadingCase {
    std::string program;
    core::Result<std::vector<ThreadingMove>> ours;
};

ThreadingCase random_thread(std::mt19937& rng) {
    const auto pick = [&](int low, int high) {
        return std::uniform_int_distribution<int>(low, high)(rng);
    };
    ThreadingWords words;
    const bool diameters = pick(0, 3) == 0;
    const TurningPoint start{pick(100, 400) / 10.0, pick(-50, 50) / 10.0};
    TurningPoint end{start.x, pick(-300, 50) / 10.0};
    const double scale = diameters ? 2.0 : 1.0;
    std::string block = fmt::format("G76 Z{}", end.z);
    if (pick(0, 2) == 0) {
        end.x = pick(100, 400) / 10.0;
        block += fmt::format(" X{}", end.x * scale);
    }
    const auto say = [&](char letter, auto value) {
        block += fmt::format(" {}{}", letter, value);
        return value;
    };
    if (pick(0, 19)) words.pitch = say('P', pick(1, 60) / 10.0);
    if (pick(0, 19)) words.i = say('I', pick(-30, 30) / 10.0) / scale;
    if (pick(0, 19)) words.j = say('J', pick(-1, 20) / 10.0) / scale;
    if (pick(0, 19)) words.k = say('K', pick(5, 60) / 20.0) / scale;
    if (pick(0, 1)) words.degression = say('R', pick(0, 20) / 10.0);
    if (pick(0, 1)) words.compound_angle = say('Q', 2 * pick(-15, 30)) * std::numbers::pi / 180.0;
    if (pick(0, 2) == 0) words.spring_passes = say('H', pick(-2, 3));
    if (pick(0, 1)) words.taper_length = say('E', pick(-2, 40) / 10.0);
    if (pick(0, 1)) words.tapered_ends = say('L', pick(0, 5));
    const std::string program =
        fmt::format("G21 G90 G18 G94 F100 M3 S100\nG0 X{} Z{}\n{}\n{}\nM2\n", start.x, start.z,
                    diameters ? "G7" : "G8", block);
    return {program, threading_moves(start, end, words)};
}

void expect_same_moves(const std::vector<ThreadingMove>& ours,
                       const std::vector<test_support::ReferenceMotion>& theirs) {
    ASSERT_EQ(ours.size() + 1, theirs.size()); // the first is the rapid to the start
    for (size_t i = 0; i < ours.size(); ++i) {
        const test_support::ReferenceMotion& motion = theirs[i + 1];
        EXPECT_EQ(motion.call, ours[i].pitch ? "straight_feed" : "straight_traverse");
        EXPECT_NEAR(ours[i].end.x, motion.values[0], 1e-6);
        EXPECT_NEAR(ours[i].end.z, motion.values[2], 1e-6);
    }
}

TEST(Threading, AgreesWithTheReferenceOnRandomThreads) {
    if (!test_support::reference_is_installed()) GTEST_SKIP() << "rs274 is not installed";
    std::mt19937 rng(76);
    std::vector<ThreadingCase> cases;
    std::vector<std::string> programs;
    for (int i = 0; i < 300; ++i) {
        cases.push_back(random_thread(rng));
        programs.push_back(cases.back().program);
    }
    const auto runs = test_support::run_reference(programs);
    ASSERT_EQ(runs.size(), cases.size());
    size_t refused = 0;
    for (size_t i = 0; i < cases.size(); ++i) {
        SCOPED_TRACE(cases[i].program);
        ASSERT_EQ(runs[i].refusal.empty(), cases[i].ours.has_value()) << runs[i].refusal;
        refused += !cases[i].ours;
        if (cases[i].ours) expect_same_moves(*cases[i].ours, runs[i].motions);
        if (HasFailure()) return;
    }
    EXPECT_GT(refused, 60u);
    EXPECT_LT(refused, 240u);
}

} // namespace
} // namespace gcode
