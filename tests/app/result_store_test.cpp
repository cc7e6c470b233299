#include <fstream>

#include <gtest/gtest.h>

#include "app/base/sha256.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/input_file.h"
#include "app/library/store/database.h"
#include "app/library/store/result_key.h"
#include "app/library/store/result_store.h"
#include "app/library/store/store_file.h"
#include "core/base/file_reads.h"
#include "gcode/language/dialect.h"
#include "tests/support/scoped_folder.h"

namespace {

namespace fs = std::filesystem;

using app::CheckJob;
using app::CheckRun;
using app::ProgramResult;
using app::ResultStore;
using core::FileAccessKind;
using test_support::ScopedFolder;

app::InputFile content(const std::string& path) {
    return {FileAccessKind::content, path, {}, app::sha256_of_file(path)};
}

ResultStore opened(const std::string& path, const std::string& version = "1") {
    auto store = ResultStore::open(path, version);
    if (!store) throw std::runtime_error(store.error().message);
    return *std::move(store);
}

/// A program and a mesh, the files that a check of them has read, and its assumed result.
class StoredResultTest : public testing::Test {
protected:
    StoredResultTest() {
        job.program = folder.write("a.nc", "G0 X1\n");
        job.setup = folder.write("job.toml", "mesh_size = 1\n");
        folder.write("vise.stl", "solid");
        run.sha256 = app::sha256_of_file(job.program);
        run.inputs = {content(job.program),
                      content(job.setup),
                      content(folder / "vise.stl"),
                      {FileAccessKind::presence, folder / "control.var", {}, std::nullopt},
                      {FileAccessKind::in_folder, folder.path(), "O9000.nc", std::nullopt},
                      {FileAccessKind::any_case, folder.path(), "POCKET.SPF", std::nullopt}};
        result.program = job.program;
        result.setup = job.setup;
        result.sha256 = run.sha256;
        result.cycle_time = 0.1 + 0.2;
        result.assumptions = {"ein \"Maß\""};
    }

    void keep() {
        ResultStore store = opened(path);
        const auto kept = store.keep(job, run, result);
        EXPECT_TRUE(kept) << kept.error().message;
        const auto written = store.flush();
        EXPECT_TRUE(written) << written.error().message;
    }

    std::optional<ProgramResult> found(const CheckJob& asked) {
        const auto answer = opened(path).find(asked);
        EXPECT_TRUE(answer) << answer.error().message;
        return answer ? *answer : std::nullopt;
    }

