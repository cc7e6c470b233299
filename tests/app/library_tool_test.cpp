#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/base/clearance_text.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/prepared_check.h"
#include "app/check/setup_sheet.h"
#include "app/setup/inference/imported_setup.h"
#include "app/setup/inference/inferred_setup.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_changes.h"
#include "app/setup/setup_file.h"
#include "app/setup/setup_text.h"
#include "app/setup/tools/found_tool.h"
#include "app/setup/tools/tool_library.h"
#include "core/base/rule_table.h"
#include "gcode/text/source.h"
#include "tests/support/scoped_folder.h"

/// Tools of a library in a set-up: it states what the library states, and finds the same as the
/// library.

namespace app_test {
namespace {

using testing::HasSubstr;
using testing::Not;

struct NamedLibrary {
    const char* name;
    std::string text;
};

/// Libraries that say much and little of their tools, each with the numbers 1 to 30.
std::vector<NamedLibrary> libraries() {
    const char* const comments[] = {"", "ball nose", "4 fl end mill", "drill", "90 deg v-bit"};
    const char* const shapes[] = {
        R"("type": "bull nose end mill", "geometry": {"DC": 10, "RE": 1, "LCF": 22, "SFDM": 10,
            "LB": 45}, "holder": {"unit": "millimeters", "segments": [{"height": 30,
            "lower-diameter": 32, "upper-diameter": 40}], "gaugeLength": 35})",
        R"("type": "drill", "geometry": {"DC": 6.35, "SIG": 135})",
        R"("type": "ball end mill", "geometry": {"DC": 6, "LCF": 13, "SFDM": 6})",
        R"("type": "flat end mill", "geometry": {"DC": 8, "LCF": 20, "shoulder-length": 30,
            "shoulder-diameter": 7.5, "SFDM": 10, "LB": 50})",
        R"("type": "slot mill", "geometry": {"DC": 20, "LCF": 4, "LB": 40})",
        R"("type": "chamfer mill", "geometry": {"DC": 8, "TA": 45})",
        R"("type": "radius mill", "geometry": {"DC": 4, "RE": 3, "LCF": 5, "SFDM": 10, "LB": 30})"};
    std::string plain, named, table, fusion;
    for (int i = 1; i <= 30; ++i) {
        plain += fmt::format("T{} P{} D{} Z{}\n", i, i, 4.0 + i % 5, i % 3 == 0 ? 0.0 : 60.0 + i);
        named +=
            fmt::format("T{} P{} D{} Z{} ;{}\n", i, i, 3.175 + i % 4, 50.1 + i, comments[i % 5]);
        table += fmt::format(R"({}"{}": {{"name": "mill {}", "tooltype": "{}", "diameter": {},
            "cuttingEdgeHeight": {}}})",
                             i == 1 ? "" : ",", i, i, i % 2 == 0 ? "EndMill" : "BallEndMill",
                             5.0 + i % 3, i % 4 == 0 ? 0.0 : 25.0);
        fusion +=
            fmt::format(R"({}{{{}, "unit": "millimeters", "post-process": {{"number": {}}}}})",
                        i == 1 ? "" : ",", shapes[i % 7], i);
    }
    return {{"plain.tbl", plain},
            {"named.tbl", named},
            {"table.json", "{\"Tools\": {" + table + "}}"},
            {"fusion.json", "{\"data\": [" + fusion + "], \"version\": 2}"}};
}

std::vector<std::string> all_programs() {
    std::vector<std::string> paths;
    for (const char* where : {"/assets/programs", "/tests/real/programs"})
        for (const auto& file :
             std::filesystem::directory_iterator(std::string(FEELER_SOURCE_DIR) + where))
            if (file.path().extension() != ".md") paths.push_back(file.path().generic_string());
    std::sort(paths.begin(), paths.end());
    return paths;
}

/// Other programs of many controls; none if they are not on this machine.
std::vector<std::string> shared_programs() {
    const std::filesystem::path folder = std::string(FEELER_SOURCE_DIR) + "/../shared/programs";
    std::vector<std::string> paths;
    std::error_code absent;
    for (const auto& file : std::filesystem::recursive_directory_iterator(folder, absent))
        if (file.is_regular_file() && file.path().extension() != ".tsv")
            paths.push_back(file.path().generic_string());
    std::sort(paths.begin(), paths.end());
    return paths;
}

