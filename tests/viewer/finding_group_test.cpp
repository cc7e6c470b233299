#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "app/view/model/navigation.h"
#include "app/view/model/view_model.h"
#include "tests/viewer/rows.h"

namespace {

using namespace app::viewer;

core::Finding finding_in(uint32_t block, const char* rule, const char* body, double shortfall,
                         core::Severity severity = core::Severity::error) {
    core::Finding finding;
    finding.rule = rule;
    finding.severity = severity;
    finding.block = core::BlockIndex{block};
    finding.pair = {"holder", body};
    finding.shortfall = shortfall;
    finding.message = "in " + std::to_string(block);
    finding.cure = "cure of " + std::to_string(block);
    return finding;
}

/// Ten blocks near clamp-1, of which the fifth does not move.
std::vector<BlockRow> ten_rows() {
    std::vector<BlockRow> rows;
    for (int i = 0; i < 10; ++i) {
        rows.push_back(viewer_test::row_with(0.9 - 0.05 * i));
        rows.back().part = "holder";
        rows.back().body = "clamp-1";
    }
    rows[4].motion = core::BlockMotion::none;
    return rows;
}

TEST(FindingGroups, MergeBlocksThatFollowOneAnother) {
    const auto groups = grouped(ten_rows(), {finding_in(3, "near-miss", "clamp-1", 0.25),
                                             finding_in(2, "near-miss", "clamp-1", 0.2),
                                             finding_in(5, "near-miss", "clamp-1", 0.1),
                                             finding_in(8, "near-miss", "clamp-1", 0.5)});
    ASSERT_EQ(groups.size(), 1u);
    EXPECT_EQ(groups[0].count, 4u);
    ASSERT_EQ(groups[0].stretches.size(), 2u);
    const FindingStretch& first = groups[0].stretches[0];
    EXPECT_EQ(first.first, 2u);
    EXPECT_EQ(first.last, 5u) << "blocks without motion do not separate them";
    EXPECT_EQ(first.count, 3u);
    EXPECT_EQ(first.worst, 3u);
    EXPECT_DOUBLE_EQ(*first.clearance, 0.75);
    EXPECT_EQ(first.cure, "cure of 3");
    EXPECT_EQ(groups[0].worst, 1u);
}

TEST(FindingGroups, ComeWithTheWorstFirst) {
    core::Finding whole = finding_in(0, "no-stop", "", 0.0, core::Severity::note);
    whole.block.reset();
    const auto groups = grouped(
        ten_rows(),
        {whole, finding_in(1, "low-retract", "clamp-1", 9.0, core::Severity::warning),
         finding_in(2, "near-miss", "clamp-2", 0.1), finding_in(3, "near-miss", "clamp-1", 0.4),
         finding_in(4, "air-cut", "", 1.0, core::Severity::off)});
    ASSERT_EQ(groups.size(), 4u) << "rules that are off are not reported";
    EXPECT_EQ(groups[0].pair[1], "clamp-1");
    EXPECT_EQ(groups[1].pair[1], "clamp-2");
    EXPECT_FALSE(groups[1].stretches[0].clearance) << "the row is about another pair";
    EXPECT_EQ(groups[2].rule, "low-retract");
    EXPECT_TRUE(groups[3].stretches.empty());
    EXPECT_EQ(groups[3].message, "in 0");
}

TEST(FindingGroups, ThatAreAsBadComeInTheOrderOfTheProgram) {
    const auto groups = grouped(ten_rows(), {finding_in(6, "collision", "clamp-1", 0.5),
                                             finding_in(1, "near-miss", "clamp-1", 0.5),
                                             finding_in(3, "air-cut", "clamp-1", 0.5)});
    ASSERT_EQ(groups.size(), 3u);
    EXPECT_EQ(groups[0].rule, "near-miss");
    EXPECT_EQ(groups[1].rule, "air-cut");
    EXPECT_EQ(groups[2].rule, "collision");
}

TEST(FindingGroups, HaveOneGroupForARuleWithoutAPairWhateverItsMessages) {
    std::vector<core::Finding> findings(3);
    for (uint32_t i = 0; i < 3; ++i) {
        findings[i].rule = "over-travel";
        findings[i].block = core::BlockIndex(2 * i);
        findings[i].message = "X goes " + std::to_string(i) + " mm beyond its limit.";
    }
    const auto groups = grouped(ten_rows(), findings);
    ASSERT_EQ(groups.size(), 1u);
    EXPECT_EQ(groups[0].count, 3u);
}

TEST(FindingGroups, KeepEveryMessageOfFindingsAboutNoPair) {
    std::vector<core::Finding> findings(3);
    for (core::Finding& finding : findings) finding.rule = "gouge";
    findings[0].message = findings[2].message = "0.5 mm of the part is missing.";
    findings[1].message = "0.2 mm of the part is missing.";
    const auto groups = grouped(ten_rows(), findings);
    ASSERT_EQ(groups.size(), 2u);
    EXPECT_EQ(groups[0].message, findings[0].message);
    EXPECT_EQ(groups[1].message, findings[1].message);
}

TEST(FindingGroups, HoldEveryFindingOnce) {
    std::mt19937 random(7);
    for (int round = 0; round < 50; ++round) {
        std::vector<BlockRow> rows(200, viewer_test::row_with(0.5));
        for (BlockRow& row : rows)
            if (random() % 4 == 0) row.motion = core::BlockMotion::none;
        std::vector<core::Finding> findings;
        const char* bodies[] = {"a", "b", "c"};
        for (uint32_t block = 0; block < 200; ++block)
            for (const char* body : bodies)
                if (random() % 3 == 0)
                    findings.push_back(finding_in(block, random() % 2 ? "collision" : "near-miss",
                                                  body, static_cast<double>(random() % 100)));
        std::shuffle(findings.begin(), findings.end(), random);
        const auto groups = grouped(rows, findings);
        size_t count = 0, stretches = 0;
        for (const FindingGroup& group : groups) {
            size_t in_stretches = 0;
            for (size_t i = 0; i < group.stretches.size(); ++i) {
                const FindingStretch& stretch = group.stretches[i];
                in_stretches += stretch.count;
                EXPECT_TRUE(stretch.first <= stretch.worst && stretch.worst <= stretch.last);
                if (i == 0) continue;
                bool is_parted = false;
                for (size_t block = group.stretches[i - 1].last + 1; block < stretch.first; ++block)
                    is_parted = is_parted || moves(rows[block]);
                EXPECT_TRUE(is_parted);
            }
            EXPECT_EQ(in_stretches, group.count);
            count += group.count;
            stretches += group.stretches.size();
        }
        EXPECT_EQ(count, findings.size());
        size_t walked = 0;
        for (auto at = neighbouring_stretch(groups, {}, true); at;
             at = neighbouring_stretch(groups, at, true))
            ++walked;
        EXPECT_EQ(walked, stretches);
    }
}

TEST(FindingGroups, AreWalkedThroughAndFollowTheCursor) {
    ViewModel model = viewer_test::model_of(ten_rows());
    SessionUpdate news;
    news.opening = 1;
    news.findings = {finding_in(2, "near-miss", "clamp-1", 0.2),
                     finding_in(8, "near-miss", "clamp-1", 0.5),
                     finding_in(8, "collision", "clamp-1", 0.6)};
    news.has_news = news.is_recorded = true;
    take_in(model, std::move(news), 0.0);
    ASSERT_EQ(model.groups.size(), 2u);
    EXPECT_TRUE(step_stretch(model, true));
    EXPECT_EQ(model.cursor.block, 8u);
    EXPECT_TRUE(step_stretch(model, true));
    EXPECT_EQ(model.cursor.block, 2u);
    EXPECT_TRUE(step_stretch(model, true));
    EXPECT_EQ(model.cursor.block, 8u);
    EXPECT_EQ(selected_stretch(model)->group, 1u) << "the selected one, not the first of the block";
    EXPECT_FALSE(step_stretch(model, true));
    go_to(model, 2);
    EXPECT_EQ(*selected_stretch(model), (StretchIndex{1, 0}));
    go_to(model, 5);
    EXPECT_FALSE(selected_stretch(model));
}

} // namespace
