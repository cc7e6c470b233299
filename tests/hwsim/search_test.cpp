#include <gtest/gtest.h>

#include "core/distance/distance_engine.h"
#include "hwsim/search.h"
#include "tests/hwsim/random_models.h"
#include "tests/hwsim/search_oracle.h"

namespace hwsim {
namespace {

void expect_as_everything_compared(const Scene& scene) {
    const Answer found = search(scene.memory, scene.query);
    ASSERT_EQ(found.stop, Stop::none);
    const uint64_t least =
        least_of_all(scene.tools, scene.works, scene.query.segment, scene.query.limit);
    ASSERT_EQ(found.squared, least);
    ASSERT_EQ(found.found, least < scene.query.limit);
    if (!found.found) return;
    const FixedVec offset = offset_at(scene.query.segment, found.sample);
    ASSERT_EQ(squared_distance(record_named(scene, found.tool_record), offset,
                               record_named(scene, found.work_record)),
              least);
}

/// Scenes of many kinds: `apart` and `near` count what became of them.
struct Tally {
    int below = 0, above = 0, zero = 0;
};

Tally look_at_scenes(uint32_t seed, int count, const SceneKind& kind) {
    std::mt19937 rng(seed);
    Tally tally;
    for (int i = 0; i < count && !testing::Test::HasFatalFailure(); ++i) {
        const Scene scene = random_scene(rng, kind);
        expect_as_everything_compared(scene);
        const Answer found = search(scene.memory, scene.query);
        EXPECT_EQ(found, SearchOracle(scene.memory, scene.query).answer);
        ++(found.squared == 0 ? tally.zero : (found.found ? tally.below : tally.above));
    }
    return tally;
}

TEST(Search, IsThatOfAllPairsAtAllSamples) {
    const Tally tally = look_at_scenes(1, 1'000, {});
    EXPECT_GT(tally.below, 200);
    EXPECT_GT(tally.above, 50);
    EXPECT_GT(tally.zero, 50);
}

TEST(Search, IsThatOfAllPairsOnALattice) {
    // Few places, so nearly everything is as near as something else.
    const Tally small = look_at_scenes(2, 1'000, {.reach = 3, .most_records = 40});
    const Tally coarse = look_at_scenes(3, 1'000, {.reach = 4 * 4096, .grid = 4096});
    const Tally bare = look_at_scenes(4, 1'000, {.reach = 5, .most_records = 80, .bare = true});
    for (const Tally& tally : {small, coarse, bare}) {
        EXPECT_GT(tally.below, 100);
        EXPECT_GT(tally.above, 30);
        EXPECT_GT(tally.zero, 30);
    }
}

TEST(Search, CountsOnlyPairsBelowTheLimit) {
    const std::vector<Record> tools{{{0, 0, 0}, 0, 0}}, works{{{3, 4, 0}, 0, 0}};
    for (const auto& [limit, found] : {std::pair{25, false}, {26, true}, {24, false}}) {
        const Scene scene = scene_of(tools, works, {}, static_cast<uint64_t>(limit));
        const Answer answer = search(scene.memory, scene.query);
        EXPECT_EQ(answer.found, found);
        EXPECT_EQ(answer.squared, std::min<uint64_t>(25, static_cast<uint64_t>(limit)));
    }
}

TEST(Search, RefusesFromTheThresholdAndTheReserveDownwards) {
    EXPECT_EQ(limit_of({.threshold = 100}), 103U * 103U);
    const std::vector<Record> tools{{{0, 0, 0}, 0, 0}};
    for (const int32_t apart : {102, 103}) {
        const Scene scene = scene_of(tools, {{{apart, 0, 0}, 0, 0}}, {.threshold = 100},
                                     limit_of({.threshold = 100}));
        EXPECT_EQ(search(scene.memory, scene.query).found, apart < 103);
    }
}

TEST(Search, NamesTheFirstOfPairsThatAreEquallyNear) {
    const std::vector<Record> tools{{{0, 0, 0}, 0, 0}};
    const std::vector<Record> works{{{-5, 0, 0}, 0, 0}, {{5, 0, 0}, 0, 0}};
    const Scene scene = scene_of(tools, works, {}, beyond_all_squares, 1);
    const Answer answer = search(scene.memory, scene.query);
    EXPECT_EQ(record_named(scene, answer.work_record), works[0]);
    EXPECT_EQ(answer.counts.pair_tests, 1U);
}

TEST(Search, FindsNothingInAnEmptyModel) {
    Scene scene = scene_of({{{0, 0, 0}, 5, 5}}, {}, {}, beyond_all_squares);
    EXPECT_FALSE(search(scene.memory, scene.query).found);
    EXPECT_EQ(search(scene.memory, scene.query).stop, Stop::none);
    scene = scene_of({}, {{{0, 0, 0}, 5, 5}}, {}, beyond_all_squares);
    EXPECT_FALSE(search(scene.memory, scene.query).found);
}

TEST(Search, AgreesWithTheFastEngineOnBarePoints) {
    std::mt19937 rng(6);
    for (int i = 0; i < 300; ++i) {
        Scene scene = random_scene(rng, {.reach = i % 2 ? 6 : 2'000'000, .bare = true});
        scene.query.segment.end = scene.query.segment.start;
        scene.query.limit = beyond_all_squares;
        const auto engine = core::fast_engine();
        const auto points_of = [](const std::vector<Record>& records) {
            std::vector<core::Vec3> points;
            for (const Record& r : records) points.emplace_back(r.base[0], r.base[1], r.base[2]);
            return points;
        };
        const auto work = engine->add(points_of(scene.works)).value();
        const auto tool = engine->add(points_of(scene.tools)).value();
        const FixedVec& at = scene.query.segment.start;
        const auto pair = engine->closest_pair(
            work, tool, core::translation({double(at[0]), double(at[1]), double(at[2])}));
        const Answer answer = search(scene.memory, scene.query);
        if (answer.stop == Stop::out_of_range) continue;
        ASSERT_EQ(pair.value().distance, std::sqrt(static_cast<double>(answer.squared)));
    }
}

TEST(Search, NeedsNoMoreStackThanItSays) {
    std::mt19937 rng(7);
    int deep = 0;
    for (int i = 0; i < 300; ++i) {
        const Scene scene = random_scene(rng, {});
        const Answer answer = search(scene.memory, scene.query);
        const uint32_t depth = answer.counts.deepest;
        EXPECT_EQ(search(scene.memory, scene.query, depth), answer);
        if (depth == 0) continue;
        ++deep;
        EXPECT_EQ(search(scene.memory, scene.query, depth - 1).stop, Stop::stack_overflow);
    }
    EXPECT_GT(deep, 200);
}

TEST(Search, GivesNoAnswerFromABadLine) {
    std::mt19937 rng(8);
    int seen = 0;
    for (int i = 0; i < 2'000; ++i) {
        Scene scene = random_scene(rng, {});
        const Answer before = search(scene.memory, scene.query);
        const size_t hit = rng() % scene.memory.size();
        scene.memory[hit].word[rng() % 16] ^= 1U << (rng() % 32);
        const Answer after = search(scene.memory, scene.query);
        if (after.stop == Stop::none) {
            ASSERT_EQ(after, before); // the line was not looked at
        } else {
            ASSERT_EQ(after.stop, Stop::bad_check);
            ASSERT_EQ(after.at_line, hit);
            ++seen;
        }
    }
    EXPECT_GT(seen, 150);
}

TEST(Search, GivesNoAnswerFromALineWrittenLater) {
    std::mt19937 rng(9);
    const Scene good = random_scene(rng, {.most_records = 30});
    Scene scene = good;
    scene.query.work_epoch = 0;
    EXPECT_EQ(search(scene.memory, scene.query).stop, Stop::model_changed);
    scene = good;
    scene.query.tool_epoch = 0;
    EXPECT_EQ(search(scene.memory, scene.query).stop, Stop::model_changed);
    scene = good;
    scene.query.work_epoch = scene.query.tool_epoch = 2;
    EXPECT_EQ(search(scene.memory, scene.query), search(good.memory, good.query));
}

TEST(Search, GivesNoAnswerFromBeyondTheMemory) {
    std::mt19937 rng(10);
    Scene scene = random_scene(rng, {});
    scene.query.work_header = static_cast<uint32_t>(scene.memory.size());
    const Answer answer = search(scene.memory, scene.query);
    EXPECT_EQ(answer.stop, Stop::bad_address);
    EXPECT_EQ(answer.at_line, scene.memory.size());
}

TEST(Search, GivesNoAnswerOutOfRange) {
    const std::vector<Record> tools{{{0, 0, 0}, 0, 100}};
    Segment segment{.start = {greatest_coordinate - 100, 0, 0}};
    segment.end = segment.start;
    Scene scene = scene_of(tools, {{{0, 0, 0}, 0, 0}}, segment, beyond_all_squares);
    EXPECT_EQ(search(scene.memory, scene.query).stop, Stop::none);
    scene.query.segment.end[0] += 1;
    EXPECT_EQ(search(scene.memory, scene.query).stop, Stop::out_of_range);
}

} // namespace
} // namespace hwsim
