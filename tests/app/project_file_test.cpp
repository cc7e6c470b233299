#include <fmt/format.h>
#include <gmock/gmock.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/library/find/project_file.h"
#include "app/library/run/batch_job.h"
#include "tests/support/scoped_folder.h"

namespace app {
namespace {

using core::Severity;
using test_support::ScopedFolder;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string good = "G21 G90\nG0 X1.\nM30\n";

class ProjectFile : public testing::Test {
protected:
    core::Error refusal(const std::string& text) const {
        const auto project = read_project(folder.write("feeler.toml", text));
        return project ? core::Error{} : project.error();
    }

    /// The job that a project with this text defines for a program.
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

TEST_F(ProjectFile, HasSettingsForAllAndForSomePrograms) {
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
    EXPECT_EQ(special.settings.dialect, gcode::DialectId::haas) << "from an earlier table";
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

TEST_F(ProjectFile, LeavesASetupNextToTheProgramAlone) {
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
    EXPECT_THAT(plan->failures[0].message, HasSubstr("*.tap matches no file"));
}

/// Projects in nested folders; names are relative to the outermost.
class NestedProject : public testing::Test {
protected:
    void SetUp() override {
        for (const char* name : {"top.nc", "job/a.nc", "job/b.nc", "job/sub/c.nc", "other/d.nc"})
            write(name, good);
        write("job/feeler.toml", "allowance = 4\n[[program]]\nfiles = [\"a.nc\", "
                                 "\"../other/d.nc\"]\nsetup = \"vise.toml\"\n");
    }

    void write(const std::string& name, const std::string& bytes) const {
        std::filesystem::create_directories(std::filesystem::path(folder / name).parent_path());
        folder.write(name, bytes);
    }

    std::string short_name(const std::string& path) const {
        const std::string whole = std::filesystem::path(path).lexically_normal();
        return whole.substr(std::min(whole.size(), folder.path().string().size() + 1));
    }

    BatchPlan plan(const std::vector<std::string>& names) const {
        std::vector<std::string> words;
        for (const std::string& name : names) words.push_back(folder / name);
        const auto made = plan_batch(words, {});
        if (!made) ADD_FAILURE() << made.error().file << ": " << made.error().message;
        return made ? *made : BatchPlan{};
    }

    /// The programs with their set-ups and allowances.
    std::vector<std::string> jobs(const BatchPlan& plan) const {
        std::vector<std::string> all;
        for (const CheckJob& job : plan.jobs)
            all.push_back(fmt::format("{} {} {}", short_name(job.program), short_name(job.setup),
                                      job.allowance.value_or(0.0)));
        return all;
    }

    std::vector<std::string> skips(const BatchPlan& plan) const {
        std::vector<std::string> all;
        for (const SkippedFile& file : plan.skipped)
            if (file.why.starts_with("is not named in any")) all.push_back(short_name(file.path));
        return all;
    }

    ScopedFolder folder;
};

TEST_F(NestedProject, CountsForItsFolderWhenAFolderAboveIsSearched) {
    const BatchPlan found = plan({"."});
    EXPECT_THAT(jobs(found),
                ElementsAre("job/a.nc job/vise.toml 4", "other/d.nc job/vise.toml 4", "top.nc  0"));
    EXPECT_THAT(skips(found), ElementsAre("job/b.nc", "job/sub/c.nc"));
    EXPECT_THAT(found.failures, IsEmpty());
}

TEST_F(NestedProject, CountsForWhatAPatternFinds) {
    for (const char* word : {"**/*.nc", "j*/**/*.nc", "job/**"}) {
        const BatchPlan found = plan({word});
        EXPECT_THAT(jobs(found), Contains("job/a.nc job/vise.toml 4")) << word;
        EXPECT_THAT(skips(found), ElementsAre("job/b.nc", "job/sub/c.nc")) << word;
    }
    EXPECT_THAT(jobs(plan({"*/a.nc"})), ElementsAre("job/a.nc job/vise.toml 4"));
}

TEST_F(NestedProject, CountsBeforeTheProjectThatReachesIntoItsFolder) {
    write("feeler.toml", "allowance = 1\n[[program]]\nfiles = [\"**/*.nc\"]\nsetup = "
                         "\"all.toml\"\n[[program]]\nfiles = \"job/b.nc\"\n");
    const BatchPlan found = plan({"."});
    EXPECT_THAT(jobs(found), ElementsAre("job/a.nc job/vise.toml 4", "other/d.nc all.toml 1",
                                         "top.nc all.toml 1", "job/b.nc  1"));
    EXPECT_THAT(skips(found), ElementsAre("job/sub/c.nc"));
}

TEST_F(NestedProject, AppliesInAnyOrderOfItsPrograms) {
    const std::string as_it_says = "job/a.nc job/vise.toml 4";
    EXPECT_THAT(jobs(plan({"job/a.nc", "."})), Contains(as_it_says));
    EXPECT_THAT(jobs(plan({"job/a.nc", "**/a.nc"})), ElementsAre(as_it_says));
    EXPECT_THAT(jobs(plan({"job/a.nc", "job"})), Contains(as_it_says));
    EXPECT_THAT(jobs(plan({".", "job/b.nc"})), Contains("job/b.nc  0")) << "named, not found";
}

TEST_F(NestedProject, KeepsItsSayThoughALaterSearchBeginsBelowIt) {
    write("job/feeler.toml", "[[program]]\nfiles = \"**/*.nc\"\nsetup = \"vise.toml\"\n");
    const std::string as_it_says = "job/sub/c.nc job/vise.toml 0";
    EXPECT_THAT(jobs(plan({"**/*.nc", "job/sub"})), Contains(as_it_says));
    EXPECT_THAT(jobs(plan({"**/*.nc", "job/sub/*.nc"})), Contains(as_it_says));
    EXPECT_THAT(jobs(plan({"job/sub", "**/*.nc"})), Contains(as_it_says));
}

TEST_F(NestedProject, LeavesToOtherWordsWhatItDoesNotName) {
    const std::string found_below = "job/sub/c.nc  0";
    for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
             {"job/sub"}, {".", "job/sub"}, {"job/sub", "."}, {"job/sub/*.nc", "**/*.nc"}}) {
        const BatchPlan found = plan(words);
        EXPECT_THAT(jobs(found), Contains(found_below)) << words[0];
        EXPECT_THAT(skips(found), testing::Not(Contains("job/sub/c.nc"))) << words[0];
    }
}

TEST_F(NestedProject, HasTheOnlySayInItsFolderThoughOthersReachIntoIt) {
    for (const std::string name : {"A", "B"}) {
        write(name + "/" + name + ".nc", good);
        write(name + "/feeler.toml",
              "[[program]]\nfiles = [\".\", \"../A\", \"../B\"]\nsetup = \"s.toml\"\n");
    }
    for (const std::vector<std::string>& words :
         std::vector<std::vector<std::string>>{{"A"}, {"B"}, {"A", "B"}, {"B", "A"}})
        EXPECT_THAT(jobs(plan(words)),
                    testing::UnorderedElementsAre("A/A.nc A/s.toml 0", "B/B.nc B/s.toml 0"));
    write("job/feeler.toml", "[[program]]\nfiles = \"../other/*.nc\"\nsetup = \"vise.toml\"\n");
    write("feeler.toml", "[[program]]\nfiles = [\"other\", \"job\"]\nsetup = \"all.toml\"\n");
    EXPECT_THAT(jobs(plan({"."})), ElementsAre("other/d.nc all.toml 0"));
}

TEST_F(NestedProject, IsTakenForOneWhereItsFolderHasBrackets) {
    write("j[1]/a.nc", good);
    write("j[1]/feeler.toml", "[[program]]\nfiles = \"*.nc\"\nsetup = \"vise.toml\"\n");
    EXPECT_THAT(jobs(plan({"j[1]/feeler.toml"})), ElementsAre("j[1]/a.nc j[1]/vise.toml 0"));
}

TEST_F(NestedProject, IsReadOnceThoughProjectsLeadToEachOther) {
    write("feeler.toml", "[[program]]\nfiles = \"**/*.nc\"\nsetup = \"all.toml\"\n");
    write("job/feeler.toml", "[[program]]\nfiles = \"../**/*.nc\"\nsetup = \"vise.toml\"\n");
    EXPECT_THAT(jobs(plan({"."})),
                ElementsAre("job/a.nc job/vise.toml 0", "job/b.nc job/vise.toml 0",
                            "job/sub/c.nc job/vise.toml 0", "other/d.nc all.toml 0",
                            "top.nc all.toml 0"));
}

TEST_F(NestedProject, FailsWhereItCannotBeRead) {
    write("job/feeler.toml", "[[program]]\nfile = \"a.nc\"\n");
    const BatchPlan wrong = plan({"."});
    EXPECT_THAT(jobs(wrong), ElementsAre("other/d.nc  0", "top.nc  0"));
    ASSERT_EQ(wrong.failures.size(), 1U);
    EXPECT_EQ(short_name(wrong.failures[0].file), "job/feeler.toml");
    EXPECT_EQ(wrong.failures[0].where.line, 2U);
    std::filesystem::remove(folder / "job/feeler.toml");
    std::filesystem::create_symlink("not mounted", folder / "job/feeler.toml");
    const BatchPlan gone = plan({"."});
    ASSERT_EQ(gone.failures.size(), 1U);
    EXPECT_THAT(gone.failures[0].message, HasSubstr("is a link that leads nowhere"));
    const auto named = plan_batch({folder / "job"}, {});
    ASSERT_FALSE(named) << "not searched like a plain folder";
    EXPECT_THAT(named.error().message, HasSubstr("is a link that leads nowhere"));
}

TEST_F(ProjectFile, SearchesItsFolderOfAnyName) {
    const std::string name = folder / "jobs[1]";
    std::filesystem::create_directory(name);
    folder.write("jobs[1]/a.nc", good);
    folder.write("jobs[1]/feeler.toml", "[[program]]\nfiles = \"*.nc\"\n");
    const auto plan = plan_batch({name}, {});
    ASSERT_TRUE(plan);
    EXPECT_TRUE(plan->failures.empty());
    ASSERT_EQ(plan->jobs.size(), 1U);
    EXPECT_EQ(plan->jobs[0].program, name + "/a.nc");
}

TEST_F(ProjectFile, TakesADanglingSetupLinkNextToTheProgramAsItsSetup) {
    folder.write("a.nc", good);
    std::filesystem::create_symlink("not mounted", folder / "a.toml");
    const CheckJob found = job("[[program]]\nfiles = \"a.nc\"\n", "a.nc");
    EXPECT_EQ(found.setup, folder / "a.toml");
    const auto run = run_check(found);
    ASSERT_FALSE(run);
    EXPECT_EQ(run.error().file, folder / "a.toml");
    EXPECT_THAT(run.error().message, HasSubstr("is a link that leads nowhere"));
}

TEST_F(ProjectFile, RefusesAnUnknownKeyWithLineColumnAndTheNearestKey) {
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
    for (const char* blank : {"files = \"\"", "files = [\"a.nc\", \"\"]"}) {
        const core::Error error = refusal("[[program]]\n" + std::string(blank) + "\n");
        EXPECT_THAT(error.message, HasSubstr("files must name a file"));
        EXPECT_EQ(error.where.line, 2U);
        EXPECT_EQ(error.where.column, 9U);
    }
    EXPECT_THAT(refusal(program + "setup = \"\"\n").message, HasSubstr("setup must name a file"));
    EXPECT_EQ(refusal(program + "setup = \"\"\n").where.line, 3U);
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
