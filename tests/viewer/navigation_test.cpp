#include <gtest/gtest.h>

#include "app/check/setup_sheet.h"
#include "app/view/model/navigation.h"
#include "app/view/model/scene_of.h"
#include "app/view/model/view_model.h"
#include "tests/viewer/rows.h"

namespace {

using namespace app::viewer;
using viewer_test::model_of;
using viewer_test::row_with;

ViewModel ten_blocks() {
    std::vector<BlockRow> rows(10, row_with(5.0));
    rows[3] = row_with(0.5);
    rows[3].witness_time = 0.25;
    rows[7] = row_with(0.2);
    for (size_t i = 5; i < 10; ++i) rows[i].tool = core::ToolNumber{2};
    return model_of(rows);
}

TEST(BlockRow, WhatCouldNotBeDecidedIsHighlightedLikeAViolation) {
    BlockRow row = row_with(1.5);
    EXPECT_FALSE(is_offending(row));
    EXPECT_EQ(state_of(row), render::ClearanceState::near);
    row.verdict = core::Verdict::undecided;
    EXPECT_TRUE(is_offending(row));
    EXPECT_EQ(state_of(row), render::ClearanceState::violation);
}

TEST(BlockRow, IsAsBadAsTheFindingsThatAreLeftAboutIt) {
    ViewModel model = model_of({row_with(5.0), row_with(5.0)});
    const auto take = [&](std::vector<core::Finding> findings) {
        SessionUpdate news;
        news.opening = 1;
        news.has_news = news.is_recorded = true;
        news.findings = std::move(findings);
        take_in(model, std::move(news), 0.0);
    };
    core::Finding finding;
    finding.block = core::BlockIndex{1};
    finding.severity = core::Severity::error;
    take({finding});
    EXPECT_EQ(model.offending, std::vector<size_t>{1});
    take({});
    EXPECT_TRUE(model.offending.empty()) << "a comment in the program allows it";
}

TEST(Navigation, StepsStayInTheProgram) {
    ViewModel model = ten_blocks();
    step(model, -1);
    EXPECT_EQ(model.cursor, (Cursor{0, 1.0}));
    step(model, 4);
    EXPECT_EQ(model.cursor.block, 4U);
    step(model, 100);
    EXPECT_EQ(model.cursor.block, 9U);
    ASSERT_TRUE(model.wanted.has_value());
    EXPECT_EQ(model.wanted->block, 9U);
}

TEST(Navigation, AStepInTheMiddleOfABlockGoesToItsEnd) {
    ViewModel model = ten_blocks();
    go_to(model, 4, 0.5);
    step(model, 1);
    EXPECT_EQ(model.cursor, (Cursor{4, 1.0}));
    step(model, 1);
    EXPECT_EQ(model.cursor, (Cursor{5, 1.0}));
}

TEST(Navigation, ViolationsAreVisitedAtTheirClosestMomentAndRoundAgain) {
    ViewModel model = ten_blocks();
    EXPECT_TRUE(go_to_offending(model, true));
    EXPECT_EQ(model.cursor, (Cursor{3, 0.25}));
    EXPECT_FALSE(model.wanted->at_end);
    EXPECT_TRUE(go_to_offending(model, true));
    EXPECT_EQ(model.cursor.block, 7U);
    EXPECT_TRUE(go_to_offending(model, true));
    EXPECT_EQ(model.cursor.block, 3U);
    EXPECT_TRUE(go_to_offending(model, false));
    EXPECT_EQ(model.cursor.block, 7U);
}

/// A block in which two pairs collide at different times.
ViewModel two_collisions() {
    BlockRow row = row_with(0.0);
    row.verdict = core::Verdict::collision;
    row.part = "flutes";
    row.body = "jaw";
    row.witness_time = 0.2;
    row.others = {{.names = {"holder", "jaw"},
                   .on_tool = core::Vec3(1.0),
                   .on_body = core::Vec3(2.0),
                   .time = 0.75,
                   .verdict = core::Verdict::collision}};
    return model_of({row_with(5.0), row, row_with(5.0)});
}

TEST(Navigation, AFindingIsShownWhenItsOwnBodiesCollide) {
    ViewModel model = two_collisions();
    go_to_witness(model, 1, {"holder", "jaw"});
    EXPECT_EQ(model.cursor, (Cursor{1, 0.75}));
    const auto witness = witness_of(model);
    ASSERT_TRUE(witness);
    EXPECT_EQ(witness->b, core::Vec3(2.0));
    go_to_witness(model, 1, {"flutes", "jaw"});
    EXPECT_EQ(model.cursor, (Cursor{1, 0.2}));
    go_to_witness(model, 1);
    EXPECT_EQ(model.cursor, (Cursor{1, 0.2})) << "the deciding pair";
    go_to_witness(model, 1, {"holder", "jaw"});
    step(model, 1);
    step(model, 1);
    EXPECT_EQ(model.shown_pair, BodyNames());
}

/// The stock must be the one that the block meets, not the one that it leaves.
TEST(Navigation, AWitnessAtTheEndOfABlockIsShownBeforeItsEnd) {
    ViewModel model = ten_blocks();
    model.rows[3].witness_time = model.rows[3].duration;
    go_to_witness(model, 3);
    EXPECT_LT(model.cursor.fraction, 1.0);
    EXPECT_FALSE(model.wanted->at_end);
}

TEST(Navigation, BlocksThatCannotBeDecidedAreVisitedLikeViolations) {
    std::vector<BlockRow> rows(4, row_with(5.0));
    rows[2].verdict = core::Verdict::undecided;
    rows[2].worst = core::Severity::error; // of the finding that says so
    ViewModel model = model_of(rows);
    EXPECT_TRUE(go_to_offending(model, true));
    EXPECT_EQ(model.cursor.block, 2U);
}

/// What a worker tells when so many rows have been checked.
SessionUpdate rows_from(size_t first, std::vector<BlockRow> rows, bool is_recorded) {
    SessionUpdate news;
    news.opening = 1;
    news.rows.first = first;
    news.rows.rows = std::move(rows);
    news.is_recorded = is_recorded;
    news.has_news = true;
    return news;
}

TEST(Navigation, GoesToAViolationThatIsFoundLaterUnlessOneHasGoneElsewhere) {
    for (const bool goes_elsewhere : {false, true}) {
        ViewModel model = ten_blocks();
        model.is_recorded = false;
        go_to(model, 8);
        EXPECT_TRUE(go_to_offending(model, true));
        EXPECT_EQ(model.cursor.block, 8U);
        EXPECT_FALSE(model.walk) << "breakpoints do not stop it";
        take_in(model, rows_from(10, {row_with(5.0)}, false), 0.0);
        EXPECT_EQ(model.cursor.block, 8U);
        if (goes_elsewhere) step(model, -1);
        take_in(model, rows_from(11, {row_with(5.0), row_with(0.1)}, false), 0.0);
        EXPECT_EQ(model.cursor.block, goes_elsewhere ? 7U : 12U);
    }
}

TEST(Navigation, BeginsAgainWhenNoViolationComesAfterAll) {
    ViewModel model = ten_blocks();
    model.is_recorded = false;
    go_to(model, 8);
    EXPECT_TRUE(go_to_offending(model, true));
    take_in(model, rows_from(10, {row_with(5.0)}, true), 0.0);
    EXPECT_EQ(model.cursor.block, 3U);
}

TEST(Navigation, SaysThatThereIsNoViolationOnlyOfAProgramThatWasCheckedToItsEnd) {
    ViewModel model = model_of({row_with(5.0), row_with(6.0)});
    EXPECT_EQ(no_violation(model), "No problem found");
    model.rows[1].is_judged = false;
    EXPECT_NE(no_violation(model).find("cannot be checked"), std::string::npos);
    model.stopped = core::Error{};
    model.stopped->where.line = 320;
    EXPECT_NE(no_violation(model).find("line 320"), std::string::npos);
    model.is_recorded = false;
    EXPECT_EQ(no_violation(model), "No problem found yet");
}

TEST(Navigation, StepsByTool) {
    ViewModel model = ten_blocks();
    step_tool(model, true);
    EXPECT_EQ(model.cursor.block, 5U);
    step_tool(model, true);
    EXPECT_EQ(model.cursor.block, 9U);
    step_tool(model, false);
    EXPECT_EQ(model.cursor.block, 5U);
    step_tool(model, false);
    EXPECT_EQ(model.cursor.block, 0U);
}

TEST(Navigation, StepsOverAndOutOfCalls) {
    std::vector<BlockRow> rows(8, row_with(5.0));
    for (size_t i = 2; i < 5; ++i) rows[i].depth = 1;
    ViewModel model = model_of(rows);
    go_to(model, 1);
    step_over(model, true);
    EXPECT_EQ(model.cursor.block, 5U);
    step_over(model, false);
    EXPECT_EQ(model.cursor.block, 1U);
    go_to(model, 3);
    step_out(model);
    EXPECT_EQ(model.cursor.block, 5U);
}

TEST(Navigation, WithAFilterStepsOnlyToWhatItShows) {
    ViewModel model = ten_blocks();
    model.filter_text = "violation";
    apply_filter(model);
    EXPECT_EQ(model.filtered, (std::vector<size_t>{3, 7}));
    step(model, 1);
    EXPECT_EQ(model.cursor.block, 3U);
    step(model, 1);
    EXPECT_EQ(model.cursor.block, 7U);
    step(model, -1);
    EXPECT_EQ(model.cursor.block, 3U);
}

TEST(Navigation, TheWorstBlockIsTheTightestUnlessOneHasAnError) {
    ViewModel model = model_of({row_with(9.0), row_with(8.0), row_with(3.0), row_with(4.0)});
    model.rows[0].worst = core::Severity::note;
    model.rows[1].worst = core::Severity::warning;
    EXPECT_EQ(worst_block(model), 2U) << "a note makes no block worse";
    model.rows[1].worst = core::Severity::error;
    EXPECT_EQ(worst_block(model), 1U);
    model.rows[3].verdict = core::Verdict::undecided;
    EXPECT_EQ(worst_block(model), 3U);
}

TEST(SceneOf, ShowsNoWitnessWhileTheToolIsAtAnotherBlock) {
    ViewModel model = ten_blocks();
    go_to(model, 3);
    EXPECT_TRUE(witness_of(model)) << "there is no tool yet";
    auto block_state = std::make_shared<BlockState>();
    block_state->block = 2;
    model.block_state = block_state;
    EXPECT_FALSE(witness_of(model));
    block_state = std::make_shared<BlockState>();
    block_state->block = 3;
    model.block_state = block_state;
    EXPECT_TRUE(witness_of(model));
}

TEST(Navigation, FindsLinesAndNumbers) {
    std::vector<BlockRow> rows(4, row_with(5.0));
    rows[1].text = "N0210 G1 X1";
    rows[3].text = "  N210X5";
    ViewModel model = model_of(rows);
    EXPECT_EQ(find_line(model, "12"), 2U);
    EXPECT_EQ(find_line(model, "N210"), 1U);
    go_to(model, 2);
    EXPECT_EQ(find_line(model, "n210"), 3U) << "the next one from the cursor on";
    EXPECT_EQ(find_line(model, "N21"), std::nullopt);
    EXPECT_EQ(find_line(model, "999"), std::nullopt);
    EXPECT_EQ(find_line(model, "2x"), std::nullopt);
    EXPECT_EQ(find_line(model, "N"), std::nullopt);
}

TEST(Navigation, FindsTheBlocksOfKlartextByTheirOwnNumbers) {
    std::vector<BlockRow> rows(3, row_with(5.0));
    rows[1].text = "12 L X+5 R0 FMAX";
    rows[2].line = 12;
    ViewModel model = model_of(rows);
    OpenedProgram opened;
    opened.counts_blocks = true;
    model.program = std::make_shared<const OpenedProgram>(opened);
    EXPECT_EQ(find_line(model, "12"), 1U);
    EXPECT_EQ(find_line(model, "13"), std::nullopt);
}

TEST(Navigation, ABreakpointIsOnTheLineWhereverItIsRun) {
    std::vector<BlockRow> rows(4, row_with(5.0));
    rows[0].line = rows[2].line = 77;
    ViewModel model = model_of(rows);
    toggle_breakpoint(model, 0);
    EXPECT_TRUE(has_breakpoint(model, model.rows[2]));
    EXPECT_FALSE(has_breakpoint(model, model.rows[1]));
    EXPECT_TRUE(model.breakpoints_changed);
    toggle_breakpoint(model, 2);
    EXPECT_TRUE(model.breakpoints.empty());
}

TEST(SetupSummary, SpellsOutWhatWasInferred) {
    ViewModel model = ten_blocks();
    EXPECT_TRUE(inferred_summary(model).empty());
    OpenedProgram opened;
    auto sheet = std::make_shared<app::SetupSheet>();
    sheet->stock = {core::SolidBox{{{0, 0, -10}, {120, 80, 0}}}, 0.0};
    for (int number = 1; number <= 5; ++number) {
        core::ToolDescription tool;
        tool.number = core::ToolNumber{number};
        tool.diameter = 6.0;
        sheet->tools.push_back({tool, app::SetupSource::assumed, "", {}});
    }
    opened.sheet = sheet;
    model.program = std::make_shared<const OpenedProgram>(opened);
    EXPECT_TRUE(inferred_summary(model).empty()) << "a set-up says it";
    opened.is_inferred = true;
    model.program = std::make_shared<const OpenedProgram>(opened);
    EXPECT_EQ(inferred_summary(model),
              (std::vector<std::string>{"Inferred set-up: press E to edit",
                                        "Stock 120.00 x 80.00 x 10.00 mm", "T1 flat, D6.00 mm",
                                        "T2 flat, D6.00 mm", "T3 flat, D6.00 mm",
                                        "and 2 more tools", "No fixtures are known"}));
}

TEST(Playback, TakesAsLongAsTheMachine) {
    ViewModel model = ten_blocks();
    go_to(model, 0, 0.0);
    model.playback.running = true;
    double seconds = 0.0;
    while (model.playback.running && seconds < 60.0) {
        play(model, 0.016);
        seconds += 0.016;
    }
    EXPECT_NEAR(seconds, 10.0, 0.04); // clock: of the playback, added up
    EXPECT_EQ(model.cursor, (Cursor{9, 1.0}));
}

TEST(Playback, IsAsManyTimesAsFastAsIsSaid) {
    for (const double speed : {0.1, 0.5, 2.0, 100.0}) {
        ViewModel model = ten_blocks();
        go_to(model, 0, 0.0);
        model.playback.running = true;
        model.playback.speed = speed;
        play(model, 4.5 / speed);
        EXPECT_EQ(model.cursor.block, 4U) << speed;
        EXPECT_NEAR(model.cursor.fraction, 0.5, 1e-9) << speed;
    }
}

TEST(Playback, SpeedsGoUpAndDownBetweenTheirEnds) {
    double speed = slowest;
    for (int i = 0; i < 20; ++i) speed = next_speed(speed, true);
    EXPECT_EQ(speed, fastest);
    for (int i = 0; i < 20; ++i) speed = next_speed(speed, false);
    EXPECT_EQ(speed, slowest);
    EXPECT_EQ(next_speed(3.0, true), 5.0);
}

TEST(SessionUpdates, ReadingAgainReturnsToTheLine) {
    ViewModel model = ten_blocks();
    go_to(model, 6);
    toggle_breakpoint(model, 4);
    SessionUpdate news;
    news.opening = 2;
    news.has_news = true;
    std::vector<BlockRow> rows(12, row_with(5.0));
    for (size_t i = 0; i < rows.size(); ++i) rows[i].line = static_cast<uint32_t>(8 + i);
    news.rows.rows = rows;
    take_in(model, std::move(news), 0.0);
    EXPECT_EQ(model.row().line, 16U);
    EXPECT_EQ(model.breakpoints.size(), 1U);
}

TEST(SessionUpdates, FindingsMarkTheirBlocks) {
    ViewModel model = ten_blocks();
    SessionUpdate news;
    news.opening = 1;
    news.has_news = true;
    core::Finding finding;
    finding.severity = core::Severity::error;
    finding.block = core::BlockIndex{5};
    news.findings = {finding};
    take_in(model, std::move(news), 0.0);
    EXPECT_EQ(model.offending, (std::vector<size_t>{3, 5, 7}));
    EXPECT_TRUE(model.least.over(5, 6).offending);
    EXPECT_EQ(findings_of(model, 5).size(), 1U);
    EXPECT_TRUE(findings_of(model, std::nullopt).empty());
}

} // namespace
