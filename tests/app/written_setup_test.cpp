#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/setup/coverage.h"
#include "app/setup/inference/inferred_setup.h"
#include "app/setup/setup_file.h"
#include "app/setup/setup_text.h"
#include "core/base/rule_table.h"
#include "gcode/language/modal_state.h"
#include "gcode/text/source.h"
#include "tests/app/bare_programs.h"
#include "tests/support/scoped_folder.h"

/// What `feeler setup` writes: it states only what is known, and its other lines can be
/// uncommented.

namespace app_test {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string written_setup(const std::string& path) {
    const auto program = gcode::read_program(path);
    const auto setup = app::infer_setup(*program, {});
    EXPECT_TRUE(setup) << path;
    return setup ? app::setup_text(*setup, {.program = path}) : "";
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    for (size_t at = 0; at < text.size();) {
        const size_t end = text.find('\n', at);
        lines.push_back(text.substr(at, end - at));
        at = end + 1;
    }
    return lines;
}

bool is_option(const std::string& line) {
    return line.size() > 1 && line[0] == '#' && line[1] != ' ';
}

/// The paragraphs of a text, each with its lines.
std::vector<std::vector<std::string>> paragraphs_of(const std::string& text) {
    std::vector<std::vector<std::string>> all(1);
    for (const std::string& line : lines_of(text))
        if (line.empty())
            all.emplace_back();
        else
            all.back().push_back(line);
    return all;
}

/// The text with the options of the chosen paragraphs in force.
template <typename Choose>
std::string with_options(const std::string& text, const Choose& choose) {
    std::string changed;
    size_t paragraph = 0;
    for (const std::string& line : lines_of(text)) {
        if (line.empty()) ++paragraph;
        const bool is_chosen = is_option(line) && choose(paragraph, line);
        changed += (is_chosen ? line.substr(1) : line) + "\n";
    }
    return changed;
}

app::CheckRun run_of(const std::string& program, const std::optional<std::string>& setup) {
    auto run = app::run_check(
        {.program = program, .setup = {}, .allowance = {}, .mesh_size = {}, .setup_text = setup});
    EXPECT_TRUE(run) << program << ": " << run.error().message << "\n" << setup.value_or("");
    return run ? *std::move(run) : app::CheckRun{};
}

std::vector<std::string> findings_of(const app::CheckRun& run) {
    std::vector<std::string> all;
    for (const core::Finding& finding : run.findings)
        all.push_back(fmt::format("{} {} {} {}", finding.rule, core::name_of(finding.severity),
                                  core::value_of(finding.block.value_or(core::BlockIndex{})),
                                  finding.message));
    return all;
}

/// The findings that a check does not have without its set-up, but for those that compare the
/// program with what the set-up describes.
std::vector<std::string> new_findings(const app::CheckRun& run, const app::CheckRun& bare) {
    const std::vector<std::string> known = findings_of(bare);
    std::vector<std::string> all = findings_of(run);
    std::erase_if(all, [&](const std::string& finding) {
        return std::find(known.begin(), known.end(), finding) != known.end()
               || finding.starts_with("open-premise") || finding.starts_with("offset-implausible");
    });
    return all;
}

std::vector<std::string> programs() {
    std::vector<std::string> paths;
    for (const std::string where :
         {FEELER_SOURCE_DIR "/assets/programs", FEELER_SOURCE_DIR "/tests/real/programs"})
        for (const auto& file : std::filesystem::directory_iterator(where))
            if (file.path().extension() != ".md") paths.push_back(file.path().generic_string());
    std::sort(paths.begin(), paths.end());
    return paths;
}

/// Calls a function with the path of each program, real and written for the purpose.
template <typename See>
void for_each_program(const See& see) {
    for (const std::string& path : programs()) see(path);
    for (const char* text : bare_programs) {
        const test_support::ScopedFolder folder;
        see(folder.write("p.nc", text));
    }
}

TEST(WrittenSetup, ChangesNothing) {
    for_each_program([](const std::string& path) {
        const std::string text = written_setup(path);
        const app::CheckRun bare = run_of(path, {}), stated = run_of(path, text);
        EXPECT_EQ(findings_of(bare), findings_of(stated)) << path << "\n" << text;
        EXPECT_EQ(bare.verdict, stated.verdict) << path;
        EXPECT_EQ(*bare.coverage, *stated.coverage) << path;
        EXPECT_EQ(bare.setup.mesh_size, stated.setup.mesh_size) << path;
    });
}

/// The programs in inches, those of the shared collection included, if it is there.
std::vector<std::string> programs_in_inches() {
    std::vector<std::string> paths = programs();
    const std::filesystem::path shared = FEELER_SOURCE_DIR "/../shared/programs";
    if (std::filesystem::exists(shared)) {
        for (const auto& file : std::filesystem::recursive_directory_iterator(shared))
            if (file.is_regular_file()) paths.push_back(file.path().generic_string());
    } else {
        EXPECT_FALSE(std::getenv("FEELER_REQUIRE_SHARED")) << shared << " is missing";
    }
    std::erase_if(paths, [](const std::string& path) {
        const auto program = gcode::read_program(path);
        const auto setup =
            program ? app::infer_setup(*program, {}) : core::Result<app::SetupFile>();
        return !program || !setup || setup->length_unit != gcode::LengthUnit::inch;
    });
    std::sort(paths.begin(), paths.end());
    return paths;
}

void expect_same_blocks(const app::CheckRun& a, const app::CheckRun& b, const std::string& where) {
    ASSERT_EQ(a.blocks.size(), b.blocks.size()) << where;
    for (size_t i = 0; i < a.blocks.size(); ++i) {
        const core::BlockResult one = a.blocks[i].result, two = b.blocks[i].result;
        ASSERT_EQ(one.verdict, two.verdict) << where << i;
        ASSERT_EQ(one.removed, two.removed) << where << i;
        ASSERT_EQ(one.pairs.size(), two.pairs.size()) << where << i;
        for (size_t k = 0; k < one.pairs.size(); ++k) {
            ASSERT_EQ(one.pairs[k].lower, two.pairs[k].lower) << where << i;
            ASSERT_EQ(one.pairs[k].upper, two.pairs[k].upper) << where << i;
        }
    }
}

/// The set-up is in inches, too, and what it states is exact: every clearance has the same bits.
TEST(WrittenSetup, ChangesNoBitOfProgramsInInches) {
    size_t count = 0;
    for (const std::string& path : programs_in_inches()) {
        const std::string text = written_setup(path);
        EXPECT_THAT(text, HasSubstr("\nlength_unit = \"inch\"")) << path;
        EXPECT_THAT(text, Not(HasSubstr(" mm"))) << path;
        const auto bare = app::run_check({.program = path, .setup = {}, .allowance = {}});
        if (!bare) continue; // a program that cannot be read to its end
        const app::CheckRun stated = run_of(path, text);
        EXPECT_EQ(findings_of(*bare), findings_of(stated)) << path << "\n" << text;
        EXPECT_EQ(bare->verdict, stated.verdict) << path;
        EXPECT_EQ(*bare->coverage, *stated.coverage) << path;
        expect_same_blocks(*bare, stated, path);
        ++count;
    }
    EXPECT_GE(count, std::getenv("FEELER_REQUIRE_SHARED") ? 10u : 1u);
}

TEST(WrittenSetup, FitsOnAScreenAndHasRoundNumbers) {
    const std::string text = written_setup(FEELER_SOURCE_DIR "/assets/programs/TEST_G90.NC");
    EXPECT_LE(lines_of(text).size(), 60u) << text;
    for_each_program([](const std::string& path) {
        const std::string all = written_setup(path);
        for (const std::string& line : lines_of(all)) EXPECT_LE(line.size(), 100u) << line;
        EXPECT_THAT(all, Not(HasSubstr("00000"))) << path;
        EXPECT_THAT(all, Not(HasSubstr("99999"))) << path;
        EXPECT_THAT(all, Not(HasSubstr("assumed = ["))) << path;
    });
}

/// Each paragraph by itself, and all of them, can be put in force.
TEST(WrittenSetup, HasOptionsThatCanBeUncommented) {
    for_each_program([](const std::string& path) {
        const std::string text = written_setup(path);
        const app::CheckRun bare = run_of(path, {});
        const auto all = paragraphs_of(text);
        for (size_t i = 0; i < all.size(); ++i) {
            if (std::none_of(all[i].begin(), all[i].end(), is_option)) continue;
            const std::string changed =
                with_options(text, [&](size_t at, const std::string&) { return at == i; });
            const app::CheckRun run = run_of(path, changed);
            // With a holder, the name of a tool, or a stock, more may be found.
            const bool is_tool =
                std::find(all[i].begin(), all[i].end(), "[[tool]]") != all[i].end();
            if (is_tool) continue;
            EXPECT_THAT(new_findings(run, bare), testing::IsEmpty()) << path << changed;
        }
        const std::string everything = with_options(
            text, [](size_t, const std::string& line) { return !line.starts_with("#fixtures"); });
        const app::CheckRun run = run_of(path, everything);
        EXPECT_EQ(run.coverage->fixtures, app::Known::described) << path;
        EXPECT_EQ(run.coverage->holders, app::Known::described) << path << everything;
    });
}

/// Each line of a tool can be put in force alone, and changes nothing then.
TEST(WrittenSetup, StatesEachSizeOfAToolByItself) {
    for_each_program([](const std::string& path) {
        const std::string text = written_setup(path);
        const app::CheckRun bare = run_of(path, {});
        const auto all = paragraphs_of(text);
        for (size_t i = 0; i < all.size(); ++i) {
            if (std::find(all[i].begin(), all[i].end(), "[[tool]]") == all[i].end()) continue;
            for (const std::string& option : all[i]) {
                if (!is_option(option) || option.starts_with("#holder")
                    || option.starts_with("#name"))
                    continue;
                const std::string changed =
                    with_options(text, [&](size_t at, const std::string& line) {
                        return at == i && line == option;
                    });
                EXPECT_EQ(findings_of(bare), findings_of(run_of(path, changed))) << path << option;
            }
        }
    });
}

std::string written_for(const std::string& program) {
    const test_support::ScopedFolder folder;
    return written_setup(folder.write("p.nc", program));
}

TEST(WrittenSetup, StatesWhatTheProgramStates) {
    const std::string text = written_for(bare_programs[0]);
    EXPECT_THAT(text, HasSubstr("\ndialect = \"fanuc\"\n"));
    EXPECT_THAT(text, HasSubstr("[[tool]]\nnumber = 3\ndiameter = 6\n"));
    EXPECT_THAT(text, HasSubstr("\n#flute_length = 18\n"));
    EXPECT_THAT(text, HasSubstr("[[tool]]\nnumber = 4\n#diameter = 6\n"));
    EXPECT_THAT(text, HasSubstr("\n#G54 = "));
    EXPECT_THAT(text, Not(HasSubstr("G55")));
    EXPECT_THAT(text, HasSubstr("\n#box = [["));
    EXPECT_THAT(text, Not(HasSubstr("touched_off")));
    const std::string block = written_for("0 BEGIN PGM A MM\n1 BLK FORM 0.1 Z X+0 Y+0 Z-20\n"
                                          "2 BLK FORM 0.2 X+50 Y+40 Z+0\n3 TOOL CALL 1 Z S1000\n"
                                          "4 L Z+50 R0 FMAX M3\n5 L X+10 Y+10 FMAX\n6 L Z+2 FMAX\n"
                                          "7 L Z-3 F100\n8 L X+40 F200\n9 L Z+50 FMAX\n"
                                          "10 END PGM A MM\n");
    EXPECT_THAT(block, HasSubstr("\nbox = [[0, 0, -20], [50, 40, 0]]\n"));
}

TEST(WrittenSetup, IsInInchesForAProgramInInches) {
    const std::string program = "G20 G90 G54\n(T1 D=0.5 CR=0. - ZMIN=-.25 - FLAT END MILL)\nT1 M6\n"
                                "S3000 M3\nG43 H1 Z2\nG0 X0 Y0\nZ.1\nG1 Z-.25 F10\nX3.125\nY1.5\n"
                                "G0 Z2\nM30\n";
    const std::string text = written_for(program);
    EXPECT_THAT(text, HasSubstr("\nlength_unit = \"inch\" "));
    EXPECT_THAT(text, HasSubstr("[[tool]]\nnumber = 1\ndiameter = 0.5\n"));
    EXPECT_THAT(text, HasSubstr("\n#flute_length = 1.5\n"));
    EXPECT_THAT(text, HasSubstr("\n#box = [[-0.25, -0.25, -0.32874], [3.375, 1.75, 0]]\n"));
    EXPECT_THAT(text, HasSubstr("X -0.2500 to 3.3750, Y"));
    EXPECT_THAT(text, HasSubstr("\n#box = [[-1, -1, -2], [4, 2, -1]]\n"));
    EXPECT_THAT(text, HasSubstr("(inches/min)"));
    EXPECT_THAT(written_for("G21" + program.substr(3)), Not(HasSubstr("length_unit")));
}

TEST(WrittenSetup, UsesTheWorkOffsetOfTheProgram) {
    const std::string text = written_for(bare_programs[2]);
    EXPECT_THAT(text, HasSubstr("\n#G55 = "));
    EXPECT_THAT(text, HasSubstr("\n#frame = \"G55\""));
    EXPECT_THAT(text, Not(HasSubstr("G54")));
}

} // namespace
} // namespace app_test