    const ScopedFolder folder;
    const std::string path = folder / "results.db";
    CheckJob job;
    CheckRun run;
    ProgramResult result;
};

TEST_F(StoredResultTest, IsFoundAgainToTheLastBit) {
    EXPECT_EQ(found(job), std::nullopt);
    keep();
    EXPECT_EQ(found(job), result);
}

TEST_F(StoredResultTest, IsNotFoundAfterAChangeOfAnyInput) {
    keep();
    for (const char* name : {"a.nc", "job.toml", "vise.stl"}) {
        SCOPED_TRACE(name);
        const std::string before = test_support::bytes_of(folder / name);
        folder.write(name, before + "\n");
        EXPECT_EQ(found(job), std::nullopt);
        fs::remove(folder / name);
        EXPECT_EQ(found(job), std::nullopt);
        folder.write(name, before);
        EXPECT_EQ(found(job), result);
    }
    folder.write("job.toml", "length_unit = \"inch\"\nmesh_size = 1\n");
    EXPECT_EQ(found(job), std::nullopt) << "the same numbers in inches";
    folder.write("job.toml", "mesh_size = 1\n");
    for (const char* name : {"control.var", "O9000.nc", "Pocket.spf"}) {
        SCOPED_TRACE(name);
        folder.write(name, "%");
        EXPECT_EQ(found(job), std::nullopt);
        fs::remove(folder / name);
        EXPECT_EQ(found(job), result);
    }
}

TEST_F(StoredResultTest, IsNotFoundForOtherOptionsOrByAnotherVersion) {
    keep();
    std::vector<CheckJob> others(8, job);
    others[0].allowance = 2.0;
    others[1].mesh_size = 0.25;
    others[2].detail = core::Detail::verdict;
    others[3].engine = app::Engine::coprocessor;
    others[4].start_line = "N20";
    others[5].settings.dialect = gcode::DialectId::haas;
    others[6].settings.start[2] = 0.0;
    others[7].setup.clear();
    for (size_t i = 0; i < others.size(); ++i) EXPECT_EQ(found(others[i]), std::nullopt) << i;
    EXPECT_EQ(*opened(path, "2").find(job), std::nullopt);
    CheckJob roomier = job;
    roomier.memory_limit = 1e9;
    EXPECT_EQ(found(roomier), result);
}

TEST_F(StoredResultTest, BothVersionsOfASetupThatAlternatesAreStored) {
    keep();
    folder.write("job.toml", "mesh_size = 2\n");
    run.inputs[1] = content(job.setup);
    ProgramResult second = result;
    second.verdict = core::Verdict::collision;
    {
        const auto kept = opened(path).keep(job, run, second);
        ASSERT_TRUE(kept) << kept.error().message;
    }
    EXPECT_EQ(found(job), second);
    folder.write("job.toml", "mesh_size = 1\n");
    EXPECT_EQ(found(job), result);
    const auto versions = opened(path).history(job.program);
    ASSERT_TRUE(versions);
    ASSERT_EQ(versions->size(), 2u);
    EXPECT_EQ((*versions)[0].result, second);
    EXPECT_EQ((*versions)[1].result, result);
    EXPECT_NE((*versions)[0].inputs, (*versions)[1].inputs);
}

TEST_F(StoredResultTest, HistoryEndsWithTheLatestResult) {
    keep();
    const ProgramResult first = result;
    folder.write("a.nc", "G0 X2\n");
    run.sha256 = result.sha256 = app::sha256_of_file(job.program);
    run.inputs[0] = content(job.program);
    keep();
    EXPECT_EQ(opened(path).history(job.program)->back().result, result);
    folder.write("a.nc", "G0 X1\n");
    EXPECT_EQ(found(job), first);
    const auto versions = opened(path).history(job.program);
    ASSERT_EQ(versions->size(), 2u);
    const app::StoredVersion& last = versions->back();
    EXPECT_EQ(last.result, first);
    EXPECT_GT(last.seen_at, versions->front().seen_at);
    EXPECT_EQ(*opened(path).seen_at(last), last.seen_at);
}

TEST_F(StoredResultTest, IsOneRowHoweverOftenItIsStored) {
    keep();
    keep();
    EXPECT_EQ(opened(path).history(job.program)->size(), 1u);
}

TEST_F(StoredResultTest, HistoryIsTheSameFromAnyWorkingFolder) {
    keep();
    const fs::path before = fs::current_path();
    fs::current_path(folder.path());
    const auto versions = opened("results.db").history("./a.nc");
    fs::current_path(before);
    ASSERT_TRUE(versions);
    EXPECT_EQ(versions->size(), 1u);
}

TEST_F(StoredResultTest, StoppedRunsAreNotStored) {
    run.stopped = core::Error{core::ErrorCode::io, {}, "the check was stopped after this block"};
    keep();
    EXPECT_EQ(found(job), std::nullopt);
    run.stopped = core::Error{core::ErrorCode::syntax, {}, "X has no number"};
    keep();
    EXPECT_EQ(found(job), result);
}

TEST_F(StoredResultTest, IsNotFoundWhenItWasDamaged) {
    keep();
    {
        auto database = app::open_store_file(path);
        ASSERT_TRUE(database);
        ASSERT_TRUE(database->run("UPDATE result SET value = replace(value, 'clear', 'xlear'), "
                                  "value = replace(value, 'undecided', 'clear')"));
    }
    EXPECT_EQ(found(job), std::nullopt);
    EXPECT_TRUE(opened(path).history(job.program)->empty());
}

std::string why_not(const std::string& path) {
    const auto store = ResultStore::open(path, "1");
    return store ? "" : store.error().message;
}

TEST(ResultStore, RefusesFilesThatAreNotItsOwn) {
    const ScopedFolder folder;
    EXPECT_EQ(why_not(folder.write("text", std::string(5000, 'x'))), "file is not a database");
    EXPECT_EQ(why_not(folder.path()), "unable to open database file");
    EXPECT_EQ(why_not(folder / "nowhere/results.db"), "unable to open database file");
    auto other = app::Database::open(folder / "other", app::Database::Access::read_write);
    ASSERT_TRUE(other && other->run("CREATE TABLE customer(name)"));
    EXPECT_EQ(why_not(folder / "other"), "is a database of another program");
    { const ResultStore made = opened(folder / "newer"); }
    auto newer = app::Database::open(folder / "newer", app::Database::Access::read_write);
    ASSERT_TRUE(newer && newer->run("PRAGMA user_version = 3"));
    EXPECT_EQ(why_not(folder / "newer"), "was written by a newer version of Feeler (its format is "
                                         "3, this version supports 2)");
}

TEST(ResultStore, LiesInASeparateFolderUnlessAnotherIsNamed) {
    const ScopedFolder folder;
    const std::string path = app::default_store_path(folder.path());
    EXPECT_EQ(why_not(path), "");
    EXPECT_TRUE(fs::is_regular_file(folder / ".feeler/results.db"));
}

TEST(ResultKey, NamesAnyBytesOfAPathApart) {
    CheckJob latin, utf8;
    latin.settings.ini = "fr\xe4s.ini";
    utf8.settings.ini = "fr\xc3\xa4s.ini";
    EXPECT_NE(*app::options_text(latin), *app::options_text(utf8));
}

TEST(ResultKey, HoldsTheBuildOfTheProgram) {
    EXPECT_GE(app::build_version().size(), 40u);
    EXPECT_EQ(app::build_version(), app::build_version());
}

TEST_F(StoredResultTest, IsNotFoundForAnotherFolderOfTheSameName) {
    const ScopedFolder other;
    fs::create_directory_symlink(folder.path(), other / "current");
    CheckJob linked = job;
    linked.program = other / "current/a.nc";
    linked.setup = other / "current/job.toml";
    ResultStore store = opened(other / "current/.feeler/results.db");
    ASSERT_TRUE(store.keep(linked, run, result));
    ASSERT_TRUE(store.flush());
    EXPECT_TRUE(*store.find(linked));
    fs::remove(other / "current");
    fs::create_directory_symlink(fs::temp_directory_path(), other / "current");
    EXPECT_FALSE(*store.find(linked)) << "a.nc is another file, or missing";
}

} // namespace
