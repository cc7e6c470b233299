#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/library/result/batch_result.h"
#include "app/report/html/html_page.h"
#include "app/report/html/html_report.h"
#include "app/report/html/html_text.h"
#include "tests/support/lengthened_run.h"
#include "tests/support/page_data.h"

namespace app {
namespace {

using nlohmann::json;
using test_support::count_of;
using test_support::lengthened;
using test_support::summed;
using test_support::unpacked;
using testing::HasSubstr;
using testing::Not;

const std::string folder = std::string(FEELER_SOURCE_DIR) + "/assets/";

CheckRun clamped_plate() {
    return *run_check({.program = folder + "programs/clamped_plate_low.nc",
                       .setup = folder + "setups/clamped_plate.toml",
                       .detail = core::Detail::deciding_pair});
}

std::string every_byte() {
    std::string text;
    for (int byte = 0; byte < 256; ++byte) text += static_cast<char>(byte);
    return text;
}

/// The data of a page refers to enumerators by their index.
TEST(HtmlPage, NamesEnumeratorsInTheirOrder) {
    const auto are_in_order = [](const auto& all) {
        for (size_t i = 0; i < all.size(); ++i) EXPECT_EQ(static_cast<size_t>(all[i]), i);
    };
    are_in_order(core::all_severities);
    are_in_order(core::all_verdicts);
    are_in_order(core::all_block_motions);
    are_in_order(all_outcomes);
    EXPECT_EQ(script_names("verdicts", core::all_verdicts),
              "const verdicts=[\"clear\",\"undecided\",\"violation\",\"collision\"];\n");
}

TEST(HtmlText, LeavesNothingThatABrowserReadsAsMoreThanText) {
    const std::string safe = html_text("<b title='x' id=\"y\">" + every_byte() + "&amp;");
    EXPECT_EQ(safe.find_first_of("<>\"'"), safe.npos);
    EXPECT_THAT(safe, HasSubstr("&amp;amp;"));
    EXPECT_EQ(safe.find('\n'), safe.npos);
    EXPECT_EQ(safe.find('\0'), safe.npos);
}

TEST(HtmlText, KeepsNumbersThatAPageHoldsExactly) {
    constexpr int64_t most = (int64_t{1} << 53) - 1;
    EXPECT_EQ(steps_of(2.5, 1e-4), 25'000);
    EXPECT_EQ(steps_of(1e40, 1e-4), most);
    EXPECT_EQ(steps_of(core::infinity, 0.01), most);
    EXPECT_EQ(steps_of(std::nan(""), 1.0), 0);
    EXPECT_EQ(um_above(1e300), most);
    EXPECT_EQ(um_below(-1e40), -most);
    EXPECT_EQ(clearance_um(-1e40), 0);
}

TEST(HtmlReport, LetsNoTimeAndNoVolumeOverflow) {
    CheckRun run = clamped_plate();
    double time = 1.0;
    run.blocks.change_all([&](CheckedBlock& block) {
        block.result.time = time *= 1e4;
        block.result.removed = time;
    });
    run.cycle_time = time;
    const json data = json::parse(blocks_json(run));
    for (const char* column : {"time", "removed"})
        for (const int64_t step : data[column]) EXPECT_GE(step, 0) << column;
    EXPECT_GE(data["end"].get<int64_t>(), summed(data["time"].get<std::vector<int64_t>>()).back());
}

TEST(ScriptString, ComesBackAsTheSameTextAndEndsNoScript) {
    const std::string text = "</script><!-- \"\\ \x01 \xC3\xA4 ]]> & \t";
    const std::string written = script_string(text);
    EXPECT_EQ(json::parse(written).get<std::string>(), text);
    EXPECT_EQ(written.find_first_of("<>&"), written.npos);
}

TEST(ScriptString, TakesAnyBytes) {
    const std::string read = json::parse(script_string(every_byte())).get<std::string>();
    EXPECT_EQ(read.substr(0, 128), every_byte().substr(0, 128));
    EXPECT_GT(read.size(), 256U); // invalid UTF-8 was read as Latin-1
}

TEST(Base64, WritesWhatRfc4648Says) {
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foo"), "Zm9v");
    EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64("\xFF\xFE\xFD"), "//79");
}

TEST(NumberRuns, HoldEachRunOnce) {
    NumberRuns runs;
    DeltaRuns steps;
    for (const int64_t value : {7, 7, 7, -1, 3}) runs.add(value);
    for (const int64_t value : {5, 6, 7, 8, 20}) steps.add(value);
    EXPECT_EQ(runs.json(), "[7,3,-1,1,3,1]");
    EXPECT_EQ(steps.json(), "[5,1,1,3,12,1]");
    EXPECT_EQ(summed(unpacked(json::parse(steps.json()))), (std::vector<int64_t>{5, 6, 7, 8, 20}));
    EXPECT_EQ(NumberRuns().json(), "[]");
}

TEST(HtmlBlocks, AgreeWithTheRun) {
    const CheckRun run = clamped_plate();
    const json data = json::parse(blocks_json(run));
    ASSERT_EQ(data["count"], run.blocks.size());
    const auto lines = summed(unpacked(data["line"])), texts = summed(unpacked(data["text"]));
    const auto verdicts = unpacked(data["verdict"]), pairs = unpacked(data["pair"]);
    const auto times = summed(data["time"].get<std::vector<int64_t>>());
    size_t measured = 0;
    for (size_t i = 0; i < run.blocks.size(); ++i) {
        const CheckedBlock& block = run.blocks[i];
        EXPECT_EQ(lines[i], block.line);
        EXPECT_EQ(verdicts[i], static_cast<int64_t>(block.result.verdict));
        EXPECT_NEAR(static_cast<double>(times[i]) * 1e-4, block.result.time, 0.6e-4);
        EXPECT_THAT(block.text,
                    HasSubstr(data["texts"][static_cast<size_t>(texts[i])].get<std::string>()));
        if (!block.result.deciding) continue;
        const core::PairClearance& pair = block.result.pairs[*block.result.deciding];
        const double lower = 1e-3 * data["lower"][i].get<double>(),
                     width = 1e-3 * data["width"][i].get<double>();
        EXPECT_EQ(data["pairs"][static_cast<size_t>(pairs[i])][1],
                  core::body_name(run.setup, pair.pair));
        EXPECT_LE(lower, pair.lower + core::resolution);
        EXPECT_GT(lower, pair.lower - 0.0011);
        if (!pair.found()) continue;
        EXPECT_GE(lower + width, pair.upper - 1.5 * core::resolution);
        EXPECT_LT(lower + width, pair.upper + 0.0021);
        ++measured;
    }
    EXPECT_GT(measured, 20U);
    EXPECT_EQ(data["found"].size(), 4U);
}

/// The index of the first block with a deciding pair.
size_t first_with_pair(const CheckRun& run) {
    size_t i = 0;
    while (!run.blocks[i].result.deciding) ++i;
    return i;
}

TEST(HtmlBlocks, RoundClearancesDownAndUpperBoundsUp) {
    CheckRun run = clamped_plate();
    const size_t at = first_with_pair(run);
    const auto bounds = [&](double lower, double upper) {
        run.blocks.change(at, [&](CheckedBlock& block) {
            core::PairClearance& pair = block.result.pairs[*block.result.deciding];
            pair.lower = lower;
            pair.upper = upper;
        });
        const json data = json::parse(blocks_json(run));
        return std::pair(data["lower"][at].get<int64_t>(), data["width"][at].get<int64_t>());
    };
    EXPECT_EQ(bounds(1.0006, 2.0004), std::pair(int64_t{1000}, int64_t{1001}));
    EXPECT_EQ(bounds(1.9996, 1.9996), std::pair(int64_t{1999}, int64_t{1}));
    EXPECT_EQ(bounds(-2e-6, 0.0), std::pair(int64_t{0}, int64_t{0})) << "-1 means unknown";
}

TEST(HtmlReport, ShowsNoLowerBoundLargerThanItIs) {
    CheckRun run = clamped_plate();
    run.findings.clear();
    const auto nearest = tightest_block(run);
    ASSERT_TRUE(nearest);
    const double keep = nearest->result.pairs[*nearest->result.deciding].allowance.distance;
    run.blocks.change_all([&](CheckedBlock& block) {
        if (block.block != nearest->block) return block.result.deciding.reset();
        core::PairClearance& pair = block.result.pairs[*block.result.deciding];
        pair.lower = keep - 0.0004;
        pair.upper = keep + 0.0003;
    });
    const std::string shown =
        fmt::format("{:.3f} to {:.3f} mm (minimum {:.3f} mm)", keep - 0.001, keep + 0.001, keep);
    EXPECT_EQ(count_of(html_report(run, {}), shown), 2U) << "in the summary and in the card";
}

TEST(HtmlBlocks, AddUpToWhatWasRemoved) {
    const CheckRun run = clamped_plate();
    const json data = json::parse(blocks_json(run));
    double sum = 0.0;
    for (const json& steps : data["removed"]) sum += 0.01 * steps.get<double>();
    EXPECT_NEAR(sum, run.removed, 0.006);
}

TEST(HtmlReport, ShowsTheTightestBlockWhereNothingWasFound) {
    const CheckRun run = *run_check({.program = folder + "programs/clamped_plate.nc",
                                     .setup = folder + "setups/clamped_plate.toml",
                                     .detail = core::Detail::deciding_pair});
    ASSERT_TRUE(run.findings.empty());
    const std::string page = html_report(run, {});
    EXPECT_THAT(page, HasSubstr("No findings."));
    EXPECT_EQ(count_of(page, "<article"), 1U);
    EXPECT_THAT(page, HasSubstr(fmt::format("data-block=\"{}\"",
                                            core::value_of(tightest_block(run)->block))));
}

/// The text and the chip of a finding give one depth.
TEST(HtmlReport, RoundsTheDepthOfAnOverlapAlikeEverywhere) {
    EXPECT_EQ(core::depth_text({.least = 1.9996, .most = 2.0003}), "1.99 to 2.01");
    EXPECT_EQ(core::depth_text({.least = 2.0, .most = 2.0003}), "2.00");
    EXPECT_EQ(core::depth_number({.least = 2.0, .most = 2.0003}), "2.00");
    EXPECT_EQ(core::depth_number({.least = 1.9612, .most = 2.0012}), "2.01");
    EXPECT_EQ(core::depth_text({.least = 3.1999}), "at least 3.19");
    EXPECT_EQ(core::depth_text({.least = 0.0, .most = 0.004}), "up to 0.01");
    CheckRun run = clamped_plate();
    for (core::Finding& finding : run.findings) {
        if (!finding.overlap) continue;
        finding.overlap = core::Overlap{2.0, 2.0003, {0.0, 0.0, 1.0}};
        finding.message = core::overlap_text(*finding.overlap);
    }
    const std::string page = html_report(run, {});
    EXPECT_THAT(page, HasSubstr("2.00 mm deep"));
    EXPECT_THAT(page, Not(HasSubstr("2.01 mm deep")));
}

TEST(HtmlReport, HoldsWhatAProgramSaysAsTextOnly) {
    CheckRun run = clamped_plate();
    const std::string plain = html_report(run, {});
    const std::string evil =
        "</script><script>alert(1)</script><img src=x onerror=alert(2)>{{cards}}";
    run.program_file = evil;
    run.blocks.change(0, [&](CheckedBlock& block) { block.text = evil; });
    run.blocks.change(38, [&](CheckedBlock& block) { block.text = evil + every_byte(); });
    run.findings.front().message = evil;
    run.findings.front().cure = evil;
    run.assumptions.push_back(evil);
    const std::string page = html_report(run, {});
    EXPECT_EQ(count_of(page, "<script"), count_of(plain, "<script"));
    EXPECT_EQ(count_of(page, "</script"), count_of(plain, "</script"));
    EXPECT_EQ(count_of(page, "<img"), count_of(plain, "<img"));
    EXPECT_EQ(count_of(page, "<article"), count_of(plain, "<article"));
    EXPECT_THAT(page, HasSubstr("&lt;/script&gt;&lt;script&gt;alert(1)"));
}

TEST(HtmlReport, LoadsNothingFromOutside) {
    const std::string page = html_report(clamped_plate(), {});
    EXPECT_THAT(page, HasSubstr("default-src 'none'"));
    EXPECT_THAT(page, Not(HasSubstr("src=\"http")));
    EXPECT_THAT(page, Not(HasSubstr("href=\"http")));
    EXPECT_THAT(page, Not(HasSubstr("@import")));
}

TEST(HtmlReport, SaysWhyThereAreNoPictures) {
    const std::string page = html_report(clamped_plate(), {.no_pictures = "no OpenGL <here>"});
    EXPECT_THAT(page, HasSubstr("There are no pictures: no OpenGL &lt;here&gt;"));
}

TEST(HtmlReport, StaysSmallForAHundredThousandBlocks) {
    const std::string page = html_report(lengthened(clamped_plate(), 100'000), {});
    EXPECT_LT(page.size(), 10'000'000U);
    RecordProperty("bytes", static_cast<int>(page.size()));
}

} // namespace
} // namespace app