/// Calls a function with each program and each library.
template <typename See>
void for_each_pair(const std::vector<std::string>& programs, const See& see) {
    const test_support::ScopedFolder folder;
    for (const NamedLibrary& library : libraries()) {
        const std::string path = folder.write(library.name, library.text);
        for (const std::string& program : programs) see(program, path);
    }
}

/// Expects that lengths are the same to the last bit. In inches not each double can be written, so
/// there the last bit may differ.
void expect_same_length(double a, double b, const app::SetupFile& file, const std::string& where) {
    if (file.length_unit == gcode::LengthUnit::mm)
        EXPECT_EQ(a, b) << where;
    else
        EXPECT_NEAR(a, b, 1e-12) << where;
}

void expect_same_parts(const app::SetupFile& file, const core::ToolAssembly& a,
                       const core::ToolAssembly& b, const std::string& where) {
    ASSERT_EQ(a.parts.size(), b.parts.size()) << where;
    for (size_t i = 0; i < a.parts.size(); ++i) {
        const auto &one = a.parts[i].profile.elements, &two = b.parts[i].profile.elements;
        EXPECT_EQ(a.parts[i].kind, b.parts[i].kind) << where;
        ASSERT_EQ(one.size(), two.size()) << where;
        for (size_t k = 0; k < one.size(); ++k) {
            expect_same_length(one[k].z0, two[k].z0, file, where);
            expect_same_length(one[k].z1, two[k].z1, file, where);
            expect_same_length(one[k].r0, two[k].r0, file, where);
            expect_same_length(one[k].r1, two[k].r1, file, where);
        }
        const bool is_exact = file.length_unit == gcode::LengthUnit::mm;
        EXPECT_TRUE(!is_exact || a.parts[i].profile == b.parts[i].profile) << where;
    }
}

void expect_same_tools(const app::SetupFile& a, const app::SetupFile& b, const std::string& about) {
    ASSERT_EQ(a.setup.tools.size(), b.setup.tools.size()) << about;
    for (const auto& [number, tool] : a.setup.tools) {
        const std::string where = fmt::format("tool {}\n{}", core::value_of(number), about);
        const auto found = b.setup.tools.find(number);
        ASSERT_NE(found, b.setup.tools.end()) << where;
        const core::ToolAssembly& other = found->second;
        expect_same_length(tool.length, other.length, a, where);
        expect_same_length(tool.gauge_rise, other.gauge_rise, a, where);
        expect_same_length(tool.description.diameter, other.description.diameter, a, where);
        EXPECT_EQ(tool.reach_is_assumed, other.reach_is_assumed) << where;
        EXPECT_EQ(tool.description.shape, other.description.shape) << where;
        EXPECT_EQ(tool.description.cuts, other.description.cuts) << where;
        EXPECT_EQ(tool.description.length_is_guess, other.description.length_is_guess) << where;
        expect_same_parts(a, tool, other, where);
    }
    EXPECT_EQ(a.environment.guessed_lengths, b.environment.guessed_lengths) << about;
    EXPECT_EQ(a.setup.mesh_size, b.setup.mesh_size) << about;
    const core::Aabb one = core::bounds(a.setup.stock), two = core::bounds(b.setup.stock);
    for (int axis = 0; axis < 3; ++axis) {
        expect_same_length(one.min[axis], two.min[axis], a, about);
        expect_same_length(one.max[axis], two.max[axis], a, about);
    }
}

/// Compares the tools of a library with those of the set-up that is written with it. Returns how
/// many; 0 for a program that cannot be read.
size_t compare_written(const std::string& path, const std::string& library) {
    const auto program = gcode::read_program(path);
    const auto direct = program ? app::infer_setup_with(*program, {}, library)
                                : core::Result<app::SetupFile>(tl::unexpected(program.error()));
    if (!direct) return 0;
    const std::string text = app::setup_text(*direct, {.program = path});
    const auto read = app::completed_setup(text, "p.toml", *program, {});
    EXPECT_TRUE(read) << path << " " << read.error().message << "\n" << text;
    if (read) expect_same_tools(*direct, *read, path + "\n" + text);
    return direct->setup.tools.size();
}

