#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/base/text.h"
#include "app/check/check_run.h"
#include "app/library/result/program_diff.h"
#include "app/report/history/history_report.h"
#include "app/report/text/batch_text.h"
#include "app/report/text/bench_report.h"
#include "app/report/text/diff_report.h"
#include "app/report/text/text_report.h"

namespace app {
namespace {

using testing::HasSubstr;

/// Sets the title of a terminal, starts a line, and changes colours, with 7 and 8 bit codes.
const std::string hostile = "a\x1b]0;x\x07\n\x7f\xc2\x9b"
                            "31m\x9b"
                            "31m\r\tb.nc";
const std::string harmless = "a ]0;x    31m 31m  b.nc";

/// The number of control characters in a text except line ends, including two-byte ones in UTF-8.
size_t controls_in(const std::string& text) {
    size_t count = 0;
    for (size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        count += (byte < ' ' && byte != '\n') || byte == 0x7F;
        count +=
            byte == 0xC2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xA0;
    }
    return count;
}

/// Expects that a report names the file in one line and sends no control characters.
void expect_harmless(const std::string& text) {
    EXPECT_THAT(text, HasSubstr(harmless));
    EXPECT_EQ(controls_in(text), 0U) << text;
}

ProgramResult hostile_result() {
    return {.program = hostile,
            .setup = hostile,
            .findings = {{{.rule = "near-miss",
                           .severity = core::Severity::error,
                           .message = hostile,
                           .pair = {hostile, hostile}},
                          7,
                          hostile,
                          hostile}},
            .tightest = Tightest{.line = 7, .pair = {hostile, hostile}, .upper = 0.0}};
}

TEST(Printable, KeepsLineEndsAndTextsOfAnyLanguage) {
    EXPECT_EQ(printable("Gehäuse µ\n\n"), "Gehäuse µ\n\n");
    EXPECT_EQ(printable("Geh\xe4use"), "Gehäuse") << "text that is not UTF-8 is read as Latin-1";
    EXPECT_EQ(printable("a\r\nb\x1b[2J"), "a \nb [2J");
    EXPECT_EQ(printable("\xc2\x9b"
                        "31m\x9b"
                        "31m"),
              " 31m 31m");
}

TEST(HistoryText, SendsNothingToTheTerminal) {
    StoredVersion before, after;
    before.setup = after.setup = hostile;
    before.result = after.result = hostile_result();
    before.result.findings.clear();
    expect_harmless(history_text(hostile, {before, after}));
}

TEST(DiffText, SendsNothingToTheTerminal) {
    ProgramDiff diff;
    diff.before = diff.after = hostile_result();
    diff.change.new_findings = diff.after.findings;
    ChangedBlock changed;
    changed.after = {.line = 7, .file = hostile, .text = hostile, .pair = {hostile, hostile}};
    changed.before = changed.after;
    changed.before.pair = {"holder", "clamp-1"};
    diff.nearer.push_back(changed);
    expect_harmless(diff_text(diff, true));
}

TEST(DistanceText, SendsNothingToTheTerminal) {
    expect_harmless(text_distance({}, hostile, hostile, false));
}

TEST(TextReport, SendsNothingToTheTerminal) {
    CheckRun run;
    run.program_file = hostile;
    run.findings.push_back({.rule = "near-miss", .message = hostile, .cure = hostile});
    run.assumptions = {hostile};
    expect_harmless(text_report(run, {.blocks = true}));
}

TEST(BatchText, SendsNothingToTheTerminalButItsOwnColours) {
    BatchResult batch;
    batch.programs = {hostile_result()};
    batch.unchecked = {hostile};
    batch.skipped = {{hostile, hostile}};
    expect_harmless(batch_text(batch, {.verbose = true}));
    EXPECT_EQ(controls_in(program_text(batch.programs[0], {.colour = true})), 2U);
}

} // namespace
} // namespace app
