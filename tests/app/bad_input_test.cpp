#include <algorithm>

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/app/checked.h"
#include "tests/support/meshes.h"
#include "tests/support/program_writer.h"
#include "tests/support/stl_writer.h"

namespace app_test {
namespace {

using test_support::program;
using test_support::Ran;
using test_support::ScopedFolder;
using test_support::SetupWriter;

/// A folder with a valid program, a valid set-up that names a mesh, and an old report.
class BadInput : public testing::Test {
protected:
    void SetUp() override {
        clamp = test_support::binary_stl(test_support::box_mesh({0, 0, 0}, {20, 26, 42}));
        folder.write("clamp.stl", clamp);
        folder.write("good.nc", program({"G0 X-20. Y50.", "Z-5."}));
        folder.write(
            "good.toml",
            SetupWriter().fixture("clamp-1", "mesh = \"clamp.stl\"\nat = [40, 104, 0]").text());
        folder.write("old.txt", "old report\n");
        files = folder.names().size();
    }

    Ran check(const std::string& program_file, const std::string& setup_file,
              std::vector<std::string> more = {}, const std::string& before = "") const {
        std::vector<std::string> words = {"check",   folder / program_file,
                                          "--setup", folder / setup_file,
                                          "-o",      folder / "old.txt"};
        words.insert(words.end(), more.begin(), more.end());
        return feeler(words, before);
    }

    /// Expects exit status 2, one line on standard error with these words, and no standard output.
    void expect_refused(const Ran& ran, const std::vector<std::string>& words) const {
        EXPECT_EQ(ran.status, 2) << ran.err;
        EXPECT_EQ(ran.out, "");
        EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
        for (const std::string& word : words)
            EXPECT_NE(ran.err.find(word), std::string::npos) << word << " in: " << ran.err;
        expect_folder_untouched();
    }

    void expect_folder_untouched() const {
        EXPECT_EQ(folder.names().size(), files) << "something was left over";
        EXPECT_EQ(test_support::bytes_of(folder / "old.txt"), "old report\n");
    }

    void expect_program_refused(const std::string& bytes, const std::vector<std::string>& words) {
        folder.write("bad.nc", bytes);
        files = folder.names().size();
        expect_refused(check("bad.nc", "good.toml"), words);
    }

    void expect_mesh_refused(const std::string& bytes, const std::vector<std::string>& words) {
        folder.write("clamp.stl", bytes);
        std::vector<std::string> all = {"good.toml:", "clamp.stl"};
        all.insert(all.end(), words.begin(), words.end());
        expect_refused(check("good.nc", "good.toml"), all);
    }

