#include <fstream>
#include <iterator>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/base/findings.h"
#include "app/base/text.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/commands/progress.h"
#include "app/commands/report_formats.h"
#include "app/report/exchange/exchange_reports.h"
#include "app/report/html/html_facts.h"
#include "app/report/json/json_report.h"
#include "app/report/text/text_report.h"
#include "app/tolerance/tolerances.h"

namespace app {
namespace {

const std::string folder = std::string(FEELER_SOURCE_DIR) + "/assets/";

CheckRun clamped_plate(core::Detail detail) {
    return *run_check({.program = folder + "programs/clamped_plate_low.nc",
                       .setup = folder + "setups/clamped_plate.toml",
                       .detail = detail});
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

/// The cells of a row with quoting as in RFC 4180.
std::vector<std::string> cells_of(const std::string& row) {
    std::vector<std::string> cells{""};
    bool quoted = false;
    for (const char c : row) {
        if (c == '"')
            quoted = !quoted;
        else if (c == ',' && !quoted)
            cells.emplace_back();
        else if (c != '\r')
            cells.back() += c;
    }
    return cells;
}

TEST(ErrorText, NamesTheFileUnlessTheMessageDoes) {
    const auto text = [](const std::string& file, const std::string& message) {
        return error_text({core::ErrorCode::io, {}, message, file});
    };
    EXPECT_EQ(text("a.nc", "cannot read a.nc: no such file"), "cannot read a.nc: no such file");
    EXPECT_EQ(text("'a b'", "there is no 'a b'"), "there is no 'a b'");
    EXPECT_EQ(text("e", "contains no NC program"), "e: contains no NC program");
    EXPECT_EQ(text("", "is wrong"), "is wrong");
}

TEST(JsonLines, AgreeWithJson) {
    const CheckRun run = clamped_plate(core::Detail::deciding_pair);
    const auto whole = nlohmann::json::parse(json_report(run, false));
    nlohmann::json blocks = nlohmann::json::array(), findings = nlohmann::json::array();
    std::vector<std::string> order;
    for (const std::string& line : lines_of(json_lines_report(run, false))) {
        nlohmann::json record = nlohmann::json::parse(line);
        const std::string kind = record["record"];
        record.erase("record");
        if (order.empty() || order.back() != kind) order.push_back(kind);
        if (kind == "block") blocks.push_back(record);
        if (kind == "finding") findings.push_back(record);
        if (kind == "program") {
            EXPECT_EQ(record["verdict"], whole["verdict"]);
        }
        if (kind == "end") {
            EXPECT_EQ(record["statistics"], whole["statistics"]);
        }
    }
    EXPECT_EQ(order, (std::vector<std::string>{"program", "block", "finding", "end"}));
    EXPECT_EQ(blocks, whole["blocks"]);
    EXPECT_EQ(findings, whole["findings"]);
}

TEST(Csv, HasARowForEachBlockWithTheNumbersOfJson) {
    const CheckRun run = clamped_plate(core::Detail::deciding_pair);
    const auto whole = nlohmann::json::parse(json_report(run, false));
    const auto rows = lines_of(csv_report(run));
    ASSERT_EQ(rows.size(), run.blocks.size() + 1);
    const auto names = cells_of(rows[0]);
    const auto column = [&](const std::string& name) {
        return static_cast<size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    };
    bool has_finding = false;
    for (size_t i = 0; i < run.blocks.size(); ++i) {
        const auto cells = cells_of(rows[i + 1]);
        const auto& block = whole["blocks"][i];
        ASSERT_EQ(cells.size(), names.size()) << rows[i + 1];
        EXPECT_EQ(cells[column("line")], std::to_string(block["line"].get<int>()));
        EXPECT_EQ(cells[column("verdict")], block["verdict"]);
        has_finding = has_finding || !cells[column("rules")].empty();
        if (!block.contains("clearance")) continue;
        EXPECT_NEAR(std::stod(cells[column("lower")]), block["clearance"]["lower"], 1e-6);
        if (block["clearance"]["upper"].is_null()) {
            EXPECT_EQ(cells[column("upper")], "");
        } else {
            EXPECT_NEAR(std::stod(cells[column("upper")]), block["clearance"]["upper"], 1e-6);
        }
    }
    EXPECT_TRUE(has_finding);
}

TEST(Csv, HasNoTextThatASpreadsheetCarriesOut) {
    for (const std::string text : {"=1+1", "+1", "-1", "@SUM(A1)", "\tG0", "\uFF1D1"})
        EXPECT_EQ(csv_cell(text), "'" + text);
    EXPECT_EQ(csv_cell("\r=1"), "\"'\r=1\"");
    EXPECT_EQ(csv_cell("=HYPERLINK(\"x\",\"y\")"), "\"'=HYPERLINK(\"\"x\"\",\"\"y\"\")\"");
    for (const std::string text : {"", "G0 X-1", "#1=2", "(=1)", "'=1", " a"})
        EXPECT_EQ(csv_cell(text), text);
}

TEST(Csv, LeavesNumbersAloneButQuotesTextsThatWouldBeFormulas) {
    CheckRun run = clamped_plate(core::Detail::deciding_pair);
    CheckedBlock block = run.blocks.back();
    for (const CheckedBlock& each : run.blocks)
        if (each.result.deciding) block.result = each.result;
    ASSERT_TRUE(block.result.deciding);
    core::PairClearance& pair = block.result.pairs[*block.result.deciding];
    pair.on_tool.x = -12.5;
    pair.pair = {.part = core::PartKind::flutes, .fixture = 0};
    run.setup.fixtures[0].name = "@vise";
    block.file = "-sub.nc";
    block.text = "=cmd|' /C calc'!A0";
    run.blocks.replace(run.blocks.size() - 1, block);
    const auto rows = lines_of(csv_report(run));
    const auto names = cells_of(rows[0]), cells = cells_of(rows.back());
    const auto cell = [&](const std::string& name) {
        return cells[static_cast<size_t>(std::find(names.begin(), names.end(), name)
                                         - names.begin())];
    };
    EXPECT_EQ(cell("file"), "'-sub.nc");
    EXPECT_EQ(cell("text"), "'=cmd|' /C calc'!A0");
    EXPECT_EQ(cell("body"), "'@vise");
    EXPECT_EQ(cell("part_x"), "-12.500000");
}

TEST(VerdictOnly, FindsTheSameAsAFullCheck) {
    const CheckRun full = clamped_plate(core::Detail::every_pair);
    const CheckRun brief = clamped_plate(core::Detail::verdict);
    ASSERT_EQ(full.findings.size(), brief.findings.size());
    for (size_t i = 0; i < full.findings.size(); ++i) {
        EXPECT_EQ(full.findings[i].rule, brief.findings[i].rule);
        EXPECT_EQ(full.findings[i].message, brief.findings[i].message);
    }
    for (size_t i = 0; i < full.blocks.size(); ++i)
        EXPECT_EQ(full.blocks[i].result.verdict, brief.blocks[i].result.verdict) << i;
}

TEST(Reports, SayWhichTolerancesWereNotStudied) {
    CheckRun run = clamped_plate(core::Detail::verdict);
    Tolerances tolerances;
    tolerances.list.push_back({.deviation = {.quantity = Quantity::stock, .axis = 1}});
    tolerances.list[0].not_studied = "the simulations reached their limit of 7 tests";
    run.tolerances = std::make_shared<const Tolerances>(tolerances);
    const std::string words = "not studied: the simulations reached their limit of 7 tests";
    EXPECT_NE(text_report(run, {}).find("stock Y  " + words), std::string::npos);
    EXPECT_NE(html_tolerances(run).find("<td>" + words + "</td>"), std::string::npos);
    const auto entry = nlohmann::json::parse(json_report(run, false))["tolerances"]["list"][0];
    EXPECT_EQ(entry["not_studied"], tolerances.list[0].not_studied);
    EXPECT_EQ(entry["text"], words);
    EXPECT_FALSE(entry.contains("less"));
}

TEST(ReportFormats, AreInTheManual) {
    std::ifstream file(std::string(FEELER_SOURCE_DIR) + "/docs/manual/commands.md");
    const std::string manual{std::istreambuf_iterator<char>(file), {}};
    for (const std::string& name : format_names(true))
        EXPECT_NE(manual.find("`" + name + "`"), std::string::npos) << name;
}

TEST(FindingText, SaysWhatAndWhere) {
    core::Finding finding{.rule = "near-miss", .severity = core::Severity::error};
    EXPECT_EQ(finding_title(finding), "error near-miss");
    EXPECT_EQ(finding_title(finding, 8), "error    near-miss");
    EXPECT_EQ(finding_location(12, "", " G0 Z5. "), ", line 12: G0 Z5.");
    EXPECT_EQ(finding_location(12, "sub.nc", "G0 Z5.", 5), ", line 12 of sub.nc: G0...");
    EXPECT_EQ(finding_location(0, "", ""), "");
    EXPECT_EQ(cure_text(finding), "");
    finding.cure = "Raise Z.";
    EXPECT_EQ(cure_text(finding), "Cure: Raise Z.");
}

TEST(Duration, RoundsBeforeItDividesIntoUnits) {
    EXPECT_EQ(duration_text(4.6), "5 s");
    EXPECT_EQ(duration_text(59.7), "1 min 00 s");
    EXPECT_EQ(duration_text(179.7), "3 min 00 s");
    EXPECT_EQ(duration_text(3599.7), "1 h 00 min");
    EXPECT_EQ(duration_text(7500.0), "2 h 05 min");
    EXPECT_EQ(duration_text(core::infinity), "unknown");
    EXPECT_EQ(duration_text(std::nan("")), "unknown");
    EXPECT_EQ(duration_text(3.6e9 - 60.0), "999999 h 59 min");
    for (const double seconds : {3.6e9, 1e16, 2.2e40, 1e300})
        EXPECT_EQ(duration_text(seconds), "more than 1,000,000 h");
}

TEST(Progress, FitsALineOfATerminal) {
    EXPECT_EQ(progress_text(CheckProgress{.blocks = 1, .fraction = 0.0, .findings = 1}, {}),
              "[....................]   0 %  1 blocks, 1 finding");
    EXPECT_EQ(progress_text(CheckProgress{.blocks = 4500, .fraction = 0.25, .findings = 0}, 84.0),
              "[#####...............]  25 %  4500 blocks, 0 findings, 1 min 30 s left");
    EXPECT_LE(progress_text(CheckProgress{1'000'000'000, 0.03, 1'000'000}, 1e6).size(), 79U);
}

TEST(TimeLeft, FollowsTheSpeedOfTheLastSeconds) {
    TimeLeft left;
    EXPECT_FALSE(left.after(0.0, 0.0));
    EXPECT_FALSE(left.after(1.0, 0.01)) << "too early";
    // One per cent a second up to 50 %, then half as fast.
    for (double t = 2.0; t <= 50.0; t += 0.5)
        EXPECT_NEAR(*left.after(t, t / 100.0), 100.0 - t, 1e-9);
    for (double t = 50.5; t < 61.0; t += 0.5) left.after(t, 0.5 + (t - 50.0) / 200.0);
    EXPECT_NEAR(left.after(61.0, 0.555).value_or(0.0), 89.0, 1e-6);
    EXPECT_FALSE(left.after(61.5, 0.2)) << "a loop has begun again";
}

TEST(Stopping, KeepsWhatWasCheckedAndSaysSo) {
    size_t seen = 0;
    const CheckRun run = *run_check({.program = folder + "programs/clamped_plate_low.nc",
                                     .setup = folder + "setups/clamped_plate.toml",
                                     .after_block = [&](const CheckProgress& progress) {
                                         EXPECT_EQ(progress.blocks, ++seen);
                                         EXPECT_LE(progress.fraction, 1.0);
                                         return seen < 5;
                                     }});
    EXPECT_EQ(run.blocks.size(), 5U);
    ASSERT_TRUE(run.stopped);
    EXPECT_EQ(run.stopped->where.line, run.blocks.back().line);
    EXPECT_EQ(run.verdict, core::Verdict::undecided);
    const auto last = nlohmann::json::parse(lines_of(json_lines_report(run, false)).back());
    EXPECT_EQ(last["verdict"], "undecided");
    EXPECT_TRUE(last.contains("error"));
}

} // namespace
} // namespace app
