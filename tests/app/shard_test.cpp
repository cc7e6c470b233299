#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "app/library/shard/shard.h"

namespace {

using app::Shard;

std::vector<uintmax_t> random_sizes(size_t count) {
    std::mt19937_64 random(11);
    std::vector<uintmax_t> sizes(count);
    // From a hundred bytes to a hundred megabytes, as real programs.
    for (uintmax_t& size : sizes)
        size = static_cast<uintmax_t>(
            std::pow(10.0, std::uniform_real_distribution<double>(2.0, 8.0)(random)));
    return sizes;
}

TEST(ShardOf, AssignsTheLargestFirstToTheLeastLoaded) {
    const std::vector<uintmax_t> sizes = {1, 7, 5, 5, 4, 0};
    // 7 to shard 1, 5 to 2, 5 to 3, 4 to 2 (a tie: the first), 1 to 3, the empty one to 3.
    EXPECT_EQ(app::indices_of_shard(sizes, {1, 3}), (std::vector<size_t>{1}));
    EXPECT_EQ(app::indices_of_shard(sizes, {2, 3}), (std::vector<size_t>{2, 4}));
    EXPECT_EQ(app::indices_of_shard(sizes, {3, 3}), (std::vector<size_t>{0, 3, 5}));
}

TEST(ShardOf, GivesEveryProgramToOneShard) {
    const std::vector<uintmax_t> sizes = random_sizes(500);
    for (const size_t n : {1, 2, 7, 64, 501}) {
        std::vector<size_t> all;
        for (size_t i = 1; i <= n; ++i)
            for (const size_t index : app::indices_of_shard(sizes, {i, n})) all.push_back(index);
        std::sort(all.begin(), all.end());
        std::vector<size_t> wanted(sizes.size());
        std::iota(wanted.begin(), wanted.end(), size_t(0));
        EXPECT_EQ(all, wanted) << n;
    }
}

/// Assigned largest first, no shard exceeds four thirds of the optimum.
TEST(ShardOf, IsBalanced) {
    const std::vector<uintmax_t> sizes = random_sizes(500);
    const double whole = std::accumulate(sizes.begin(), sizes.end(), 0.0);
    const double largest = static_cast<double>(*std::max_element(sizes.begin(), sizes.end()));
    for (const size_t n : {2, 7, 64}) {
        const double best = std::max(whole / static_cast<double>(n), largest);
        for (size_t i = 1; i <= n; ++i) {
            double load = 0.0;
            for (const size_t index : app::indices_of_shard(sizes, {i, n}))
                load += static_cast<double>(sizes[index]);
            EXPECT_LE(load, 4.0 / 3.0 * best) << i << " of " << n;
        }
    }
}

TEST(ShardNumber, IsReadAsNumberAndCountAndNothingElse) {
    EXPECT_EQ(*app::shard_named("2/8"), (app::ShardId{2, 8}));
    EXPECT_EQ(*app::shard_named("1/1"), (app::ShardId{1, 1}));
    for (const char* text : {"", "2", "0/3", "4/3", "1/0", "1/2/3", "-1/2", "1 /2", "a/b", "1/",
                             "1/99999999999999999999999", "1/1000001"})
        EXPECT_FALSE(app::shard_named(text)) << text;
    EXPECT_EQ(*app::shard_named("1000000/1000000"), (app::ShardId{1'000'000, 1'000'000}));
}

/// Ten programs in three shards, as written by three machines.
std::vector<Shard> three_shards() {
    std::vector<uintmax_t> sizes(10);
    std::iota(sizes.begin(), sizes.end(), 1);
    std::vector<Shard> shards;
    for (size_t i = 1; i <= 3; ++i) {
        Shard shard{.file = fmt::format("{}.json", i),
                    .version = "1",
                    .id = {i, 3},
                    .indices = app::indices_of_shard(sizes, {i, 3})};
        for (size_t program = 0; program < 10; ++program)
            shard.programs.push_back(
                {fmt::format("teil \"{}\" ä.nc", program), sizes[program], "terms"});
        shard.failures = {{.program = "*.tap", .error = app::StoredError{.message = "no file"}}};
        shard.skipped = {{"part.stl", "is a mesh"}, {fmt::format("{}.new", i), "is no program"}};
        for (const size_t index : shard.indices)
            shard.results.push_back(
                {.program = shard.programs[index].name, .cycle_time = 0.1 * index});
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
    const auto batch = app::merged(shards);
    ASSERT_TRUE(batch) << batch.error().message;
    ASSERT_EQ(batch->programs.size(), 11u);
    for (size_t i = 0; i < 10; ++i) {
        EXPECT_EQ(batch->programs[i].program, shards[0].programs[i].name);
        EXPECT_EQ(batch->programs[i].cycle_time, 0.1 * i);
    }
    EXPECT_EQ(batch->programs[10], shards[0].failures[0]);
    EXPECT_TRUE(batch->unchecked.empty());
}

TEST(Merged, NamesTheSkippedFilesThatAllHaveSeen) {
    const auto batch = app::merged(three_shards());
    ASSERT_TRUE(batch) << batch.error().message;
    EXPECT_EQ(batch->skipped, (std::vector<app::SkippedFile>{{"part.stl", "is a mesh"}}));
}

TEST(Merged, LeavesUncheckedWhatAStoppedShardLacks) {
    std::vector<Shard> shards = three_shards();
    Shard& cut = shards[1];
    const std::string last = cut.results.back().program;
    cut.unchecked = {cut.indices.back()};
    cut.indices.pop_back();
    cut.results.pop_back();
    const auto batch = app::merged(shards);
    ASSERT_TRUE(batch) << batch.error().message;
    EXPECT_EQ(batch->programs.size(), 10u);
    EXPECT_EQ(batch->unchecked, std::vector<std::string>{last});
    EXPECT_EQ(status_of(*batch), 2);
}

TEST(Merged, NamesMissingAndDuplicateShards) {
    const std::vector<Shard> all = three_shards();
    EXPECT_EQ(why_not({}), "there are no shards");
    EXPECT_EQ(why_not({all[0], all[2]}), "a shard is missing: 2/3");
    EXPECT_EQ(why_not({all[1]}), "these shards are missing: 1/3, 3/3");
    Shard again = all[1];
    again.file = "again.json";
    EXPECT_EQ(why_not({all[0], all[1], all[2], again}),
              "again.json is shard 2/3, and so is 2.json");
}

TEST(Merged, RefusesShardsOfDifferentBatches) {
    std::vector<Shard> shards = three_shards();
    shards[1].version = "2";
    EXPECT_EQ(why_not(shards), "2.json belongs to a different batch than 1.json: it was made by a "
                               "different version of Feeler");
    const std::string other = "3.json belongs to a different batch than 1.json: ";
    const auto after = [&](auto change) {
        shards = three_shards();
        change(shards[2]);
        return why_not(shards);
    };
    EXPECT_EQ(after([](Shard& shard) {
                  shard.programs.push_back({"new.nc", 1, "terms"});
              }),
              other + "it contains new.nc, the other one does not");
    EXPECT_EQ(after([](Shard& shard) { shard.programs[3].name = "new.nc"; }),
              other + "it does not contain teil \"3\" ä.nc");
    EXPECT_EQ(after([](Shard& shard) { std::swap(shard.programs[3], shard.programs[4]); }),
              other + "its programs are in a different order");
    EXPECT_EQ(after([](Shard& shard) { shard.programs[4].size = 99; }),
              other + "teil \"4\" ä.nc has a different size there");
    EXPECT_EQ(after([](Shard& shard) { shard.programs[4].terms = "other"; }),
              other + "teil \"4\" ä.nc has different options or a different set-up there");
    EXPECT_EQ(after([](Shard& shard) { shard.failures.clear(); }),
              other + "different files were missing or unreadable there");
    shards = three_shards();
    shards[1].id.n = 4;
    EXPECT_EQ(why_not(shards),
              "2.json belongs to a different batch than 1.json: it is shard 2/4, not one of 3");
}

TEST(Merged, RefusesResultsThatDoNotFitTheirShard) {
    std::vector<Shard> shards = three_shards();
    const std::string missing = shards[1].results.back().program;
    shards[1].results.pop_back();
    EXPECT_EQ(why_not(shards), "2.json has a result that belongs to none of its programs");
    shards[1].indices.pop_back();
    EXPECT_EQ(why_not(shards), "no shard has a result for " + missing);
    shards = three_shards();
    shards[2].indices[0] = 99;
    EXPECT_EQ(why_not(shards), "3.json has a result that belongs to none of its programs");
}

TEST(Merged, RefusesAProgramThatTwoShardsContain) {
    std::vector<Shard> shards = three_shards();
    shards[2].unchecked = {shards[0].indices[0]};
    EXPECT_EQ(why_not(shards), "3.json has a result that belongs to none of its programs");
}

TEST(Merged, NamesSomeOfManyMissingShards) {
    Shard one = three_shards()[0];
    one.id.n = 1'000'000;
    EXPECT_THAT(why_not({one}), testing::EndsWith("20/1000000, 21/1000000, ..."));
}

TEST(Shard, ComesBackFromItsText) {
    Shard shard = three_shards()[1];
    shard.unchecked = {7, 9};
    shard.seconds = 0.1 + 0.2;
    const auto back = app::shard_from_json(app::json_of(shard));
    ASSERT_TRUE(back) << back.error().message;
    shard.file.clear();
    EXPECT_EQ(*back, shard);
    const std::string whole = app::json_of(shard);
    for (size_t length = 0; length + 1 < whole.size(); ++length)
        ASSERT_FALSE(app::shard_from_json(whole.substr(0, length))) << length;
}

TEST(Shard, ReportsATextThatIsNotAShard) {
    const auto why = [](const std::string& text) {
        return app::shard_from_json(text).error().message;
    };
    EXPECT_EQ(why("{}"), "is not a shard of a batch: --format shard writes one");
    EXPECT_EQ(why(""), why("{}"));
    EXPECT_EQ(why("[1"), why("{}"));
    EXPECT_EQ(why("G1 X1\n"), why("{}"));
    EXPECT_EQ(why("{\"feeler_shard\": 2}"), "was written by a newer version of Feeler");
    EXPECT_EQ(why("{\"feeler_shard\": 1, \"versi"),
              "is a shard of a batch that was truncated or changed");
    EXPECT_EQ(why("{\"feeler_shard\": 2, \"versi"), why("{\"feeler_shard\": 2}"));
    EXPECT_EQ(why("{\"feeler_shard\": \"x\"}"),
              "is a shard of a batch that was truncated or changed");
    EXPECT_THAT(why(app::sealed("{\"feeler_shard\": 1, \"version\": 3")),
                testing::StartsWith("is not a shard of a batch: "));
    EXPECT_EQ(why(app::json_of(three_shards()[0]) + " "),
              "is a shard of a batch that was truncated or changed");
}

/// A shard of one program with a near miss, as text without the seal.
std::string unsealed_share() {
    Shard shard{.version = "1", .id = {1, 1}, .programs = {{"a.nc", 9, "terms"}}, .indices = {0}};
    shard.skipped = {{"part.stl", "is a mesh"}};
    shard.results = {{.program = "a.nc",
                      .verdict = core::Verdict::violation,
                      .findings = {{{.rule = "near-miss",
                                     .severity = core::Severity::error,
                                     .block = core::BlockIndex{7},
                                     .pair = {"holder", "clamp"},
                                     .shortfall = 0.5},
                                    8}},
                      .assumptions = {"rapids run straight"},
                      .blocks = 12,
                      .cycle_time = 3.5,
                      .removed = 4.5,
                      .tightest = app::Tightest{.block = 7,
                                                .line = 8,
                                                .pair = {"holder", "clamp"},
                                                .lower = 1.5,
                                                .upper = 1.75,
                                                .allowance = 2.0},
                      .seconds = 0.25}};
    shard.seconds = 6.5;
    const std::string whole = app::json_of(shard);
    return whole.substr(0, whole.rfind(",\n\"seal\""));
}

/// The error for a shard in which the first text is replaced by the second, with a new seal.
std::string why_not_with(const std::string& text, const std::string& other) {
    std::string share = unsealed_share();
    const size_t at = share.find(text);
    if (at == std::string::npos) return "there is no " + text;
    const auto read = app::shard_from_json(app::sealed(share.replace(at, text.size(), other)));
    return read ? "" : read.error().message;
}

TEST(Shard, IsRefusedWhenAnyByteOfItIsAnother) {
    const std::string whole = app::sealed(unsealed_share());
    ASSERT_TRUE(app::shard_from_json(whole));
    for (size_t at = 0; at < whole.size(); ++at) {
        std::string other = whole;
        other[at] = other[at] == '1' ? '2' : '1';
        ASSERT_FALSE(app::shard_from_json(other)) << at;
    }
    std::string edited = whole;
    edited.replace(edited.find("violation"), 9, "clear");
    EXPECT_EQ(app::shard_from_json(edited).error().message,
              "is a shard of a batch that was truncated or changed");
}

TEST(Shard, TakesNoOtherTypeForAList) {
    const std::string findings = "\"findings\":[";
    const std::string share = unsealed_share();
    const size_t from = share.find(findings) + findings.size() - 1;
    const std::string list = share.substr(from, share.find("}]", from) + 2 - from);
    for (const std::string& text :
         {list, std::string("[\"rapids run straight\"]"), std::string("[1, 1]"), std::string("[0]"),
          std::string("[\"holder\",\"clamp\"]"), std::string("[\"a.nc\",9,\"terms\"]"),
          std::string("[\"part.stl\",\"is a mesh\"]")})
        for (const char* other : {"{}", "null", "0", "\"x\"", "[[]]", "{\"0\":0}"})
            EXPECT_THAT(why_not_with(text, other), testing::HasSubstr("is not ")) << text << other;
    for (const char* other : {"[\"holder\"]", "[\"holder\",\"clamp\",\"vise\"]"})
        EXPECT_NE(why_not_with("[\"holder\",\"clamp\"]", other), "") << other;
    EXPECT_NE(why_not_with("[1, 1]", "[1, 1, 1]"), "");
}

TEST(Shard, TakesNoOtherNumberForAWholeOne) {
    for (const char* key : {"\"places\": [0", "\"block\":7", "\"line\":8", "\"blocks\":12",
                            "\"share\": [1", "[\"a.nc\",9", "\"feeler_shard\": 1"}) {
        std::string before = key;
        while (std::isdigit(static_cast<unsigned char>(before.back())) != 0) before.pop_back();
        for (const char* other : {"1e30", "0.7", "-1", "true", "null", "\"0\"", "1.0",
                                  "99999999999999999999", "1000000000000000000000000000000"})
            EXPECT_NE(why_not_with(key, before + other), "") << key << " " << other;
    }
    EXPECT_NE(why_not_with("\"line\":8", "\"line\":4294967296"), "");
    EXPECT_EQ(why_not_with("\"line\":8", "\"line\":4294967295"), "");
}

TEST(Shard, TakesNoTimeThatNothingTakes) {
    for (const char* key :
         {"\"seconds\": 6.5", "\"seconds\":0.25", "\"cycle_time\":3.5", "\"removed\":4.5",
          "\"lower\":1.5", "\"upper\":1.75", "\"allowance\":2.0", "\"shortfall\":0.5"}) {
        const std::string before = std::string(key).substr(0, std::string(key).rfind(':') + 1);
        for (const char* other : {"1e999", "true", "\"1\"", "[]"})
            EXPECT_NE(why_not_with(key, before + other), "") << key << " " << other;
        EXPECT_EQ(why_not_with(key, before + "4"), "") << key;
    }
    for (const char* key : {"\"seconds\": ", "\"seconds\":", "\"cycle_time\":"})
        EXPECT_NE(why_not_with(key, key + std::string("-")), "") << key;
    EXPECT_NE(why_not_with("\"seconds\": 6.5", "\"seconds\": 1e308"), "");
}

TEST(Shard, IsRefusedWhereItIsNestedTooDeep) {
    const std::string deep = std::string(300'000, '[') + std::string(300'000, ']');
    const std::string why = "is not a shard of a batch: nested too deeply";
    EXPECT_EQ(why_not_with("[1, 1]", deep), why);
    EXPECT_EQ(why_not_with("\"results\": [", "\"results\": [" + deep + ","), why);
    EXPECT_EQ(
        app::shard_from_json(app::sealed(unsealed_share() + ",\"x\": " + deep)).error().message,
        why);
    EXPECT_FALSE(app::result_from_json(deep));
    // Brackets inside a string do not count, even after an escaped quotation mark.
    EXPECT_EQ(why_not_with("rapids run", "\\\"" + deep.substr(0, 300) + "\\\\"), "");
}

TEST(Shard, IsRefusedIfItsNumberIsInvalid) {
    std::string other = unsealed_share();
    other.replace(other.find("[1, 1]"), 6, "[5, 3]");
    EXPECT_THAT(app::shard_from_json(app::sealed(other)).error().message,
                testing::StartsWith("'5/3' is not a shard"));
}

} // namespace
