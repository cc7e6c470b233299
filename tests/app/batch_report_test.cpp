#include <algorithm>
#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/report/exchange/exchange_reports.h"
#include "app/report/html/html_batch.h"
#include "app/report/json/json_report.h"
#include "app/report/text/batch_text.h"
#include "core/sim/finding.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/shell.h"

namespace app {
namespace {

using core::Severity;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

StoredFinding near_miss(const std::string& text, uint32_t line) {
    return {{.rule = "near-miss",
             .severity = Severity::error,
             .block = core::BlockIndex{line},
             .message = "The holder comes near to <clamp-1> & \"more\".",
             .cure = "Go round it.",
             .pair = {"holder", "clamp-1"},
             .shortfall = 1.25},
            line,
            "",
            text};
}

/// A set-up that describes everything.
constexpr auto described = Known::described;
const Coverage everything{.stock = described,
                          .fixtures = described,
                          .offsets = described,
                          .limits = described,
                          .moves = true};

/// One program of each kind.
BatchResult batch_of_all_kinds() {
    const ProgramResult good{.program = "parts/good.nc",
                             .verdict = core::Verdict::clear,
                             .coverage = everything,
                             .findings = {{{.rule = "air-cut", .severity = Severity::note}}},
                             .blocks = 9,
                             .seconds = 0.5};
    ProgramResult bad{.program = "parts/Gehäuse 50%.nc",
                      .setup = "vise.toml",
                      .verdict = core::Verdict::violation,
                      .coverage = everything,
                      .findings = {near_miss("N20 G0 X5.", 7),
                                   near_miss("N30 G0 X5.", 9),
                                   {{.rule = "program", .message = "bell \x07 and line\nend"}}},
                      .blocks = 12,
                      .tightest = Tightest{.block = 7,
                                           .line = 7,
                                           .pair = {"holder", "clamp, the left one"},
                                           .lower = 0.5,
                                           .upper = {},
                                           .allowance = 2.0},
                      .seconds = 1.5};
    bad.findings[1].file = "/abs/sub 1.nc";
    const ProgramResult broken{.program = "broken.nc",
                               .coverage = everything,
                               .error = StoredError{"broken.nc", 3, 5, "G999: no such <code>"},
                               .blocks = 2,
                               .seconds = 0.25};
    return {.programs = {good, bad, broken},
            .unchecked = {"late.nc"},
            .skipped = {{"notes.txt", "most of its lines are not NC blocks"}}};
}

TEST(Sarif, WritesAbsolutePathsAsUris) {
    EXPECT_EQ(uri_of("jobs/a b.nc"), "jobs/a%20b.nc");
    EXPECT_EQ(uri_of("/lib/a.nc"), "file:///lib/a.nc");
    // Two slashes name a server on Windows only.
    EXPECT_EQ(uri_of("//lib/a.nc"), "file:////lib/a.nc");
    EXPECT_EQ(uri_of("C:/a.nc"), "C%3A/a.nc");
}

json sarif() { return json::parse(sarif_report(batch_of_all_kinds(), "/home/me/my shop")); }

TEST(Sarif, HasWhatTheSchemaRequires) {
    const json log = sarif();
    EXPECT_EQ(log["version"], "2.1.0");
    EXPECT_THAT(log["$schema"].get<std::string>(), HasSubstr("sarif-2.1.0"));
    ASSERT_EQ(log["runs"].size(), 1U);
    const json& run = log["runs"][0];
    EXPECT_EQ(run["tool"]["driver"]["name"], "Feeler");
    const json& rules = run["tool"]["driver"]["rules"];
    ASSERT_EQ(run["results"].size(), 6U);
    for (const json& result : run["results"]) {
        EXPECT_FALSE(result["message"]["text"].get<std::string>().empty()
                     && result["ruleId"] != "air-cut");
        EXPECT_EQ(rules.at(result["ruleIndex"].get<size_t>())["id"], result["ruleId"]);
        EXPECT_THAT((std::vector<std::string>{"none", "note", "warning", "error"}),
                    testing::Contains(result["level"].get<std::string>()));
        ASSERT_EQ(result["locations"].size(), 1U);
        const json& place = result["locations"][0]["physicalLocation"];
        EXPECT_GE(place["region"]["startLine"].get<int>(), 1);
        EXPECT_GE(place["region"]["startColumn"].get<int>(), 1);
        EXPECT_TRUE(place["artifactLocation"]["uri"].is_string());
        EXPECT_EQ(result["partialFingerprints"]["feeler/v1"].get<std::string>().size(), 64U);
    }
    for (const json& invocation : run["invocations"]) {
        EXPECT_TRUE(invocation["executionSuccessful"].is_boolean());
        for (const json& note : invocation["toolExecutionNotifications"])
            EXPECT_TRUE(note["message"]["text"].is_string());
    }
}

TEST(Sarif, PutsFindingsOnTheirLines) {
    const json results = sarif()["runs"][0]["results"];
    const json at_7 = results[1]["locations"][0]["physicalLocation"];
    EXPECT_EQ(at_7["artifactLocation"]["uri"], "parts/Geh%C3%A4use%2050%25.nc");
    EXPECT_EQ(at_7["artifactLocation"]["uriBaseId"], "%SRCROOT%");
    EXPECT_EQ(at_7["region"], json({{"startLine", 7}, {"startColumn", 1}}));
    EXPECT_EQ(results[1]["level"], "error");
    const json in_subprogram = results[2]["locations"][0]["physicalLocation"];
    EXPECT_EQ(in_subprogram["artifactLocation"]["uri"], "file:///abs/sub%201.nc");
    EXPECT_FALSE(in_subprogram["artifactLocation"].contains("uriBaseId"));
}

TEST(Sarif, NamesFilesByTheirBytes) {
    const test_support::ScopedFolder folder;
    const std::string program = folder.write("Geh\xe4use.nc", "G21 G90\nT1 M6\nG1 X5. F100.\nQ\n");
    CheckJob job;
    job.program = program;
    const core::Error wrong{core::ErrorCode::syntax, {}, "is wrong", program};
    BatchResult batch;
    batch.programs = {failed_result(job, wrong)};
    EXPECT_THAT(batch.programs[0].program, testing::EndsWith("/Geh\xc3\xa4use.nc")) << "as a text";
    EXPECT_EQ(*result_from_json(json_of(batch.programs[0])), batch.programs[0]);
    batch.unchecked = {shown_name("sp\xe4t.nc", batch.file_bytes)};
    const std::string report = sarif_report(batch, "/lib");
    EXPECT_THAT(report, HasSubstr("/Geh%E4use.nc\""));
    EXPECT_THAT(report, HasSubstr("\"sp%E4t.nc\""));
    EXPECT_THAT(report, Not(HasSubstr("%C3")));
}

TEST(Sarif, ReportsProgramsThatWereNotRunToTheirEnd) {
    const json run = sarif()["runs"][0];
    EXPECT_EQ(run["results"][4]["ruleId"], "not-run-to-its-end");
    EXPECT_EQ(run["results"][4]["locations"][0]["physicalLocation"]["region"]["startColumn"], 5);
    EXPECT_EQ(run["invocations"][0]["executionSuccessful"], false);
    EXPECT_EQ(run["invocations"][0]["toolExecutionNotifications"].size(), 3U);
    EXPECT_EQ(run["originalUriBaseIds"]["%SRCROOT%"]["uri"], "file:///home/me/my%20shop/");
}

/// Code hosts that only look at results must not show success.
TEST(Sarif, HasAResultForWhatWasNotChecked) {
    const json run = sarif()["runs"][0];
    const json& result = run["results"][5];
    EXPECT_EQ(result["ruleId"], "not-checked");
    EXPECT_EQ(result["level"], "error");
    EXPECT_EQ(result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"], "late.nc");
    const json& rule = run["tool"]["driver"]["rules"].at(result["ruleIndex"].get<size_t>());
    EXPECT_EQ(rule["id"], "not-checked");
    EXPECT_EQ(rule["defaultConfiguration"]["level"], "error");
}

/// Programs with a number of findings each; every third is an error and the last is the worst.
BatchResult batch_of_many(size_t programs, size_t findings) {
    BatchResult batch;
    for (size_t i = 0; i < programs; ++i) {
        ProgramResult program{.program = std::to_string(i) + ".nc"};
        for (size_t k = 0; k < findings; ++k) {
            StoredFinding finding = near_miss("G0 X5.", static_cast<uint32_t>(k + 1));
            if (k % 3 != 0) finding.severity = Severity::warning;
            finding.shortfall = static_cast<double>(k);
            program.findings.push_back(finding);
        }
        batch.programs.push_back(program);
    }
    return batch;
}

TEST(Sarif, HasNoMoreResultsThanCodeHostsTake) {
    BatchResult batch = batch_of_many(5000, 5);
    const json whole = json::parse(sarif_report(batch, "/"))["runs"][0];
    EXPECT_EQ(whole["results"].size(), 25'000U);
    EXPECT_TRUE(whole["invocations"][0]["toolExecutionNotifications"].empty());
    batch.unchecked = {"late.nc"};
    const json cut = json::parse(sarif_report(batch, "/"))["runs"][0];
    EXPECT_EQ(cut["results"].size(), 25'000U);
    EXPECT_EQ(cut["results"].back()["ruleId"], "not-checked");
    const json& notes = cut["invocations"][0]["toolExecutionNotifications"];
    ASSERT_EQ(notes.size(), 2U);
    EXPECT_EQ(notes[0]["level"], "warning");
    EXPECT_THAT(notes[0]["message"]["text"].get<std::string>(),
                testing::AllOf(testing::StartsWith("omitted: 1 of the results"),
                               HasSubstr("--format json lists all")));
    // The omitted result is the mildest of the last program, a warning with the least shortfall.
    const auto& results = cut["results"];
    EXPECT_EQ(results[24'994], whole["results"][24'994]);
    EXPECT_EQ(results[24'995], whole["results"][24'995]);
    EXPECT_EQ(results[24'996], whole["results"][24'997]) << "its fingerprint is not numbered again";
}

TEST(Sarif, HasTheWorstOfEachProgramBeforeOthers) {
    BatchResult batch = batch_of_many(2, 60'000);
    batch.programs.push_back(ProgramResult{.program = "2.nc"});
    batch.programs[2].findings = batch_of_many(1, 4).programs[0].findings;
    const json results = json::parse(sarif_report(batch, "/"))["runs"][0]["results"];
    ASSERT_EQ(results.size(), 25'000U);
    std::map<std::string, size_t> counts;
    double least = 60'000.0;
    for (const json& result : results) {
        EXPECT_EQ(result["level"], "error");
        const std::string program = result["properties"]["program"];
        ++counts[program];
        if (program != "2.nc")
            least = std::min(least, result["properties"]["shortfall"].get<double>());
    }
    EXPECT_EQ(counts,
              (std::map<std::string, size_t>{{"0.nc", 12'499}, {"1.nc", 12'499}, {"2.nc", 2}}));
    EXPECT_EQ(least, 3.0 * (20'000 - 12'499));
}

TEST(Sarif, HasHelpForEachRule) {
    const json run = sarif()["runs"][0];
    for (const json& rule : run["tool"]["driver"]["rules"]) {
        EXPECT_FALSE(rule["help"]["text"].get<std::string>().empty()) << rule["id"];
        EXPECT_FALSE(rule["shortDescription"]["text"].get<std::string>().empty()) << rule["id"];
    }
    for (const core::RuleEntry& rule : core::rule_table())
        EXPECT_FALSE(rule.meaning.empty()) << rule.name;
}

TEST(Fingerprint, SurvivesNewNumbersBlanksAndLines) {
    const std::string before = fingerprint_of(near_miss("N20 G0 X5.", 7), 0);
    for (const char* text : {"N2000 G0 X5.", "G0 X5.", "n20g0x5.", "  N20  G0  X5. "})
        EXPECT_EQ(fingerprint_of(near_miss(text, 99), 0), before) << text;
    EXPECT_EQ(fingerprint_of(near_miss("7 L X+5 FMAX", 7), 0),
              fingerprint_of(near_miss("12 L X+5 FMAX", 12), 0));
    EXPECT_EQ(fingerprint_of(near_miss("/N20 G0 X5.", 7), 0),
              fingerprint_of(near_miss("/N30 G0 X5.", 7), 0));
}

TEST(Fingerprint, DistinguishesFindings) {
    const std::string before = fingerprint_of(near_miss("N20 G0 X5.", 7), 0);
    EXPECT_NE(fingerprint_of(near_miss("N20 G0 X6.", 7), 0), before);
    EXPECT_NE(fingerprint_of(near_miss("/N20 G0 X5.", 7), 0), before);
    EXPECT_NE(fingerprint_of(near_miss("N20 G0 X5.", 7), 1), before);
    StoredFinding other = near_miss("N20 G0 X5.", 7);
    other.pair[1] = "clamp-2";
    EXPECT_NE(fingerprint_of(other, 0), before);
}

TEST(Sarif, CountsFindingsThatAreAlike) {
    const json results = sarif()["runs"][0]["results"];
    EXPECT_NE(results[1]["partialFingerprints"], results[2]["partialFingerprints"])
        << "N20 and N30 are the same block twice";
}

/// Runs xmllint on a JUnit report.
test_support::Ran linted(const std::string& xml) {
    const test_support::ScopedFolder folder;
    return test_support::run({"xmllint", "--noout", "--schema",
                              std::string(FEELER_SOURCE_DIR) + "/tests/app/junit.xsd",
                              folder.write("report.xml", xml)});
}

TEST(Junit, IsValid) {
    const test_support::Ran ran = linted(junit_report(batch_of_all_kinds()));
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_NE(linted("<testsuites name=\"feeler\"/>").status, 0) << "the schema takes anything";
}

TEST(Junit, HasACaseForEachProgram) {
    const std::string xml = junit_report(batch_of_all_kinds());
    EXPECT_THAT(xml, HasSubstr("tests=\"4\" failures=\"1\" errors=\"2\" time=\"2.250\""));
    EXPECT_THAT(xml, HasSubstr("<testcase name=\"good.nc\" classname=\"parts\" time=\"0.500\">"));
    EXPECT_THAT(xml, HasSubstr("<failure message=\"violation: 2 errors\" type=\"violation\">"));
    EXPECT_THAT(xml, HasSubstr("&lt;clamp-1&gt; &amp; &quot;more&quot;"));
    EXPECT_THAT(xml, HasSubstr("<error message=\"line 3: G999: no such &lt;code&gt;\""));
    EXPECT_THAT(xml,
                HasSubstr("<error message=\"was not checked: the batch was stopped before it\"/>"));
    EXPECT_THAT(xml, HasSubstr("bell ? and line\nend"));
}

TEST(BatchReport, HoldsResultsInJson) {
    const BatchResult batch = batch_of_all_kinds();
    const json whole = json::parse(batch_json_report(batch));
    EXPECT_EQ(whole["schema"], 1);
    EXPECT_EQ(whole["status"], 2);
    ASSERT_EQ(whole["programs"].size(), 3U);
    for (size_t i = 0; i < 3; ++i)
        EXPECT_EQ(*result_from_json(whole["programs"][i].dump()), batch.programs[i]);
    EXPECT_EQ(whole["unchecked"], json({"late.nc"}));
    EXPECT_EQ(whole["skipped"][0]["file"], "notes.txt");
}

TEST(BatchReport, HasALineForEachProgram) {
    const BatchResult batch = batch_of_all_kinds();
    std::istringstream lines(batch_lines_report(batch));
    std::string line;
    for (const ProgramResult& program : batch.programs) {
        ASSERT_TRUE(std::getline(lines, line));
        EXPECT_EQ(*result_from_json(line), program);
    }
    ASSERT_TRUE(std::getline(lines, line));
    EXPECT_EQ(json::parse(line), json({{"program", "late.nc"}, {"checked", false}}));
    EXPECT_FALSE(std::getline(lines, line));
}

TEST(BatchReport, HasARowForEachProgram) {
    std::istringstream rows(batch_csv_report(batch_of_all_kinds()));
    std::vector<size_t> cells;
    for (std::string row; std::getline(rows, row);) {
        bool quoted = false;
        size_t count = 1;
        for (const char c : row) {
            quoted = quoted != (c == '"');
            count += c == ',' && !quoted;
        }
        cells.push_back(count);
    }
    EXPECT_EQ(cells, (std::vector<size_t>{22, 22, 22, 22, 22}));
}

TEST(BatchReport, HasNoCellThatASpreadsheetCarriesOut) {
    const BatchResult batch{
        .programs = {{.program = "=1+1.nc",
                      .setup = "+vise.toml",
                      .error = StoredError{.file = "@a.nc", .line = 3, .message = "is wrong"},
                      .tightest = Tightest{.line = 7,
                                           .pair = {"-holder", "=clamp"},
                                           .lower = -2e-6,
                                           .upper = 0.0}}},
        .unchecked = {"-late.nc"}};
    const std::string rows = batch_csv_report(batch);
    EXPECT_THAT(rows, HasSubstr("\r\n'=1+1.nc,'+vise.toml,"));
    EXPECT_THAT(rows, HasSubstr(",7,-2e-06,0,0,'-holder,'=clamp,"));
    EXPECT_THAT(rows, HasSubstr(",'@a.nc:3: is wrong,"));
    EXPECT_THAT(rows, HasSubstr("\r\n'-late.nc,"));
}

TEST(BatchText, HasTheMessageOfTheWorstOfARuleAndEachLineOnce) {
    ProgramResult program{.program = "a.nc",
                          .findings = {near_miss("G0 X5.", 7), near_miss("G0", 7)}};
    program.findings[1].shortfall = 2.0;
    program.findings[1].message = "It is at 0.000 mm.";
    const std::string text = batch_text({.programs = {program}}, {});
    EXPECT_THAT(text, HasSubstr("error near-miss, line 7: It is at 0.000 mm."));
}

TEST(BatchReport, OfAShardNamesTheShard) {
    BatchResult batch = batch_of_all_kinds();
    batch.shard = "shard 2/8: 4 of 31 programs";
    EXPECT_EQ(json::parse(batch_json_report(batch))["share"], batch.shard);
    EXPECT_FALSE(json::parse(batch_json_report(batch_of_all_kinds())).contains("share"));
    const json run = json::parse(sarif_report(batch, "/"))["runs"][0];
    EXPECT_EQ(run["automationDetails"]["description"]["text"], batch.shard);
    EXPECT_THAT(junit_report(batch), HasSubstr("feeler check, shard 2/8"));
    EXPECT_THAT(batch_text(batch, {}), HasSubstr(batch.shard + "\n4 programs"));
    EXPECT_THAT(batch_html_report(batch), HasSubstr("<b>" + batch.shard));
}

TEST(BatchText, ListsErrorsAndWithVerboseEverything) {
    const BatchResult batch = batch_of_all_kinds();
    const std::string brief = batch_text(batch, {}), whole = batch_text(batch, {.verbose = true}),
                      quiet = batch_text(batch, {.quiet = true});
    EXPECT_THAT(brief, HasSubstr("violation  parts/Gehäuse 50%.nc: 2 errors, 1 warning"));
    EXPECT_THAT(brief, HasSubstr("error near-miss, line 7"));
    EXPECT_THAT(brief, HasSubstr("stopped    broken.nc\n           line 3: G999"));
    EXPECT_THAT(brief, HasSubstr("clear      parts/good.nc: 1 note"));
    EXPECT_THAT(brief, HasSubstr("4 programs: 1 clear, 1 violation, 1 stopped, 1 not checked"));
    EXPECT_THAT(brief, HasSubstr("skipped: notes.txt"));
    EXPECT_THAT(brief, Not(HasSubstr("note air-cut:")));
    EXPECT_THAT(whole, HasSubstr("note air-cut"));
    EXPECT_THAT(quiet, Not(HasSubstr("good.nc")));
    EXPECT_THAT(quiet, Not(HasSubstr("notes.txt")));
    EXPECT_THAT(quiet, HasSubstr("not checked: late.nc"));
}

TEST(BatchText, CountsFilesThatWereSkippedForOneReason) {
    BatchResult batch = batch_of_all_kinds();
    for (const char* name : {"a.png", "b.png", "c.png", "d.png"})
        batch.skipped.push_back({name, "is a picture or a video"});
    const std::string brief = batch_text(batch, {}), whole = batch_text(batch, {.verbose = true});
    EXPECT_THAT(brief, HasSubstr("skipped: 4 files, such as a.png: is a picture or a video"));
    EXPECT_THAT(brief, HasSubstr("skipped: notes.txt: most of its lines"));
    EXPECT_THAT(brief, Not(HasSubstr("b.png")));
    EXPECT_THAT(whole, HasSubstr("skipped: d.png: is a picture or a video"));
}

TEST(Sarif, CountsSkippedFilesWhereTheyAreMany) {
    BatchResult batch;
    for (int i = 0; i < 1000; ++i)
        batch.skipped.push_back({std::to_string(i) + ".png", "is a picture or a video"});
    const json notes = json::parse(
        sarif_report(batch, "/"))["runs"][0]["invocations"][0]["toolExecutionNotifications"];
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_EQ(notes[0]["message"]["text"],
              "this and 999 more were skipped: is a picture or a video");
}

TEST(BatchText, IsColouredOnlyOnRequest) {
    const ProgramResult bad = batch_of_all_kinds().programs[1];
    EXPECT_THAT(program_text(bad, {}), Not(HasSubstr("\033")));
    EXPECT_THAT(program_text(bad, {.colour = true}), HasSubstr("\033[33mviolation"));
}

} // namespace
} // namespace app
