#include <algorithm>
#include <chrono>
#include <fstream>
#include <regex>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "app/base/sha256.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/input_file.h"
#include "app/library/store/input_files.h"
#include "app/setup/program_settings.h"
#include "core/base/file_reads.h"
#include "gcode/language/dialect.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/setup_writer.h"

namespace {

namespace fs = std::filesystem;

using app::InputFile;
using core::FileAccessKind;
using test_support::ScopedFolder;
using test_support::SetupWriter;

app::CheckRun checked(const std::string& program, const std::string& setup,
                      const app::ProgramSettings& settings = {}) {
    app::CheckJob job;
    job.program = program;
    job.setup = setup;
    job.mesh_size = 5.0;
    job.settings = settings;
    auto made = app::run_check(job);
    if (!made) ADD_FAILURE() << made.error().file << ": " << made.error().message;
    return made ? *std::move(made) : app::CheckRun{};
}

std::set<fs::path> contents(const std::vector<InputFile>& inputs) {
    std::set<fs::path> paths;
    for (const InputFile& input : inputs)
        if (input.question == FileAccessKind::content) paths.insert(fs::canonical(input.path));
    return paths;
}

/// Adds the files that a set-up names, and those named in these files: every quoted string that is
/// the path of a file, regardless of keys.
void add_named_files(const fs::path& setup, std::set<fs::path>& named) {
    if (!named.insert(fs::canonical(setup)).second || setup.extension() != ".toml") return;
    const std::string text = test_support::bytes_of(setup);
    const std::regex quoted("\"([^\"\n]+)\"");
    for (std::sregex_iterator at(text.begin(), text.end(), quoted), end; at != end; ++at) {
        const fs::path path = setup.parent_path() / (*at)[1].str();
        if (fs::is_regular_file(path)) add_named_files(path, named);
    }
}

bool all_same(const std::vector<InputFile>& inputs) {
    app::InputAnswers answers;
    return std::all_of(inputs.begin(), inputs.end(),
                       [&](const InputFile& input) { return answers.is_same(input); });
}

/// Expects that a change of any of these files changes the inputs.
void expect_each_counts(const std::set<fs::path>& files, const std::vector<InputFile>& inputs) {
    EXPECT_TRUE(all_same(inputs));
    for (const fs::path& file : files) {
        SCOPED_TRACE(file);
        const std::string before = test_support::bytes_of(file);
        std::string after = before;
        after.back() = static_cast<char>(after.back() ^ 1);
        std::ofstream(file, std::ios::binary) << after;
        EXPECT_FALSE(all_same(inputs));
        std::ofstream(file, std::ios::binary) << before;
    }
    EXPECT_TRUE(all_same(inputs));
}

/// Every set-up of the repository, with the first program that a check can start with.
TEST(InputFiles, HoldEveryFileThatASampleSetupNames) {
    const fs::path root = FEELER_SOURCE_DIR;
    const ScopedFolder folder;
    fs::copy(root / "assets", folder / "assets", fs::copy_options::recursive);
    fs::create_directories(folder / "tests/planted");
    fs::copy(root / "tests/planted/setups", folder / "tests/planted/setups",
             fs::copy_options::recursive);
    fs::copy(root / "tests/planted/meshes", folder / "tests/planted/meshes",
             fs::copy_options::recursive);
    const std::string program = folder.write("short.nc", "G21 G90 G54\nM2\n");
    size_t setups = 0, files = 0;
    for (const char* where : {"assets/setups", "tests/planted/setups"}) {
        for (const fs::directory_entry& entry : fs::directory_iterator(folder / where)) {
            if (entry.path().extension() != ".toml") continue;
            SCOPED_TRACE(entry.path());
            std::set<fs::path> named{fs::canonical(program)};
            add_named_files(entry.path(), named);
            const std::vector<InputFile> inputs = checked(program, entry.path()).inputs;
            EXPECT_EQ(contents(inputs), named);
            expect_each_counts(named, inputs);
            ++setups;
            files += named.size();
        }
    }
    EXPECT_GE(setups, 10u);
    EXPECT_GE(files, 40u);
}

/// A job with every kind of file that can be read.
class EveryKind : public testing::Test {
protected:
    EveryKind() {
        const std::string assets = std::string(FEELER_SOURCE_DIR) + "/assets/";
        folder.write("box.obj", "v 0 0 0\nv 9 0 0\nv 9 9 0\nv 0 9 0\nv 0 0 9\nv 9 0 9\nv 9 9 9\n"
                                "v 0 9 9\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\n"
                                "f 4 1 5 8\n");
        folder.write("holders.toml", test_support::bytes_of(assets + "holders/bt40.toml"));
        folder.write("sub.ngc", "o<sub> sub\nG0 X1\no<sub> endsub\nM2\n");
        folder.write("control.var", "5221 -350\n");
        folder.write("control.tbl", "T5 Z80 D8 ;ball end mill\n");
        folder.write("control.ini", "[RS274NGC]\nPARAMETER_FILE = control.var\n[EMCIO]\n"
                                    "TOOL_TABLE = control.tbl\n[TRAJ]\nLINEAR_UNITS = mm\n");
        folder.write("tools.fctl", R"({"tools": [{"nr": 7, "path": "bit.fctb"}], "version": 1})");
        folder.write("bit.fctb", R"({"name": "end mill", "shape": "endmill.fcstd",
                                     "parameter": {"Diameter": "6 mm", "CuttingEdgeHeight": "20 mm",
                                     "Length": "50 mm", "ShankDiameter": "6 mm"}})");
        folder.write("job.toml",
                     SetupWriter()
                         .root("tool_library = \"tools.fctl\"\n")
                         .also_tool("number = 2\nshape = \"flat\"\ndiameter = 10\n"
                                    "flute_length = 20\nshank = [[10, 10, 25]]\n"
                                    "holder = \"BT40-ER32\"\nholder_file = \"holders.toml\"\n")
                         .fixture("post", "mesh = \"box.obj\"\nat = [-60, 0, 0]")
                         .text());
        program = folder.write("job.ngc", "G21 G90 G54\nG0 Z50\no<sub> call\nM2\n");
        settings.ini = folder / "control.ini";
        settings.dialect = gcode::DialectId::linuxcnc;
    }