    ScopedFolder folder;
    std::string clamp;
    size_t files = 0;
};

TEST_F(BadInput, IsNotThereInTheGoodFiles) {
    const Ran ran = check("good.nc", "good.toml");
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_EQ(ran.out, "");
    EXPECT_NE(test_support::bytes_of(folder / "old.txt"), "old report\n");
    EXPECT_EQ(folder.names().size(), files);
}

TEST_F(BadInput, OfAMissingProgram) {
    expect_refused(check("nope.nc", "good.toml"), {"nope.nc", "No such file"});
}

TEST_F(BadInput, OfAFolderWithoutPrograms) {
    std::filesystem::create_directory(folder / "empty");
    files = folder.names().size();
    expect_refused(check("empty", "good.toml"), {"empty", "contains no NC program"});
}

TEST_F(BadInput, OfAnEmptyProgram) { expect_program_refused("", {"bad.nc", "no blocks"}); }

TEST_F(BadInput, OfABinaryProgram) {
    expect_program_refused(clamp, {"bad.nc:1", "NUL"});
    expect_program_refused(std::string("G0 X1\nG1 Y\0", 11), {"bad.nc:2", "NUL"});
}

TEST_F(BadInput, OfAProgramOfOneLineThatDoesNotEnd) {
    folder.write("bad.nc", "");
    files = folder.names().size();
    std::filesystem::resize_file(folder / "bad.nc", 1ULL << 30);
    expect_refused(check("bad.nc", "good.toml", {}, "ulimit -v 1000000;"), {"bad.nc:1"});
    expect_program_refused(std::string(10'000'000, '('), {"bad.nc:1", "65536 characters"});
}

TEST_F(BadInput, OfAnUnreadableProgram) {
    if (::geteuid() == 0) GTEST_SKIP() << "root can read every file";
    std::filesystem::permissions(folder / "good.nc", std::filesystem::perms::none);
    expect_refused(check("good.nc", "good.toml"), {"good.nc", "ermission"});
}

TEST_F(BadInput, OfAMissingSetup) {
    expect_refused(check("good.nc", "nope.toml"), {"nope.toml", "no such"});
}

TEST_F(BadInput, OfAFolderForASetup) { expect_refused(check("good.nc", "."), {"is a folder"}); }

TEST_F(BadInput, OfAMissingMesh) {
    std::filesystem::remove(folder / "clamp.stl");
    --files;
    expect_refused(check("good.nc", "good.toml"), {"good.toml:", "clamp.stl", "no such file"});
}

TEST_F(BadInput, OfATruncatedMesh) {
    expect_mesh_refused(clamp.substr(0, clamp.size() - 20), {"triangles"});
    expect_mesh_refused(clamp.substr(0, 60), {});
    expect_mesh_refused("", {});
}

TEST_F(BadInput, OfAMeshWithACornerThatIsNotANumber) {
    std::string bytes = clamp;
    bytes.replace(84 + 12, 4, std::string("\x00\x00\xc0\x7f", 4));
    expect_mesh_refused(bytes, {});
}

TEST_F(BadInput, OfAnOpenMesh) {
    core::Mesh open = test_support::box_mesh({0, 0, 0}, {20, 26, 42});
    open.triangles.pop_back();
    expect_mesh_refused(test_support::binary_stl(open), {});
}

TEST_F(BadInput, OfAnUnknownCodeReportsWhatCameBeforeIt) {
    folder.write("bad.nc", "G21 G90 G54\nT1 M6\nG0 G43 H1 Z60.\nG0 X5. G777\nG0 X9.\n");
    files = folder.names().size();
    const Ran ran = check("bad.nc", "good.toml", {"--blocks"});
    EXPECT_EQ(ran.status, 2);
    EXPECT_NE(ran.err.find("bad.nc:4:8: G777"), std::string::npos) << ran.err;
    EXPECT_NE(ran.out.find("STOPPED"), std::string::npos);
    EXPECT_NE(ran.out.find("G0 G43 H1 Z60."), std::string::npos);
    EXPECT_EQ(ran.out.find("G0 X9."), std::string::npos);
    expect_folder_untouched();
}

TEST_F(BadInput, OfAnUnknownCodeShowsNoPageOnTheScreen) {
    folder.write("bad.nc", "G21 G90 G54\nT1 M6\nG0 G43 H1 Z60.\nG0 X5. G777\n");
    files = folder.names().size();
    for (const char* form : {"html", "json", "csv"}) {
        const Ran ran = check("bad.nc", "good.toml", {"--format", form});
        EXPECT_EQ(ran.status, 2);
        EXPECT_EQ(ran.out.rfind(folder / "bad.nc: STOPPED", 0), 0U) << ran.out.substr(0, 200);
        expect_folder_untouched();
    }
}

TEST_F(BadInput, OfAMeshSizeThatMemoryWouldNotHold) {
    for (const char* size : {"0.001", "1e-9", "1e-300"})
        expect_refused(check("good.nc", "good.toml", {"--mesh-size", size}),
                       {"a mesh size of", "would do"});
}

TEST_F(BadInput, OfAMeshSizeLargerThanTheStock) {
    for (const char* size : {"1000", "1e300"})
        expect_refused(check("good.nc", "good.toml", {"--mesh-size", size}),
                       {"larger than the body"});
}

TEST_F(BadInput, OfAReportIntoAFolderThatIsNotThere) {
    const Ran ran = feeler({"check", folder / "good.nc", "--setup", folder / "good.toml", "-o",
                            folder / "no/such.txt"});
    expect_refused(ran, {"no/such.txt", "cannot be written"});
}

TEST_F(BadInput, OfAReportOntoAFolder) {
    std::filesystem::create_directory(folder / "reports");
    files = folder.names().size();
    const Ran ran = feeler(
        {"check", folder / "good.nc", "--setup", folder / "good.toml", "-o", folder / "reports"});
    expect_refused(ran, {"reports"});
    EXPECT_TRUE(std::filesystem::is_empty(folder / "reports"));
}

TEST_F(BadInput, OfAReportIntoAReadOnlyFolder) {
    const Ran ran = feeler(
        {"check", folder / "good.nc", "--setup", folder / "good.toml", "-o", "/proc/report.txt"});
    expect_refused(ran, {"/proc/report.txt", "cannot be written"});
}

TEST_F(BadInput, OfAFullDiskUnderStandardOutput) {
    const Ran ran =
        test_support::run({"sh", "-c", "exec \"$0\" \"$@\" >/dev/full", FEELER_BINARY, "check",
                           folder / "good.nc", "--setup", folder / "good.toml"});
    EXPECT_EQ(ran.status, 2);
    EXPECT_NE(ran.err.find("standard output: cannot be written"), std::string::npos) << ran.err;
}

} // namespace
} // namespace app_test
