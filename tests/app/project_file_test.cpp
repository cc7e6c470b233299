#include <gmock/gmock.h>

#include "app/batch/batch_job.h"
#include "app/batch/project_file.h"
#include "tests/support/scoped_folder.h"

namespace app {
namespace {

using core::Severity;
using test_support::ScopedFolder;
using testing::HasSubstr;

const std::string good = "G21 G90\nG0 X1.\nM30\n";

class ProjectFile : public testing::Test {
protected:
    core::Error refusal(const std::string& text) const {
        const auto project = read_project(folder.write("feeler.toml", text));
        return project ? core::Error{} : project.error();
    }

    /// The job of a program that a project with this text asks for.
    CheckJob job(const std::string& text, const std::string& program, const CheckJob& asked = {}) {
        folder.write("feeler.toml", text);
        const auto plan = plan_batch({folder / "feeler.toml"}, asked);
        if (plan)
            for (const CheckJob& found : plan->jobs)
                if (found.program == folder / program) return found;
        ADD_FAILURE() << "no job of " << program << (plan ? "" : ": " + plan.error().message);
        return {};
    }

    ScopedFolder folder;
};

TEST_F(ProjectFile, SaysWhatCountsForAllAndForSome) {
    for (const char* name : {"a.nc", "b.nc", "special.nc"}) folder.write(name, good);
    const std::string text = R"(allowance = 1.5
[rules]
air-cut = "off"
near-miss = "warning"
[[program]]
files = "*.nc"
setup = "vise.toml"
dialect = "haas"
[[program]]
files = ["special.nc"]
setup = "sub/plate.toml"
mesh_size = 0.25
rules = { near-miss = "error" }
)";
    const CheckJob plain = job(text, "a.nc"), special = job(text, "special.nc");
    EXPECT_EQ(plain.setup, folder / "vise.toml");
    EXPECT_EQ(plain.settings.dialect, gcode::DialectId::haas);
    EXPECT_EQ(plain.allowance, 1.5);
    EXPECT_EQ(plain.mesh_size, std::nullopt);
    EXPECT_EQ(plain.rules,
              (core::RuleSeverities{{"air-cut", Severity::off}, {"near-miss", Severity::warning}}));
    EXPECT_EQ(special.setup, folder / "sub/plate.toml");
    EXPECT_EQ(special.settings.dialect, gcode::DialectId::haas) << "said by an earlier table";
    EXPECT_EQ(special.mesh_size, 0.25);
    EXPECT_EQ(special.rules.at("near-miss"), Severity::error);
    EXPECT_EQ(special.rules.at("air-cut"), Severity::off);
}

TEST_F(ProjectFile, GivesWayToOptions) {
    folder.write("a.nc", good);
    CheckJob asked;
    asked.setup = "mine.toml";
    asked.allowance = 3.0;
    const CheckJob found = job("allowance = 1\nmesh_size = 1\n[[program]]\nfiles = \"a.nc\"\n"
                               "setup = \"x.toml\"\n",
                               "a.nc", asked);
    EXPECT_EQ(found.setup, "mine.toml");
    EXPECT_EQ(found.allowance, 3.0);
    EXPECT_EQ(found.mesh_size, 1.0);
}

TEST_F(ProjectFile, LeavesASetupBesideTheProgramToItself) {
    folder.write("a.nc", good);
    const std::string beside = folder.write("a.toml", "");
    const CheckJob found = job("[[program]]\nfiles = \"a.nc\"\n", "a.nc");
    EXPECT_EQ(found.setup, beside);
    EXPECT_TRUE(found.setup_was_found);
    EXPECT_FALSE(
        job("[[program]]\nfiles = \"a.nc\"\nsetup = \"b.toml\"\n", "a.nc").setup_was_found);
}

TEST_F(ProjectFile, NamesTheLineOfAPatternThatNamesNothing) {
    folder.write("feeler.toml", "allowance = 1\n\n[[program]]\nfiles = \"*.tap\"\n");
    const auto plan = plan_batch({folder.path().string()}, {});
    ASSERT_TRUE(plan);
    ASSERT_EQ(plan->failures.size(), 1U);
    EXPECT_EQ(plan->failures[0].file, folder / "feeler.toml");
    EXPECT_EQ(plan->failures[0].where.line, 3U);
    EXPECT_THAT(plan->failures[0].message, HasSubstr("*.tap names no file"));
}

TEST_F(ProjectFile, RefusesAKeyThatIsNotKnownWithItsPlaceAndTheNearest) {
    const core::Error error = refusal("[[program]]\nfiles = \"a.nc\"\n  setpu = \"b.toml\"\n");
    EXPECT_EQ(error.file, folder / "feeler.toml");
    EXPECT_EQ(error.where.line, 3U);
    EXPECT_EQ(error.where.column, 3U);
    EXPECT_THAT(error.message, HasSubstr("did you mean \"setup\""));
    EXPECT_THAT(refusal("alowance = 2\n[[program]]\nfiles = \"a.nc\"\n").message,
                HasSubstr("did you mean \"allowance\""));
}

TEST_F(ProjectFile, RefusesWrongValues) {
    const std::string program = "[[program]]\nfiles = \"a.nc\"\n";
    EXPECT_THAT(refusal("").message, HasSubstr("[[program]]"));
    EXPECT_THAT(refusal("[[program]]\nsetup = \"b.toml\"\n").message, HasSubstr("files"));
    EXPECT_THAT(refusal("[[program]]\nfiles = []\n").message, HasSubstr("files"));
    EXPECT_THAT(refusal("[[program]]\nfiles = [1]\n").message, HasSubstr("files"));
    EXPECT_THAT(refusal(program + "dialect = \"basic\"\n").message, HasSubstr("fanuc"));
    EXPECT_THAT(refusal("allowance = -1\n" + program).message, HasSubstr("allowance"));
    EXPECT_THAT(refusal("mesh_size = 0\n" + program).message, HasSubstr("mesh_size"));
    EXPECT_THAT(refusal("[rules]\nnear-mis = \"off\"\n" + program).message, HasSubstr("near-miss"));
    EXPECT_THAT(refusal("[rules]\ncollision = \"off\"\n" + program).message, HasSubstr("always"));
    EXPECT_EQ(refusal("allowance = \n").where.line, 1U);
    EXPECT_THAT(read_project(folder / "none.toml").error().message, HasSubstr("no such file"));
}

} // namespace
} // namespace app