TEST(LibraryTool, OfAWrittenSetupIsThatOfTheLibrary) {
    size_t compared = 0;
    for_each_pair(all_programs(), [&](const std::string& path, const std::string& library) {
        compared += compare_written(path, library);
    });
    EXPECT_GT(compared, 50u);
}

TEST(LibraryTool, OfASetupWrittenForOtherControlsIsThatOfTheLibrary) {
    const std::vector<std::string> programs = shared_programs();
    if (programs.empty()) {
        if (std::getenv("FEELER_REQUIRE_SHARED")) FAIL() << "the shared programs are missing";
        GTEST_SKIP() << "no shared programs here";
    }
    size_t compared = 0;
    for_each_pair(programs, [&](const std::string& path, const std::string& library) {
        compared += compare_written(path, library);
    });
    EXPECT_GT(compared, 200u);
}

/// All that a check finds and measures, to the last bit, but for differences between the tools of
/// the set-up and those that the program names.
std::vector<std::string> result_of(const std::string& program, const std::string& setup,
                                   const std::string& folder) {
    app::CheckJob job{.program = program, .setup = {}, .allowance = {}, .mesh_size = 2.0};
    job.setup = folder + "/p.toml";
    job.setup_text = setup;
    const auto run = app::run_check(job);
    EXPECT_TRUE(run) << program << ": " << run.error().message << "\n" << setup;
    std::vector<std::string> all;
    if (!run) return all;
    for (const core::Finding& finding : run->findings)
        if (finding.rule != core::rule_id("tool-mismatch"))
            all.push_back(fmt::format("{} {} {}", finding.rule, core::name_of(finding.severity),
                                      finding.message));
    for (const app::CheckedBlock& block : run->blocks) {
        const app::ShownClearance bounds = app::shown_clearance(run->setup, block.result);
        all.push_back(
            fmt::format("{} {:a} {:a}", block.line, bounds.lower, bounds.upper.value_or(-1.0)));
    }
    return all;
}

TEST(LibraryTool, ThatIsStatedFindsWhatTheLibraryFinds) {
    size_t stated = 0;
    for_each_pair(all_programs(), [&](const std::string& path, const std::string& library) {
        const auto program = gcode::read_program(path);
        const std::string name = std::filesystem::path(library).filename().generic_string();
        const std::string folder = std::filesystem::path(library).parent_path().generic_string();
        const std::string direct = "tool_library = \"" + name + "\"\n";
        const auto file = app::completed_setup(direct, folder + "/p.toml", *program, {});
        ASSERT_TRUE(file) << path << " " << file.error().message;
        std::string text = direct;
        for (const auto& [number, tool] : file->setup.tools) {
            const auto listed = file->library.find(number);
            const auto used = file->found_tools.find(number);
            if (listed == file->library.end() || used == file->found_tools.end()
                || !used->second.source.starts_with(listed->second.source))
                continue;
            const auto more = app::with_found_tool(text, listed->second);
            ASSERT_TRUE(more) << more.error().message;
            text = *more;
            ++stated;
        }
        if (text == direct) return;
        EXPECT_EQ(result_of(path, direct, folder), result_of(path, text, folder)) << path << "\n"
                                                                                  << text;
    });
    EXPECT_GT(stated, 50u);
}

constexpr const char* two_tools = "G21 G90 G54\nT1 M6\nS8000 M3\nG43 H1 Z5\nG0 X0 Y0\nG1 Z-3 F200\n"
                                  "X40\nY30\nG0 Z5\nT2 M6\nG43 H2 Z5\nX3\nM30\n";

