#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/commands/output.h"
#include "app/view/model/recent_files.h"
#include "app/view/model/samples.h"
#include "app/view/model/view_model.h"
#include "tests/support/scoped_folder.h"

namespace {

using namespace app::viewer;
using testing::ElementsAre;
using Recent = RecentProgram;

TEST(RecentFiles, AreKeptInOrderAcrossWindows) {
    const test_support::ScopedFolder folder;
    const std::string file = folder / "settings/recent.toml";
    RecentFiles one(file, app::write_output), other(file, app::write_output);
    one.add("/a.nc", "/a.toml");
    other.add("/b.nc", "");
    EXPECT_THAT(other.programs(), ElementsAre(Recent{"/b.nc", ""}, Recent{"/a.nc", "/a.toml"}));
    one.add("/x/../a.nc", "");
    EXPECT_THAT(one.programs(), ElementsAre(Recent{"/a.nc", ""}, Recent{"/b.nc", ""}));
    other.remove("/a.nc");
    one.read();
    EXPECT_THAT(one.programs(), ElementsAre(Recent{"/b.nc", ""}));
}

TEST(RecentFiles, AreTwelveAtMost) {
    std::vector<Recent> list;
    for (int i = 0; i < 30; ++i) list = with_recent(list, {std::to_string(i), ""});
    ASSERT_EQ(list.size(), most_recent);
    EXPECT_EQ(list.front().program, "29");
    EXPECT_EQ(list.back().program, "18");
}

TEST(RecentFiles, ComeBackWhateverTheirNames) {
    std::mt19937 random(5);
    std::vector<Recent> list;
    for (size_t i = 0; i < most_recent; ++i) {
        std::string name = "/" + std::to_string(i);
        for (int k = 0; k < 12; ++k) name += " \"'\\#=\t[]a"[random() % 11];
        list.push_back({name, i % 2 == 0 ? name + ".toml" : ""});
    }
    EXPECT_EQ(recent_in(text_of(list)), list);
    EXPECT_EQ(recent_in(text_of(std::vector<Recent>())), std::vector<Recent>());
}

TEST(RecentFiles, DamagedListsAreReadAsFarAsPossible) {
    EXPECT_TRUE(recent_in("").empty());
    EXPECT_TRUE(recent_in("[[[").empty());
    EXPECT_TRUE(recent_in("recent = 3").empty());
    EXPECT_THAT(recent_in("recent = [1, {program = 2}, {program = \"/a\"}, {program = \"/a\", "
                          "setup = \"/b\"}]"),
                ElementsAre(Recent{"/a", ""}));
    const std::string whole = text_of(std::vector<Recent>{{"/a.nc", "/a.toml"}, {"/b.nc", ""}});
    for (size_t length = 0; length < whole.size(); ++length)
        EXPECT_LE(recent_in(whole.substr(0, length)).size(), 2u);
}

TEST(RecentFiles, LeaveOutNamesThatTheirListCannotHold) {
    const test_support::ScopedFolder folder;
    RecentFiles recent(folder / "recent.toml", app::write_output);
    recent.add("/caf\xE9.nc", "");
    EXPECT_TRUE(recent.programs().empty());
    recent.add("/caf\xC3\xA9.nc", "");
    recent.read();
    EXPECT_EQ(recent.programs().size(), 1u);
}

TEST(RecentFiles, TheLastOneIsNotTheCurrentOneAndNotMissing) {
    ViewModel model;
    open_last(model, 0.0);
    EXPECT_TRUE(model.wanted_paths.empty());
    EXPECT_NE(model.message, "");
    model.recent = {{"/a.nc", "/s.toml"}, {"/b.nc", "/s.toml"}, {"/c.nc", "/s.toml"}};
    OpenedProgram opened;
    opened.program = "/a.nc";
    model.program = std::make_shared<const OpenedProgram>(opened);
    model.browser.missing = {"/b.nc"};
    open_last(model, 0.0);
    EXPECT_THAT(model.wanted_paths, ElementsAre("/c.nc", "/s.toml"));
}

TEST(Samples, AreFoundInTheSourceTree) {
    const std::string folder = FEELER_SOURCE_DIR "/assets";
    EXPECT_EQ(samples_folder(), folder);
    EXPECT_EQ(samples_in(folder).size(), 8u);
    EXPECT_TRUE(samples_in(folder + "/programs").empty());
    EXPECT_TRUE(samples_in("").empty());
}

TEST(Samples, KnowWhatIsBelowTheirFolder) {
    const test_support::ScopedFolder folder;
    std::filesystem::create_directories(folder.path() / "s/programs");
    std::filesystem::create_directory_symlink(folder.path() / "s", folder.path() / "link");
    EXPECT_TRUE(is_below(folder / "s/programs/new.toml", folder / "s"));
    EXPECT_TRUE(is_below(folder / "link/new.toml", folder / "s"));
    EXPECT_TRUE(is_below(folder / "s/programs/../new.toml", folder / "s"));
    EXPECT_FALSE(is_below(folder / "s/../new.toml", folder / "s"));
    EXPECT_FALSE(is_below(folder / "sx/new.toml", folder / "s"));
    EXPECT_FALSE(is_below(folder / "new.toml", ""));
}

} // namespace
