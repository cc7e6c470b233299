#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/view/model/row_filter.h"
#include "tests/viewer/rows.h"

namespace {

using app::viewer::BlockRow;
using app::viewer::RowFilter;
using testing::HasSubstr;

BlockRow rapid_with_t3() {
    BlockRow row = viewer_test::row_with(0.42);
    row.motion = core::BlockMotion::rapid;
    row.tool = core::ToolNumber{3};
    row.line = 188;
    row.text = "N1880 G0 X-34.635";
    row.part = "holder";
    row.body = "clamp-1";
    return row;
}

core::Finding near_miss(uint32_t block) {
    core::Finding finding;
    finding.rule = "near-miss";
    finding.severity = core::Severity::error;
    finding.block = core::BlockIndex{block};
    finding.pair = {"holder", "clamp-1"};
    return finding;
}

bool passes(const std::string& text, const BlockRow& row) {
    return !RowFilter(text).passed({row}, {near_miss(0)}).empty();
}

TEST(RowFilter, HasTheLanguageOfBreakpoints) {
    const BlockRow row = rapid_with_t3();
    for (const char* text :
         {"T3", "clearance < 1 and rapid", "clearance = 0.42", "allowance = 1", "margin < -0.5",
          "violation", "error", "near-miss", "rule = near-miss", "rule != air-cut", "\"CLAMP-1\"",
          "line = 188", "N1880", "~ \"x-34\"", "not (feed or arc)", "duration = 1 and block = 0"})
        EXPECT_TRUE(passes(text, row)) << text;
    for (const char* text :
         {"T33", "feed", "clearance > 1", "near", "clear", "T3 and feed", "\"clamp-2\"", "warning",
          "rule = air-cut", "rule != near-miss", "~ \"g81\"", "line > 188"})
        EXPECT_FALSE(passes(text, row)) << text << " " << RowFilter(text).refusal();
}

TEST(RowFilter, LooksForOtherWordsInTheLine) {
    const BlockRow row = rapid_with_t3();
    for (const char* text : {"x-34", "G0 X-34", " g0 ", "N1880 G0"}) {
        EXPECT_TRUE(passes(text, row)) << text;
        EXPECT_FALSE(RowFilter(text).wanted_text().empty()) << text;
    }
    for (const char* text : {"g81", "holder", "X-34 G0", "(ROUGH"})
        EXPECT_FALSE(passes(text, row)) << text;
    EXPECT_TRUE(RowFilter("T3").wanted_text().empty());
}

TEST(RowFilter, ReportsMistakesInACondition) {
    for (const auto& [text, why] : {std::pair{"clearance <", "ends too early"},
                                    {"clearence < 1", "'clearance'"},
                                    {"T3 rapid", "'and' or 'or' is missing"},
                                    {"rapid and", "ends too early"},
                                    {"rule = neer-miss", "near-miss"},
                                    {"verdict = fine", "it may be"}}) {
        const RowFilter filter(text);
        EXPECT_THAT(filter.refusal(), HasSubstr(why)) << text;
        EXPECT_TRUE(filter.empty()) << text << " hides nothing";
    }
    EXPECT_THAT(RowFilter("rapid and clearence < 1").refusal(), HasSubstr("Column 11"));
}

TEST(RowFilter, ReportsValuesThatOnlyTheControlHas) {
    for (const auto& [text, name] :
         {std::pair{"rapid and plane = ZX", "plane"}, {"#100 > 5", "#100"}, {"x < 5", "x"}}) {
        const RowFilter filter(text);
        EXPECT_THAT(filter.refusal(), HasSubstr(std::string("The list cannot filter by ") + name));
        EXPECT_TRUE(filter.empty());
    }
}

TEST(RowFilter, KnowsNothingOfUncheckedBlocks) {
    BlockRow row;
    row.motion = core::BlockMotion::feed;
    for (const char* text : {"clearance < 1000", "clearance > 1", "clear", "verdict = clear",
                             "verdict != clear", "near"})
        EXPECT_TRUE(RowFilter(text).passed({row}, {}).empty()) << text;
    EXPECT_FALSE(RowFilter("feed").passed({row}, {}).empty());
}

TEST(RowFilter, NearIsWhatTheHeadCounts) {
    const std::vector<BlockRow> rows = {viewer_test::row_with(0.5), viewer_test::row_with(1.0),
                                        viewer_test::row_with(1.9), viewer_test::row_with(2.0)};
    EXPECT_EQ(RowFilter("near").passed(rows, {}), (std::vector<size_t>{1, 2}));
    EXPECT_EQ(RowFilter("near").passed(rows, {near_miss(1)}), (std::vector<size_t>{2}));
}

} // namespace