std::string written_with(const std::string& library_name, const std::string& library_text) {
    const test_support::ScopedFolder folder;
    const auto program = gcode::read_program(folder.write("p.nc", two_tools));
    const auto setup =
        app::infer_setup_with(*program, {}, folder.write(library_name, library_text));
    EXPECT_TRUE(setup);
    return setup ? app::setup_text(*setup, {.program = "p.nc"}) : "";
}

TEST(LibraryTool, StatesWhatTheFileGivesAndNoMore) {
    const std::string text = written_with("t.tbl", "T1 P1 D8 Z61.25 ;end mill\nT2 P2 D6 Z40\n");
    EXPECT_THAT(text, HasSubstr("\nshape = \"flat\"\ndiameter = 8\nflute_length = \"unknown\""));
    EXPECT_THAT(text, HasSubstr("\nshank_diameter = \"unknown\""));
    EXPECT_THAT(text, HasSubstr("\nstick_out = \"unknown\""));
    EXPECT_THAT(text, HasSubstr("\ngauge_length = 61.25\n"));
    EXPECT_THAT(text, HasSubstr("number = 2\ndiameter = 6\ngauge_length = 40\n"))
        << "nothing names its shape";
    EXPECT_THAT(text, Not(HasSubstr("\nholder")));
    EXPECT_THAT(text, Not(HasSubstr("\"none\"\n[[tool]]")));
}

TEST(LibraryTool, StatesAHolderThatTheFileGives) {
    const std::string text = written_with("f.json", R"({"data": [
        {"type": "bull nose end mill", "unit": "millimeters",
         "geometry": {"DC": 10, "RE": 1, "LCF": 22, "SFDM": 10, "LB": 45},
         "post-process": {"number": 1},
         "holder": {"unit": "millimeters", "segments": [
             {"height": 30, "lower-diameter": 32, "upper-diameter": 40}]}}]})");
    EXPECT_THAT(text, HasSubstr("\nholder = [[32, 40, 30]]\n"));
    EXPECT_THAT(text, HasSubstr("\nstick_out = 45"));
    EXPECT_THAT(text, Not(HasSubstr("= \"unknown\"      ")));
}

app::SetupSheet sheet_with(const std::string& setup) {
    const test_support::ScopedFolder folder;
    app::CheckJob job;
    job.program = folder.write("p.nc", two_tools);
    job.setup_text = setup;
    const auto check = app::read_check(job);
    EXPECT_TRUE(check) << (check ? "" : check.error().message);
    return check ? app::sheet_of(check->file, check->run.setup) : app::SetupSheet{};
}

TEST(LibraryTool, SizesThatAreUnknownAreShownAsAssumed) {
    const app::SetupSheet sheet =
        sheet_with("[[tool]]\nnumber = 1\nshape = \"ball\"\ndiameter = 8\nflute_length = "
                   "\"unknown\"\nstick_out = 30\n");
    const app::SheetTool* tool = sheet.tool(core::ToolNumber{1});
    ASSERT_TRUE(tool);
    EXPECT_EQ(tool->tool.shape, core::ToolShape::ball);
    EXPECT_EQ(tool->source_of("shape"), app::SetupSource::stated);
    EXPECT_EQ(tool->source_of("stick_out"), app::SetupSource::stated);
    EXPECT_EQ(tool->source_of("flute_length"), app::SetupSource::assumed);
    EXPECT_EQ(tool->source_of("holder"), app::SetupSource::assumed);
    EXPECT_GT(tool->tool.flute_length, 0.0);
}

TEST(LibraryTool, TakesNoOtherWordForASize) {
    const test_support::ScopedFolder folder;
    app::CheckJob job;
    job.program = folder.write("p.nc", two_tools);
    for (const char* value : {"\"none\"", "\"Unknown\"", "\"\"", "true", "[]", "nan"}) {
        job.setup_text = fmt::format("[[tool]]\nnumber = 1\nshape = \"flat\"\ndiameter = 8\n"
                                     "flute_length = {}\n",
                                     value);
        const auto check = app::read_check(job);
        ASSERT_FALSE(check) << value;
        EXPECT_THAT(check.error().message, HasSubstr("flute_length"));
        EXPECT_EQ(check.error().where.line, 5u);
    }
}

} // namespace
} // namespace app_test