    const ScopedFolder folder;
    std::string program;
    app::ProgramSettings settings;
};

TEST_F(EveryKind, IsAnInput) {
    const app::CheckRun made = checked(program, folder / "job.toml", settings);
    ASSERT_FALSE(made.stopped) << made.stopped->message;
    std::set<fs::path> wanted;
    for (const char* name : {"job.ngc", "sub.ngc", "job.toml", "box.obj", "holders.toml",
                             "control.ini", "control.var", "control.tbl", "tools.fctl", "bit.fctb"})
        wanted.insert(fs::canonical(folder / name));
    EXPECT_EQ(contents(made.inputs), wanted);
    expect_each_counts(wanted, made.inputs);
    EXPECT_EQ(made.sha256, app::sha256_of_file(program));
}

TEST_F(EveryKind, AFileThatWasLookedForInVainCountsWhenItComes) {
    fs::remove(folder / "control.var");
    fs::create_directories(folder / "first");
    settings.search_path = {folder / "first", folder.path()};
    const app::CheckRun made = checked(program, folder / "job.toml", settings);
    ASSERT_FALSE(made.stopped) << made.stopped->message;
    EXPECT_TRUE(all_same(made.inputs));
    folder.write("control.var", "5221 -351\n");
    EXPECT_FALSE(all_same(made.inputs));
    fs::remove(folder / "control.var");
    EXPECT_TRUE(all_same(made.inputs));
    folder.write("first/sub.ngc", "o<sub> sub\no<sub> endsub\nM2\n");
    EXPECT_FALSE(all_same(made.inputs));
}

TEST(InputFiles, ASubprogramFoundInAnotherCaseIsAnInputByItsName) {
    const ScopedFolder folder;
    const std::string program = folder.write("main.mpf", "G71 G90 G54\nG0 Z50\nPOCKET\nM30\n");
    folder.write("Pocket.spf", "G0 X1\nM17\n");
    app::ProgramSettings settings;
    settings.dialect = gcode::DialectId::siemens;
    const std::string setup = folder.write("job.toml", SetupWriter().text());
    const app::CheckRun made = checked(program, setup, settings);
    ASSERT_FALSE(made.stopped) << made.stopped->message;
    EXPECT_EQ(contents(made.inputs).count(fs::canonical(folder / "Pocket.spf")), 1u);
    EXPECT_TRUE(all_same(made.inputs));
    folder.write("POCKET.SPF", "G0 X2\nM17\n");
    EXPECT_FALSE(all_same(made.inputs));
}

TEST(InputFiles, WhatCannotBeReadIsNeverTheSame) {
    const ScopedFolder folder;
    InputFile input{FileAccessKind::content, folder / "none", {}, std::nullopt};
    EXPECT_FALSE(all_same({input}));
    input.answer = "";
    EXPECT_FALSE(all_same({input}));
}

TEST(InputAnswers, ReadAFileAgainThatWasWrittenSince) {
    const ScopedFolder folder;
    const std::string path = folder.write("a.nc", "G0 X1\n");
    app::InputAnswers answers;
    const InputFile input{FileAccessKind::content, path, {}, app::sha256_of_file(path)};
    const InputFile in_any_case{FileAccessKind::any_case, folder.path(), "O1", std::nullopt};
    for (const int pause : {0, 80, 0}) {
        std::this_thread::sleep_for(std::chrono::milliseconds(pause)); // clock: at least
        EXPECT_TRUE(answers.is_same(input));
        EXPECT_TRUE(answers.is_same(in_any_case));
    }
    folder.write("a.nc", "G0 X2\n"); // the same length as before
    EXPECT_FALSE(answers.is_same(input));
    folder.write("o1", "");
    EXPECT_FALSE(answers.is_same(in_any_case));
    folder.write("a.nc", "G0 X1\n");
    std::filesystem::remove(folder / "o1");
    EXPECT_TRUE(answers.is_same(input));
    EXPECT_TRUE(answers.is_same(in_any_case));
}

} // namespace
