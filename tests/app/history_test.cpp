#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/check/check_run.h"
#include "app/library/store/result_store.h"
#include "app/library/store/store_file.h"
#include "tests/app/checked.h"

namespace app_test {
namespace {

namespace fs = std::filesystem;

/// A folder with a program; two versions of it were checked and stored.
class TwoVersions : public testing::Test {
protected:
    TwoVersions() {
        setup = folder.write("a.toml", test_support::SetupWriter()
                                           .also("[control]\n\"5006#6\" = 1\n")
                                           .fixture("post", "box = [[110, 0, -30], [130, 100, 20]]")
                                           .text());
        check_and_keep("G1 X80 F500\n");
        check_and_keep("G1 X104 F500\n");
    }

    void check_and_keep(const std::string& cut) {
        app::CheckJob job;
        job.program = program =
            folder.write("teil 1.nc", "G21 G90 G54\nT1 M6\nG43 H1\nS3000 M3\nG0 X20 Y50\nG0 Z5\n"
                                          + cut + "G0 Z50\nM2\n");
        job.setup = setup;
        job.mesh_size = 2.0;
        const auto run = app::run_check(job);
        ASSERT_TRUE(run) << run.error().message;
        auto store = app::ResultStore::open(app::default_store_path(folder.path()), "1");
        ASSERT_TRUE(store) << store.error().message;
        ASSERT_TRUE(store->keep(job, *run, app::result_of(*run, setup)));
    }

    const test_support::ScopedFolder folder;
    std::string program, setup;
};

TEST_F(TwoVersions, AreListedWithTheirDifferences) {
    const auto ran = feeler({"history", program});
    ASSERT_EQ(ran.status, 0) << ran.err;
    EXPECT_EQ(ran.out.find(program + ": 2 versions\n"), 0u) << ran.out;
    EXPECT_NE(ran.out.find("UTC  ERRORS in the program"), std::string::npos) << ran.out;
    EXPECT_NE(ran.out.find("UTC  VIOLATION"), std::string::npos);
    EXPECT_NE(ran.out.find("least margin 6.000 mm less"), std::string::npos) << ran.out;
    EXPECT_NE(ran.out.find("new:  error near-miss, line 7: G1 X104 F500"), std::string::npos)
        << ran.out;
}

TEST_F(TwoVersions, AreListedInJson) {
    const auto ran = feeler({"history", program, "--format", "json"});
    ASSERT_EQ(ran.status, 0) << ran.err;
    const auto json = nlohmann::json::parse(ran.out);
    ASSERT_EQ(json["versions"].size(), 2u);
    EXPECT_TRUE(json["versions"][0]["change"].is_null());
    EXPECT_NEAR(json["versions"][1]["change"]["nearer"].get<double>(), 6.0, 1e-6);
    EXPECT_EQ(json["versions"][1]["result"]["verdict"], "violation");
    EXPECT_NE(json["versions"][0]["result"]["sha256"], json["versions"][1]["result"]["sha256"]);
}

TEST_F(TwoVersions, AreFoundFromADeeperFolderAndByName) {
    fs::create_directories(folder / "jobs/today");
    fs::copy_file(program, folder / "jobs/today/new.nc");
    const auto unknown = feeler({"history", folder / "jobs/today/new.nc"});
    EXPECT_EQ(unknown.status, 2);
    EXPECT_NE(unknown.err.find("has no results for"), std::string::npos) << unknown.err;
    fs::rename(folder / ".feeler/results.db", folder / "kept.db");
    fs::remove_all(folder / ".feeler");
    EXPECT_EQ(feeler({"history", program, "--cache", folder / "kept.db"}).status, 0);
    const auto none = feeler({"history", program});
    EXPECT_EQ(none.status, 2);
    EXPECT_NE(none.err.find("has results (.feeler/results.db)"), std::string::npos) << none.err;
    EXPECT_EQ(feeler({"history", program, "--cache", folder / "absent.db"}).status, 2);
    EXPECT_FALSE(fs::exists(folder / "absent.db"));
}

} // namespace
} // namespace app_test
