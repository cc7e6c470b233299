#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "app/library/result/batch_result.h"
#include "app/report/html/html_batch.h"
#include "app/report/text/batch_text.h"
#include "tests/support/large_batch.h"
#include "tests/support/page_data.h"

namespace app {
namespace {

using core::Severity;
using nlohmann::json;
using test_support::count_of;
using test_support::large_batch;
using test_support::one_of_many;
using test_support::summed;
using test_support::unpacked;
using testing::HasSubstr;
using testing::Not;

TEST(Outcome, GoesByWhatEndedTheProgramBeforeItsVerdict) {
    ProgramResult program{.verdict = core::Verdict::clear, .blocks = 3};
    EXPECT_EQ(outcome_of(program), Outcome::no_error) << "nothing is known of its coverage";
    program.coverage = Coverage{.stock = Known::described,
                                .fixtures = Known::described,
                                .offsets = Known::described,
                                .limits = Known::described,
                                .moves = true};
    EXPECT_EQ(outcome_of(program), Outcome::clear);
    program.coverage->fixtures = Known::missing;
    EXPECT_EQ(outcome_of(program), Outcome::no_error);
    program.coverage->moves = false;
    EXPECT_EQ(outcome_of(program), Outcome::no_motion);
    program.findings = {{{.rule = "no-feed", .severity = Severity::error}}};
    EXPECT_EQ(outcome_of(program), Outcome::no_motion) << "before errors";
    program.coverage->moves = true;
    EXPECT_EQ(outcome_of(program), Outcome::errors);
    program.verdict = core::Verdict::collision;
    EXPECT_EQ(outcome_of(program), Outcome::collision);
    program.error = StoredError{.message = "no such code"};
    EXPECT_EQ(outcome_of(program), Outcome::stopped);
    program.blocks = 0;
    EXPECT_EQ(outcome_of(program), Outcome::not_run);
    for (const Outcome outcome : all_outcomes) EXPECT_STRNE(name_of(outcome), "");
}

TEST(RuleTally, CountsProgramsAndFindingsErrorsFirst) {
    BatchResult batch;
    batch.programs = {{.findings = {{{.rule = "b", .severity = Severity::note}},
                                    {{.rule = "z", .severity = Severity::error}}}},
                      {.findings = {{{.rule = "b", .severity = Severity::note}},
                                    {{.rule = "b", .severity = Severity::note}},
                                    {{.rule = "b", .severity = Severity::error}}}}};
    EXPECT_EQ(rule_tallies(batch), (std::vector<RuleTally>{{Severity::error, "b", 1, 1},
                                                           {Severity::error, "z", 1, 1},
                                                           {Severity::note, "b", 2, 3}}));
}

TEST(SkippedGroups, HaveTheReasonOfMostFilesFirst) {
    const auto groups = skipped_groups({{"a", "is empty"}, {"b", "is a mesh"}, {"c", "is a mesh"}});
    ASSERT_EQ(groups.size(), 2U);
    EXPECT_EQ(groups[0].why, "is a mesh");
    EXPECT_EQ(groups[0].files, (std::vector<std::string>{"b", "c"}));
    EXPECT_EQ(groups[1].files, (std::vector<std::string>{"a"}));
}

TEST(HtmlBatchColumns, AgreeWithTheResults) {
    BatchResult batch = large_batch(60, 4);
    batch.unchecked = {"parts/late.nc"};
    const json data = json::parse(batch_columns_json(batch));
    ASSERT_EQ(data["count"], 61);
    EXPECT_EQ(data["folder"], "parts/");
    const auto outcomes = unpacked(data["outcome"]), setups = unpacked(data["setup"]);
    const auto pairs = unpacked(data["pair"]);
    const json& texts = data["texts"];
    for (size_t i = 0; i < 60; ++i) {
        const ProgramResult& program = batch.programs[i];
        EXPECT_EQ(data["path"][i], program.program);
        EXPECT_EQ(data["sha256"][i], program.sha256);
        EXPECT_EQ(outcomes[i], static_cast<int64_t>(outcome_of(program)));
        EXPECT_EQ(texts[static_cast<size_t>(setups[i])], program.setup);
        EXPECT_EQ(texts[static_cast<size_t>(pairs[i])], "holder / clamp-1");
        EXPECT_EQ(data["blocks"][i], program.blocks);
        EXPECT_EQ(data["keep"][i], 2000);
        EXPECT_EQ(data["width"][i], -1);
        EXPECT_NEAR(data["lower"][i].get<double>(), 1e3 * program.tightest->lower, 1.0);
        EXPECT_LE(data["lower"][i].get<double>(), 1e3 * program.tightest->lower + 0.002);
        EXPECT_NEAR(data["cycle"][i].get<double>(), 1e3 * program.cycle_time, 0.5);
    }
    EXPECT_EQ(outcomes[60], static_cast<int64_t>(Outcome::unchecked));
    EXPECT_EQ(pairs[60], -1);
    EXPECT_EQ(data["errors"].size(), 2U);
    EXPECT_EQ(texts[data["errors"][1][4].get<size_t>()], "G999: no such code");
}

TEST(HtmlBatchColumns, RoundClearancesDownAndMinimumClearancesUp) {
    BatchResult batch = large_batch(3, 0);
    batch.programs[0].tightest =
        Tightest{.block = 11, .line = 23, .lower = 1.0006, .upper = 2.0004, .allowance = 2.0002};
    batch.programs[1].tightest =
        Tightest{.block = 12, .line = 24, .lower = -2e-6, .upper = 0.0, .allowance = 0.0};
    batch.programs[2].tightest.reset();
    batch.programs[2].removed = 812.4;
    const json data = json::parse(batch_columns_json(batch));
    EXPECT_EQ(data["lower"], json({1000, 0, -1}));
    EXPECT_EQ(data["width"], json({1001, 0, -1}));
    EXPECT_EQ(data["keep"], json({2001, 0, 0}));
    EXPECT_EQ(data["block"], json({11, 12, 0}));
    EXPECT_EQ(data["line"], json({23, 24, 0}));
    EXPECT_EQ(data["removed"], json({0, 11, 812}));
}

TEST(HtmlBatchColumns, RoundWhatIsMissingUp) {
    BatchResult batch = large_batch(1, 2);
    batch.programs[0].findings[0].shortfall = 0.5004;
    batch.programs[0].findings[1].shortfall = 1.25;
    const json data = json::parse(batch_columns_json(batch));
    auto missing = unpacked(data["findings"]["shortfall"]);
    std::sort(missing.begin(), missing.end());
    EXPECT_EQ(missing, (std::vector<int64_t>{501, 1250}));
}

TEST(HtmlBatchColumns, HoldEveryFindingTheWorstFirst) {
    const BatchResult batch = large_batch(20, 7);
    const json data = json::parse(batch_columns_json(batch)), &found = data["findings"];
    const auto counts = unpacked(found["count"]), severities = unpacked(found["severity"]);
    const auto lines = summed(unpacked(found["line"])), texts = summed(unpacked(found["text"]));
    const auto messages = unpacked(found["message"]);
    size_t at = 0;
    for (size_t i = 0; i < batch.programs.size(); ++i) {
        auto findings = batch.programs[i].findings;
        ASSERT_EQ(counts[i], static_cast<int64_t>(findings.size()));
        std::stable_sort(findings.begin(), findings.end(),
                         [](const auto& a, const auto& b) { return a.severity > b.severity; });
        for (const StoredFinding& finding : findings) {
            EXPECT_EQ(severities[at], static_cast<int64_t>(finding.severity));
            EXPECT_EQ(lines[at], finding.line);
            EXPECT_EQ(data["texts"][static_cast<size_t>(texts[at])], finding.text);
            EXPECT_EQ(data["texts"][static_cast<size_t>(messages[at])], finding.message);
            ++at;
        }
    }
}

TEST(HtmlBatchColumns, CountAllFindingsWhereThereAreTooMany) {
    const BatchResult batch = large_batch(3, 2500);
    const json data = json::parse(batch_columns_json(batch)), &found = data["findings"];
    EXPECT_EQ(unpacked(found["count"]), (std::vector<int64_t>{1000, 1000, 1000}));
    EXPECT_EQ(unpacked(found["severity"])[0], 3) << "the worst ones remain";
    int64_t all = 0;
    for (size_t k = 2; k < found["tally"].size(); k += 3) all += found["tally"][k].get<int64_t>();
    EXPECT_EQ(all, 3 * 2500);
}

TEST(HtmlBatch, SaysFirstWhatIsMissing) {
    BatchResult batch = large_batch(3, 1);
    batch.unchecked = {"parts/order 9/late.nc"};
    EXPECT_EQ(batch_outcome_text(batch), "2 of 4 programs not checked to the end");
    const std::string page = batch_html_report(batch);
    const size_t missing = page.find("class=\"missing\""), tiles = page.find("class=\"tiles\"");
    ASSERT_NE(missing, page.npos);
    EXPECT_LT(missing, tiles);
    EXPECT_THAT(page, HasSubstr("<b>1 of 4 programs not checked:</b>"));
    EXPECT_THAT(page, HasSubstr("<li>order 9/late.nc</li>"));
    EXPECT_THAT(page, HasSubstr("order 0/part 0.nc: G999: no such code"));
}

TEST(HtmlBatch, SaysNothingOfMissingOnesWhereAllAreThere) {
    BatchResult batch;
    batch.programs = {one_of_many(4, 0)};
    EXPECT_EQ(batch_outcome_text(batch), "1 program: all clear");
    EXPECT_STREQ(batch_outcome_class(batch), "clear");
    EXPECT_THAT(batch_html_report(batch), Not(HasSubstr("class=\"missing\"")));
    batch.programs.push_back(one_of_many(5, 0)); // undecided
    EXPECT_STREQ(batch_outcome_class(batch), "undecided");
    batch.programs[0].findings = {{{.rule = "no-feed", .severity = Severity::error}}};
    EXPECT_EQ(batch_outcome_text(batch), "1 of 2 programs has errors");
    EXPECT_STREQ(batch_outcome_class(batch), "error");
    batch.programs[0] = one_of_many(50, 0); // stopped
    EXPECT_STREQ(batch_outcome_class(batch), "error");
}

TEST(HtmlBatch, DoesNotCallNothingClear) {
    EXPECT_EQ(batch_outcome_text({}), "no program was checked");
    EXPECT_STREQ(batch_outcome_class({}), "undecided");
    EXPECT_THAT(batch_html_report({}), HasSubstr("0 programs"));
}

TEST(HtmlBatch, NamesTheProgramWithTheLeastMargin) {
    BatchResult batch = large_batch(9, 0);
    batch.programs[7].tightest->lower = 0.9;
    batch.programs[7].tightest->allowance = 5.0; // short by 4.1 mm, more than any other
    EXPECT_THAT(html_batch_summary(batch),
                HasSubstr("data-program=\"7\">order 7/part 7.nc, line 5</button>"));
}

TEST(HtmlBatch, ShowsNoMarginLargerThanItIs) {
    BatchResult batch = large_batch(1, 0);
    Tightest& tightest = *batch.programs[0].tightest;
    tightest.lower = 1.9996;
    EXPECT_THAT(html_batch_summary(batch),
                HasSubstr("least margin</th><td>\xE2\x89\xA5 -0.001 mm: "
                          "clearance at least 1.999 mm (minimum 2.000 mm)"));
    tightest.upper = 2.0024;
    EXPECT_THAT(html_batch_summary(batch),
                HasSubstr("<td>-0.001 mm: clearance 1.999 to 2.003 mm (minimum 2.000 mm)"));
    tightest = {.lower = -0.0000011, .upper = 0.0};
    EXPECT_THAT(html_batch_summary(batch), HasSubstr("except permitted contact"));
    batch.programs[0].verdict = core::Verdict::undecided;
    EXPECT_THAT(html_batch_summary(batch),
                HasSubstr("<td>0.000 mm: clearance 0.000 mm (minimum 0.000 mm)"));
}

TEST(HtmlBatch, CountsSkippedFilesByTheirReason) {
    BatchResult batch = large_batch(1, 0);
    for (size_t i = 0; i < 100'000; ++i)
        batch.skipped.push_back({fmt::format("notes <{}>.txt", i), "is a document"});
    const std::string html = html_skipped(batch);
    EXPECT_THAT(html, HasSubstr("100000 files: is a document"));
    EXPECT_THAT(html, HasSubstr("notes &lt;7&gt;.txt"));
    EXPECT_THAT(html, HasSubstr("and 99800 more"));
    EXPECT_LT(html.size(), 20'000U);
}

TEST(HtmlBatch, HoldsNamesAndTextsAsTextOnly) {
    const BatchResult plain = large_batch(2, 2);
    BatchResult batch = plain;
    const std::string evil = "</script><script>alert(1)</script><img src=x onerror='a'>\"{{rules}}"
                             "\xFF\xC3\xA4\x01\xE2\x82";
    batch.programs[0].program = evil;
    batch.programs[0].setup = evil;
    batch.programs[0].dialect = evil;
    batch.programs[0].error = StoredError{evil, 1, 1, evil};
    batch.programs[1].findings[0] = {
        {.rule = evil, .message = evil, .cure = evil, .pair = {evil, evil}}, 0, "", evil};
    batch.programs[1].assumptions = {evil};
    batch.programs[1].tightest->pair = {evil, evil};
    batch.unchecked = {evil};
    batch.skipped = {{evil, evil}};
    const std::string page = batch_html_report(batch), before = batch_html_report(plain);
    for (const char* tag : {"<script", "</script", "<img", "<!--"})
        EXPECT_EQ(count_of(page, tag), count_of(before, tag)) << tag;
    EXPECT_THAT(page, HasSubstr("&lt;/script&gt;&lt;script&gt;alert(1)"));
    const size_t begin = page.find("id=\"batch-data\">") + 16;
    const json data = json::parse(page.substr(begin, page.find("</script>", begin) - begin));
    EXPECT_THAT(data["path"][0].get<std::string>(), HasSubstr("</script><script>alert(1)"));
}

TEST(HtmlBatch, LoadsNothingFromOutside) {
    const std::string page = batch_html_report(large_batch(2, 1));
    EXPECT_THAT(page, HasSubstr("default-src 'none'"));
    for (const char* way : {"src=\"http", "href=\"http", "@import", "fetch("})
        EXPECT_THAT(page, Not(HasSubstr(way)));
}

TEST(HtmlBatch, StaysSmallForTenThousandPrograms) {
    for (const size_t findings : {8, 100}) {
        const std::string page = batch_html_report(large_batch(10'000, findings));
        EXPECT_LT(page.size(), 20'000'000U) << findings;
        RecordProperty(fmt::format("bytes-{}", findings), static_cast<int>(page.size()));
    }
}

} // namespace
} // namespace app
