#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "app/view/ui/command.h"
#include "tests/viewer/made_study.h"

namespace {

using namespace app::viewer;
using viewer_test::MadeAnswer;
using viewer_test::model_with;

std::vector<MadeAnswer> some_of_each() {
    return {viewer_test::nothing(),       viewer_test::permitted(1.0),
            viewer_test::permitted(-1.0), viewer_test::permitted(0.001),
            viewer_test::refused(),       viewer_test::not_queried()};
}

TEST(DeviceStudy, KeepsTheAnswerToEachBlock) {
    const auto study = study_of(viewer_test::result_of(some_of_each()));
    const DeviceAnswer expected[] = {DeviceAnswer::nothing, DeviceAnswer::permitted,
                                     DeviceAnswer::late,    DeviceAnswer::permitted,
                                     DeviceAnswer::refused, DeviceAnswer::not_queried};
    for (size_t i = 0; i < std::size(expected); ++i)
        EXPECT_EQ(answer_of(study.get(), i), expected[i]) << i;
    EXPECT_EQ(answer_of(study.get(), 6), DeviceAnswer::unknown);
    EXPECT_EQ(answer_of(nullptr, 0), DeviceAnswer::unknown);
    EXPECT_EQ(study->stops, (std::vector<size_t>{2, 4, 5}));
}

TEST(DeviceStudy, APixelHasTheLeastSlackOfItsBlocksAndLosesNoStop) {
    std::mt19937 random(7);
    std::exponential_distribution<double> slack(0.5);
    std::vector<MadeAnswer> answers;
    for (size_t i = 0; i < 5000; ++i)
        answers.push_back(i == 3123    ? viewer_test::refused()
                          : i % 5 == 0 ? viewer_test::nothing()
                                       : viewer_test::permitted(slack(random)));
    const auto study = study_of(viewer_test::result_of(answers));
    const auto cells = columns(study->slack, whole(answers.size()), 100);
    for (size_t i = 0; i < cells.size(); ++i) {
        double least = core::infinity;
        for (size_t block = 50 * i; block < 50 * i + 50; ++block)
            least = std::min(least, slack_of(study.get(), block).value_or(core::infinity));
        EXPECT_EQ(cells[i].least, least) << i;
        EXPECT_EQ(cells[i].offending, i == 3123 / 50) << i;
        EXPECT_EQ(cells[i].near, least < 0.01) << i;
    }
}

TEST(SlackBars, GrowWithTheDecadesOfSlack) {
    EXPECT_EQ(slack_height(-1.0), 0.0);
    EXPECT_EQ(slack_height(least_slack), 0.0);
    EXPECT_NEAR(slack_height(0.1), 0.5, 1e-12);
    EXPECT_EQ(slack_height(most_slack), 1.0);
    EXPECT_EQ(slack_height(core::infinity), 1.0);
}

TEST(DeviceModel, GoesRoundTheBlocksThatStopTheMachine) {
    ViewModel model = model_with(some_of_each());
    for (const size_t expected : {2U, 4U, 5U, 2U}) {
        perform(model, Command::next_stop, 0.0);
        EXPECT_EQ(model.cursor.block, expected);
    }
    for (const size_t expected : {5U, 4U, 2U}) {
        perform(model, Command::previous_stop, 0.0);
        EXPECT_EQ(model.cursor.block, expected);
    }
    ViewModel calm = model_with({viewer_test::permitted(1.0)});
    perform(calm, Command::next_stop, 0.0);
    EXPECT_EQ(calm.message, "No block is late or refused");
    calm.device.study = nullptr;
    perform(calm, Command::next_stop, 0.0);
    EXPECT_NE(calm.message.find("No answers from the coprocessor yet"), std::string::npos);
}

TEST(DeviceModel, ForgetsItsAnswersWhenTheProgramIsReadAgain) {
    ViewModel model = model_with(some_of_each());
    SessionUpdate news;
    news.opening = 2;
    news.has_news = true;
    take_in(model, std::move(news), 0.0);
    EXPECT_FALSE(model.device.study);
    EXPECT_TRUE(model.device.shown) << "the panel stays open";
}

TEST(DeviceModel, IgnoresUpdatesOfEarlierRuns) {
    ViewModel model = model_with({viewer_test::permitted(1.0)});
    const auto before = model.device.study;
    const auto other = study_of(viewer_test::result_of(some_of_each()));
    take_in(model, {.run = 7, .study = other, .has_news = true});
    EXPECT_EQ(model.device.study, before);
    take_in(model, {.run = 1, .study = other, .has_news = true});
    EXPECT_EQ(model.device.study, other);
    switch_off_device(model);
    EXPECT_FALSE(model.device.study);
    EXPECT_FALSE(model.device.shown);
}

TEST(WindowTitle, ShowsTheAnswerOfTheDeviceWhileItsPanelIsOpen) {
    ViewModel model = model_with(some_of_each());
    model.cursor.block = 4;
    EXPECT_NE(window_title(model).find(", coprocessor: refused"), std::string::npos);
    model.cursor.block = 2;
    EXPECT_NE(window_title(model).find(", coprocessor: late"), std::string::npos);
    model.device.shown = false;
    EXPECT_EQ(window_title(model).find("coprocessor"), std::string::npos);
}

} // namespace
