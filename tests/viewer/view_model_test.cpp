#include <gtest/gtest.h>

#include "app/setup/coverage.h"
#include "app/view/model/navigation.h"
#include "app/view/model/open_programs.h"
#include "app/view/model/view_model.h"
#include "gcode/language/modal_state.h"
#include "tests/viewer/rows.h"

namespace viewer_test {
namespace {

using namespace app::viewer;

/// The same rows under another opening, with lines from `first_line` on.
SessionUpdate opening_again(const ViewModel& model, uint32_t first_line) {
    SessionUpdate news;
    news.opening = model.opening + 1;
    news.rows.rows = model.rows;
    for (size_t i = 0; i < news.rows.rows.size(); ++i)
        news.rows.rows[i].line = static_cast<uint32_t>(first_line + i);
    news.is_recorded = news.has_news = true;
    return news;
}

ViewModel looked_at() {
    ViewModel model = model_of(std::vector<BlockRow>(20, row_with(5.0)));
    go_to(model, 7);
    model.bookmarks.insert(3);
    toggle_breakpoint(model, 12);
    model.section = Section{};
    model.camera.distance = 77.0;
    model.camera_placed = true;
    return model;
}

TEST(ViewModel, KeepsWhatWasSaidOfAProgramThatIsReadAgain) {
    ViewModel model = looked_at();
    const uint32_t line = model.row().line;
    take_in(model, opening_again(model, 8), 0.0); // two lines fewer before it
    EXPECT_EQ(model.row().line, line);
    EXPECT_EQ(model.cursor.block, 9U);
    EXPECT_EQ(model.bookmarks.size(), 1U);
    EXPECT_EQ(model.breakpoints.size(), 1U);
    EXPECT_TRUE(model.section);
    EXPECT_TRUE(model.camera_placed);
    EXPECT_EQ(model.camera.distance, 77.0);
}

TEST(ViewModel, KeepsTheCursorWhileAFileCannotBeRead) {
    ViewModel model = looked_at();
    SessionUpdate broken;
    broken.opening = model.opening + 1;
    broken.failure = core::Error{core::ErrorCode::io, {}, "it is gone"};
    broken.has_news = true;
    SessionUpdate mended = opening_again(model, 10);
    ++mended.opening;
    take_in(model, std::move(broken), 0.0);
    EXPECT_TRUE(model.failure);
    EXPECT_FALSE(model.has_rows());
    take_in(model, std::move(mended), 0.0);
    EXPECT_FALSE(model.failure);
    EXPECT_EQ(model.cursor.block, 7U);
}

TEST(ViewModel, GivesSettingsAndFilesToTheProgramThatIsShownNext) {
    ViewModel a = looked_at(), b;
    a.settings.scale = 1.5;
    a.popup = Popup::leaving;
    a.workspace.leaving = Leaving::to_close;
    a.playback.running = true;
    a.samples = "/samples";
    OpenedProgram inch;
    inch.is_inch = true;
    b.program = std::make_shared<const OpenedProgram>(inch);
    b.cursor.block = 3;
    show_in_place(b, a);
    EXPECT_EQ(b.settings.scale, 1.5);
    EXPECT_TRUE(b.settings.inch) << "as its program, while the user has not chosen";
    EXPECT_EQ(b.samples, "/samples");
    EXPECT_EQ(b.cursor.block, 3u);
    EXPECT_EQ(a.popup, Popup::none);
    EXPECT_EQ(a.workspace.leaving, Leaving::no) << "a question that is not answered is withdrawn";
    EXPECT_FALSE(a.playback.running);
}

TEST(ViewModel, TellsOpenProgramsApart) {
    ViewModel a = looked_at(), b, c, empty;
    a.opened_path = "/op10/plate.nc";
    b.opened_path = "/op20/plate.nc";
    b.failure = core::Error{core::ErrorCode::io, {}, "it is gone"};
    c.opened_path = "lid.nc";
    const auto titles = tab_titles({&a, &b, &c, &empty});
    ASSERT_EQ(titles.size(), 4u);
    EXPECT_EQ(titles[0].name, "op10/plate.nc");
    EXPECT_EQ(titles[1].name, "op20/plate.nc");
    EXPECT_EQ(titles[1].state, render::ClearanceState::violation);
    EXPECT_EQ(titles[2].name, "lid.nc");
    EXPECT_EQ(titles[2].state, render::ClearanceState::none);
    EXPECT_EQ(titles[3].name, "Start");
}

TEST(ViewModel, MarksABlockByTheWorstOfItsFindings) {
    ViewModel model = looked_at();
    SessionUpdate news;
    news.opening = model.opening;
    news.has_news = news.is_recorded = true;
    core::Finding error, note;
    error.block = note.block = core::BlockIndex{5};
    error.severity = core::Severity::error;
    note.severity = core::Severity::note;
    news.findings = {error, note};
    take_in(model, std::move(news), 0.0);
    EXPECT_EQ(model.rows[5].worst, core::Severity::error);
    EXPECT_EQ(model.offending, std::vector<size_t>{5});
}

TEST(LengthText, RoundsLowerBoundsDownAndMinimumClearancesUp) {
    ViewModel model;
    EXPECT_EQ(length_at_least(model, 1.9996), "1.99");
    EXPECT_EQ(length_at_least(model, 49.6, 0), "49");
    EXPECT_EQ(length_at_least(model, -0.0004), "0.00");
    EXPECT_EQ(length_at_least(model, 2.0), "2.00");
    EXPECT_EQ(length_at_most(model, 2.0004), "2.01");
    model.settings.inch = true;
    EXPECT_EQ(length_at_least(model, 25.3999), "0.9999");
    EXPECT_EQ(length_at_most(model, 25.4), "1.0000");
}

TEST(Unit, IsThatOfTheProgramUntilTheUserChooses) {
    const auto open = [](ViewModel& model, bool is_inch) {
        OpenedProgram opened;
        opened.is_inch = is_inch;
        SessionUpdate news;
        news.opening = model.opening + 1;
        news.has_news = true;
        news.opened = std::make_shared<const OpenedProgram>(std::move(opened));
        take_in(model, std::move(news), 0.0);
    };
    ViewModel model;
    open(model, true);
    EXPECT_TRUE(model.settings.inch);
    open(model, false);
    EXPECT_FALSE(model.settings.inch);
    model.settings.has_own_unit = true;
    open(model, true);
    EXPECT_FALSE(model.settings.inch);
}

TEST(BlockState, OfTheSetupBeforeHasNoOffsets) {
    ViewModel model;
    model.program = std::make_shared<const OpenedProgram>();
    BlockState state;
    state.offsets_in_effect = std::make_shared<const gcode::Offsets>();
    model.block_state = std::make_shared<const BlockState>(state);
    SessionUpdate news;
    news.opening = model.opening + 1;
    news.has_news = news.is_again = true;
    news.opened = std::make_shared<const OpenedProgram>();
    take_in(model, std::move(news), 0.0);
    ASSERT_TRUE(model.block_state);
    EXPECT_TRUE(model.block_state->is_outdated);
    EXPECT_FALSE(model.block_state->offsets_in_effect)
        << "their machine is gone with the old scene";
}

TEST(CoverageWords, SayWhatWasNotCheckedOfTheToolsThatFeed) {
    using app::Coverage, app::Known;
    using render::ClearanceState;
    Coverage coverage{.stock = Known::described,
                      .fixtures = Known::missing,
                      .offsets = Known::described,
                      .limits = Known::described};
    OpenedProgram opened;
    opened.tools_with_holder = {core::ToolNumber{1}};
    opened.coverage = std::make_shared<const Coverage>(coverage);
    ViewModel model;
    model.program = std::make_shared<const OpenedProgram>(opened);
    EXPECT_EQ(coverage_words(model), "Not checked: fixtures: not described");
    EXPECT_EQ(verdict_words(model).text, "") << "no block is known";
    model.rows.resize(2);
    EXPECT_EQ(verdict_words(model).text, "CHECKING");
    model.is_recorded = true;
    EXPECT_EQ(verdict_words(model).text, "NOTHING CHECKED, the program moves nothing");
    model.rows[0].motion = core::BlockMotion::rapid;
    model.rows[0].tool = core::ToolNumber{3};
    model.rows[1].motion = core::BlockMotion::feed;
    model.rows[1].tool = core::ToolNumber{1};
    EXPECT_EQ(coverage_words(model), "Not checked: fixtures: not described");
    EXPECT_EQ(verdict_words(model).text, "NO ERROR IN THE PROGRAM ITSELF");
    EXPECT_EQ(verdict_words(model).state, ClearanceState::near);
    model.rows[1].tool = core::ToolNumber{2};
    EXPECT_EQ(coverage_words(model), "Not checked: holder of T2, fixtures: not described");
    model.rows[1].verdict = core::Verdict::collision;
    model.offending = {1};
    core::Finding error;
    error.severity = core::Severity::error;
    error.rule = "collision";
    model.findings = {error, error};
    EXPECT_EQ(verdict_words(model).text, "COLLISION, 2 errors");
    EXPECT_EQ(verdict_words(model).state, ClearanceState::violation);
    model.is_recorded = false;
    EXPECT_EQ(verdict_words(model).text, "COLLISION, 2 errors so far");
    model.is_recorded = true;
    model.rows[1].verdict = core::Verdict::clear;
    model.offending.clear();
    model.findings.clear();
    coverage.fixtures = Known::described;
    opened.coverage = std::make_shared<const Coverage>(coverage);
    opened.tools_with_holder.insert(core::ToolNumber{2});
    model.program = std::make_shared<const OpenedProgram>(opened);
    EXPECT_EQ(coverage_words(model), "");
    EXPECT_EQ(verdict_words(model).text, "CLEAR");
    EXPECT_EQ(verdict_words(model).state, ClearanceState::clear);
}

} // namespace
} // namespace viewer_test
