#include <gtest/gtest.h>

#include "app/view/model/device_sheet.h"
#include "tests/viewer/made_study.h"

namespace {

using namespace app::viewer;
using viewer_test::MadeAnswer;
using viewer_test::model_with;

DeviceSheet sheet_at(ViewModel model, size_t block) {
    model.cursor.block = block;
    return device_sheet(model);
}

/// The sheet of a program that is one block.
DeviceSheet sheet_of(const MadeAnswer& answer) { return sheet_at(model_with({answer}), 0); }

std::optional<DeviceLine> line_named(const DeviceSheet& sheet, const std::string& name) {
    for (const DevicePart& part : sheet.parts)
        for (const DeviceLine& line : part.lines)
            if (line.name == name) return line;
    return {};
}

std::string value_of(const DeviceSheet& sheet, const std::string& name) {
    return line_named(sheet, name).value_or(DeviceLine()).value;
}

TEST(DeviceSheet, ShowsTheSlackOfAPermittedBlock) {
    const DeviceSheet sheet = sheet_of(viewer_test::permitted(0.125));
    EXPECT_EQ(sheet.number, "125.0 ms");
    EXPECT_EQ(sheet.tone, Tone::plain);
    EXPECT_EQ(sheet.answer, "Permitted in time");
    EXPECT_EQ(sheet.exact, "The exact engine agrees: clear, 5.00 mm");
    EXPECT_EQ(value_of(sheet, "requested at"), "250.0 ms");
    EXPECT_EQ(value_of(sheet, "permitted"), "+750.0 ms");
    EXPECT_EQ(value_of(sheet, "due"), "+875.0 ms");
    EXPECT_EQ(value_of(sheet, "cycles"), "1000");
    EXPECT_EQ(value_of(sheet, "lines made"), "7");
    EXPECT_EQ(value_of(sheet, "control busy"), "25 %");
    EXPECT_EQ(value_of(sheet, "busy"), "25 %") << "2000 of 1000 cycles of 8 elements";
    EXPECT_EQ(value_of(sheet, "PERMIT_SEQ"), "3");
    EXPECT_EQ(value_of(sheet, "STOP"), "none");
    EXPECT_EQ(value_of(sheet, "STOP_LINE"), "0");
}

TEST(DeviceSheet, WarnsOfLittleSlack) {
    EXPECT_EQ(sheet_of(viewer_test::permitted(0.0101)).tone, Tone::plain);
    EXPECT_EQ(sheet_of(viewer_test::permitted(0.0099)).tone, Tone::near);
}

TEST(DeviceSheet, NamesThePairOfWhatIsRefused) {
    const DeviceSheet sheet = sheet_of(viewer_test::refused());
    EXPECT_EQ(sheet.number, "refused");
    EXPECT_EQ(sheet.tone, Tone::bad);
    EXPECT_EQ(sheet.answer, "flutes / stock come closer than allowed");
    EXPECT_EQ(sheet.exact, "The exact engine agrees: violation, 5.00 mm");
    EXPECT_EQ(value_of(sheet, "STOP"), "violation");
    EXPECT_EQ(value_of(sheet, "STOP_SEQ"), "4");
    EXPECT_EQ(value_of(sheet, "answered"), "+250.0 ms") << "that is no permit";
    EXPECT_FALSE(line_named(sheet, "permitted"));
}

TEST(DeviceSheet, NamesTheFaultOfADeviceThatHasStopped) {
    MadeAnswer answer = viewer_test::refused();
    answer.stop = hwsim::Stop::stack_overflow;
    EXPECT_EQ(sheet_of(answer).answer, "The coprocessor has stopped: stack-overflow");
}

TEST(DeviceSheet, SaysWhyABlockCannotBeChecked) {
    const DeviceSheet sheet = sheet_of(viewer_test::not_queried());
    EXPECT_EQ(sheet.number, "not checked");
    EXPECT_EQ(sheet.tone, Tone::bad);
    EXPECT_EQ(sheet.answer, "Not permitted: a body turns");
    EXPECT_EQ(value_of(sheet, "refused"), "0 of 1");
    EXPECT_EQ(value_of(sheet, "not checked"), "1 of 1");
    EXPECT_EQ(sheet.exact, "The exact engine says clear, 5.00 mm");
}

TEST(DeviceSheet, SaysHowLateAPermitCame) {
    const DeviceSheet sheet = sheet_of(viewer_test::permitted(-0.5));
    EXPECT_EQ(sheet.number, "-500.0 ms");
    EXPECT_EQ(sheet.tone, Tone::bad);
    EXPECT_EQ(line_named(sheet, "permitted")->tone, Tone::bad);
    EXPECT_EQ(value_of(sheet, "late"), "1");
    EXPECT_TRUE(line_named(sheet, "waited"));
    EXPECT_FALSE(line_named(sheet_of(viewer_test::permitted(0.5)), "waited"));
}

TEST(DeviceSheet, GivesNoSlackWhereThereIsNothingToAsk) {
    const DeviceSheet sheet = sheet_of(viewer_test::nothing());
    EXPECT_EQ(sheet.number, "\xE2\x80\x94");
    EXPECT_EQ(sheet.answer, "Permitted: the block moves nothing");
    EXPECT_EQ(value_of(sheet, "due"), "\xE2\x80\x94");
    EXPECT_EQ(sheet.exact, "The exact engine agrees: clear, 5.00 mm");
}

TEST(DeviceSheet, KnowsNothingOfBlocksBeyondTheRun) {
    ViewModel model = model_with({viewer_test::permitted(1.0)});
    model.rows.resize(3);
    const DeviceSheet sheet = sheet_at(model, 2);
    EXPECT_EQ(sheet.answer, "The run ended before this block");
    ASSERT_EQ(sheet.parts.size(), 1U);
    EXPECT_EQ(sheet.parts[0].title, "Whole run");
}

TEST(DeviceSheet, SaysWhereTheTwoEnginesDiffer) {
    const DeviceSheet alarm = sheet_of(viewer_test::refused(core::Verdict::clear));
    EXPECT_NE(alarm.exact.find("false alarm"), std::string::npos);
    EXPECT_EQ(alarm.exact_tone, Tone::near);
    EXPECT_EQ(value_of(alarm, "false alarms"), "1");
    MadeAnswer wrong = viewer_test::permitted(1.0);
    wrong.exact = core::Verdict::collision;
    const DeviceSheet missed = sheet_of(wrong);
    EXPECT_NE(missed.exact.find("must not be permitted"), std::string::npos);
    EXPECT_EQ(missed.exact_tone, Tone::bad);
    EXPECT_EQ(value_of(missed, "missed"), "1");
    EXPECT_NE(sheet_of(viewer_test::refused(core::Verdict::undecided)).exact.find("undecided"),
              std::string::npos);
}

TEST(DeviceSheet, LinksToTheBlockBeforeWhichTheMachineStops) {
    const ViewModel model = model_with({viewer_test::nothing(), viewer_test::permitted(-1.0),
                                        viewer_test::refused(), viewer_test::refused()});
    const auto stands = line_named(sheet_at(model, 0), "stopped before");
    ASSERT_TRUE(stands);
    EXPECT_EQ(stands->block, 2U);
    EXPECT_EQ(stands->value, "block 2, line 12");
    EXPECT_EQ(value_of(sheet_at(model, 0), "refused"), "2 of 4");
    EXPECT_EQ(sheet_at(model, 2).parts[0].title, "Time");
    EXPECT_EQ(sheet_at(model, 3).parts[0].title, "Time, after a refused block");
}

TEST(DeviceStatus, DescribesTheCurrentState) {
    ViewModel model = model_with({viewer_test::permitted(1.0)});
    EXPECT_EQ(device_status(model), "");
    model.device.is_running = true;
    model.device.fraction = 0.5;
    EXPECT_EQ(device_status(model), "") << "the answers are there";
    EXPECT_EQ(value_of(device_sheet(model), "sufficient"), "searching: 50 %");
    model.device.study = nullptr;
    EXPECT_EQ(device_status(model), "Loading the stock into the coprocessor \xE2\x80\xA6");
    model.device.blocks = 7;
    EXPECT_EQ(device_status(model), "Checking block 7 \xE2\x80\xA6 50 %");
    model.device.failure = core::Error{core::ErrorCode::invalid_value, {3, 1}, "must be above 0"};
    model.device.failure->file = "device.toml";
    EXPECT_EQ(device_status(model), "device.toml, line 3: must be above 0");
    model.changes = {"T3 is longer"};
    EXPECT_NE(device_status(model).find("what-if"), std::string::npos);
}

TEST(SlackWords, AreShortEnoughForATooltip) {
    const ViewModel model =
        model_with({viewer_test::permitted(0.125), viewer_test::permitted(-2.0),
                    viewer_test::refused(), viewer_test::not_queried(), viewer_test::nothing()});
    EXPECT_EQ(slack_words(model, 0), "slack 125.0 ms");
    EXPECT_EQ(slack_words(model, 1), "late by 2.00 s");
    EXPECT_EQ(slack_words(model, 2), "refused: flutes / stock");
    EXPECT_EQ(slack_words(model, 3), "not checked: a body turns");
    EXPECT_EQ(slack_words(model, 4), "");
    EXPECT_EQ(slack_words(model, 99), "");
    EXPECT_EQ(slack_words(ViewModel(), 0), "") << "without a run";
}

} // namespace
