#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/commands/job_file.h"
#include "app/setup/stated_setup.h"
#include "tests/support/cad_reader.h"
#include "tests/support/scoped_folder.h"

namespace app_test {
namespace {

using app::CheckJob;
using app::read_job_file;
using test_support::ScopedFolder;
using testing::HasSubstr;
using testing::StartsWith;

const std::string freecad = std::string(FEELER_SOURCE_DIR) + "/tests/app/freecad/box.FCStd";
const std::string program = "G21 G90 G17\nT1 M6\nS3000 M3\nG54 G0 G43 H1 X-20 Y10 Z20\nZ-5\n"
                            "G1 X45 F300\nG0 Z20\nM2\n";

class JobFileTest : public testing::Test {
protected:
    CheckJob job(const std::string& setup) {
        CheckJob job;
        job.program = folder_.write("p.nc", program);
        if (!setup.empty()) job.setup_text = setup;
        return job;
    }
    ScopedFolder folder_;
    const bool has_cad_ = test_support::use_cad_reader();
};

TEST_F(JobFileTest, OfFreeCadBecomesASetupWhereThereIsNone) {
    const auto news = read_job_file(job(""), freecad);
    ASSERT_TRUE(news.setup_text) << news.text;
    const app::StatedSetup stated = app::stated_in(*news.setup_text);
    EXPECT_TRUE(stated.has_tool(core::ToolNumber{1}));
    EXPECT_TRUE(stated.stock);
    EXPECT_EQ(stated.part.has_value(), has_cad_);
    EXPECT_THAT(news.text, HasSubstr(has_cad_ ? "tools, stock and part are those of the job"
                                              : "its part, \"Model\", cannot be read"));
    EXPECT_TRUE(app::run_check(job(*news.setup_text)));
}

TEST_F(JobFileTest, OfFreeCadAddsWhatIsLackingAndChangesNothing) {
    const std::string before = "# mine\n[offsets]\nG54 = { X = 10 } # touched off";
    const auto news = read_job_file(job(before), freecad);
    ASSERT_TRUE(news.setup_text) << news.text;
    EXPECT_THAT(*news.setup_text, StartsWith(before + "\n"));
    EXPECT_THAT(news.text, HasSubstr("Added: tool 1, the stock"));
    EXPECT_TRUE(app::stated_in(*news.setup_text).stock);
    const auto again = read_job_file(job(*news.setup_text), freecad);
    EXPECT_THAT(again.text, HasSubstr("states all of it already"));
    EXPECT_EQ(again.setup_text, news.setup_text);
    const std::string own = "[stock]\nbox = [[0, 0, -10], [50, 50, 0]]\n[[tool]]\nnumber = 1\n"
                            "shape = \"ball\"\ndiameter = 3\nflute_length = 9\n";
    const auto with_own = read_job_file(job(own), freecad);
    EXPECT_THAT(*with_own.setup_text, StartsWith(own));
    EXPECT_EQ(with_own.text.find("Added: the part") == 0, has_cad_) << with_own.text;
}

TEST_F(JobFileTest, OfFreeCadIsWrittenInTheUnitOfTheSetup) {
    const auto news = read_job_file(job("length_unit = \"inch\"\nmesh_size = 0.02\n"), freecad);
    ASSERT_TRUE(news.setup_text) << news.text;
    const app::StatedSetup inch = app::stated_in(*news.setup_text);
    const app::StatedSetup mm =
        app::stated_in(*read_job_file(job("mesh_size = 0.5\n"), freecad).setup_text);
    ASSERT_TRUE(inch.stock && inch.stock->box && mm.stock && mm.stock->box);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(inch.stock->box->min[axis], mm.stock->box->min[axis], 1e-4);
        EXPECT_NEAR(inch.stock->box->max[axis], mm.stock->box->max[axis], 1e-4);
    }
}

TEST_F(JobFileTest, FromAControlIsCompared) {
    const std::string setup = "[offsets]\nG54 = { X = 10, Y = -20, Z = -300 }\n";
    const std::string path = folder_.write("a.var", "5221 10.5\n5222 -20\n5223 -300\n");
    const auto news = read_job_file(job(setup), path);
    EXPECT_FALSE(news.setup_text);
    EXPECT_THAT(news.text, HasSubstr("+0.500"));
    EXPECT_THAT(news.text, HasSubstr("1 of 3 values does not agree"));
}

TEST_F(JobFileTest, ThatIsDamagedIsExplained) {
    for (const char* name : {"a.FCStd", "a.var", "a.ofs", "a.txt"}) {
        const std::string path = folder_.write(name, "PK\x03\x04 damaged");
        const auto news = read_job_file(job(""), path);
        EXPECT_FALSE(news.setup_text);
        EXPECT_EQ(news.title, "This file cannot be used");
        EXPECT_THAT(news.text, HasSubstr(name));
    }
    EXPECT_THAT(read_job_file(job(""), "none.FCStd").text, HasSubstr("none.FCStd"));
    EXPECT_THAT(read_job_file(job("[[[\n"), freecad).text, HasSubstr("p.toml"));
}

} // namespace
} // namespace app_test
