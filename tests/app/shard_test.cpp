#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/batch/shard.h"

namespace {

using app::Shard;

std::vector<uintmax_t> random_sizes(size_t count) {
    std::mt19937_64 random(11);
    std::vector<uintmax_t> sizes(count);
    // From a hundred bytes to a hundred megabytes, as programs are.
    for (uintmax_t& size : sizes)
        size = static_cast<uintmax_t>(
            std::pow(10.0, std::uniform_real_distribution<double>(2.0, 8.0)(random)));
    return sizes;
}

TEST(ShareOf, TakesTheLargestFirstToTheLeastLoaded) {
    const std::vector<uintmax_t> sizes = {1, 7, 5, 5, 4, 0};
    // 7 to share 1, 5 to 2, 5 to 3, 4 to 2 (a tie, the first), 1 to 3, the empty one to 3.
    EXPECT_EQ(app::share_of(sizes, 1, 3), (std::vector<size_t>{1}));
    EXPECT_EQ(app::share_of(sizes, 2, 3), (std::vector<size_t>{2, 4}));
    EXPECT_EQ(app::share_of(sizes, 3, 3), (std::vector<size_t>{0, 3, 5}));
}

TEST(ShareOf, GivesEveryProgramToOneShare) {
    const std::vector<uintmax_t> sizes = random_sizes(500);
    for (const size_t n : {1, 2, 7, 64, 501}) {
        std::vector<size_t> all;
        for (size_t i = 1; i <= n; ++i)
            for (const size_t place : app::share_of(sizes, i, n)) all.push_back(place);
        std::sort(all.begin(), all.end());
        std::vector<size_t> wanted(sizes.size());
        std::iota(wanted.begin(), wanted.end(), size_t(0));
        EXPECT_EQ(all, wanted) << n;
    }
}

/// Taken largest first, no share is heavier than four thirds of the best there can be.
TEST(ShareOf, IsBalanced) {
    const std::vector<uintmax_t> sizes = random_sizes(500);
    const double whole = std::accumulate(sizes.begin(), sizes.end(), 0.0);
    const double largest = static_cast<double>(*std::max_element(sizes.begin(), sizes.end()));
    for (const size_t n : {2, 7, 64}) {
        const double best = std::max(whole / static_cast<double>(n), largest);
        for (size_t i = 1; i <= n; ++i) {
            double load = 0.0;
            for (const size_t place : app::share_of(sizes, i, n))
                load += static_cast<double>(sizes[place]);
            EXPECT_LE(load, 4.0 / 3.0 * best) << i << " of " << n;
        }
    }
}

TEST(ShareNamed, ReadsOneOfSomeAndNothingElse) {
    EXPECT_EQ(*app::share_named("2/8"), (app::ShareName{2, 8}));
    EXPECT_EQ(*app::share_named("1/1"), (app::ShareName{1, 1}));
    for (const char* text : {"", "2", "0/3", "4/3", "1/0", "1/2/3", "-1/2", "1 /2", "a/b", "1/",
                             "1/99999999999999999999999"})
        EXPECT_FALSE(app::share_named(text)) << text;
}

/// Ten programs in three shares, as three machines would write them.
std::vector<Shard> three_shards() {
    std::vector<uintmax_t> sizes(10);
    std::iota(sizes.begin(), sizes.end(), 1);
    std::vector<Shard> shards;
    for (size_t i = 1; i <= 3; ++i) {
        Shard shard{.file = fmt::format("{}.json", i),
                    .version = "1",
                    .options = "{}",
                    .share = {i, 3},
                    .places = app::share_of(sizes, i, 3)};
        for (size_t program = 0; program < 10; ++program)
            shard.programs.push_back(fmt::format("teil \"{}\" ä.nc", program));
        for (const size_t place : shard.places)
            shard.results.push_back({.program = shard.programs[place], .cycle_time = 0.1 * place});
        shards.push_back(std::move(shard));
    }
    return shards;
}

std::string why_not(std::vector<Shard> shards) {
    const auto made = app::merged(std::move(shards));
    if (made) return "";
    return (made.error().file.empty() ? "" : made.error().file + " ") + made.error().message;
}

TEST(Merged, IsWhatOneRunWouldHaveGiven) {
    std::vector<Shard> shards = three_shards();
    std::swap(shards[0], shards[2]);
    const auto results = app::merged(shards);
    ASSERT_TRUE(results) << results.error().message;
    ASSERT_EQ(results->size(), 10u);
    for (size_t i = 0; i < 10; ++i) {
        EXPECT_EQ((*results)[i].program, shards[0].programs[i]);
        EXPECT_EQ((*results)[i].cycle_time, 0.1 * i);
    }
}

TEST(Merged, NamesSharesThatAreMissingOrThereTwice) {
    const std::vector<Shard> all = three_shards();
    EXPECT_EQ(why_not({}), "there are no shares");
    EXPECT_EQ(why_not({all[0], all[2]}), "a share is missing: 2/3");
    EXPECT_EQ(why_not({all[1]}), "these shares are missing: 1/3, 3/3");
    Shard again = all[1];
    again.file = "again.json";
    EXPECT_EQ(why_not({all[0], all[1], all[2], again}),
              "again.json is share 2/3, and so is 2.json");
}

TEST(Merged, RefusesSharesOfDifferentBatches) {
    std::vector<Shard> shards = three_shards();
    shards[1].version = "2";
    EXPECT_EQ(why_not(shards),
              "2.json belongs to another batch than 1.json: another version of Feeler made it");
    shards = three_shards();
    shards[2].programs.push_back("new.nc");
    EXPECT_EQ(why_not(shards),
              "3.json belongs to another batch than 1.json: its list of programs is another");
    shards = three_shards();
    shards[2].options = "{1}";
    EXPECT_EQ(why_not(shards),
              "3.json belongs to another batch than 1.json: its options are others");
    shards = three_shards();
    shards[1].share.n = 4;
    EXPECT_EQ(why_not(shards),
              "2.json belongs to another batch than 1.json: it is share 2/4, not one of 3");
}

TEST(Merged, RefusesResultsThatDoNotFitTheirShare) {
    std::vector<Shard> shards = three_shards();
    const std::string missing = shards[1].results.back().program;
    shards[1].results.pop_back();
    EXPECT_EQ(why_not(shards), "2.json has a result that is not one of its programs'");
    shards[1].places.pop_back();
    EXPECT_EQ(why_not(shards), "no share has a result of " + missing);
    shards = three_shards();
    shards[2].places[0] = 99;
    EXPECT_EQ(why_not(shards), "3.json has a result that is not one of its programs'");
}

TEST(Shard, ComesBackFromItsText) {
    Shard shard = three_shards()[1];
    const auto back = app::shard_from_json(app::json_of(shard));
    ASSERT_TRUE(back) << back.error().message;
    shard.file.clear();
    EXPECT_EQ(*back, shard);
    EXPECT_FALSE(app::shard_from_json("{}"));
    EXPECT_FALSE(app::shard_from_json("[1"));
    EXPECT_EQ(app::shard_from_json("{\"feeler_shard\": 2}").error().message,
              "was written by a newer version of Feeler");
}

} // namespace
