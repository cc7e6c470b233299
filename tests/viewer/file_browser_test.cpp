#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/view/model/file_browser.h"
#include "app/view/model/folder_listing.h"
#include "app/view/model/view_model.h"
#include "core/base/platform.h"
#include "tests/support/scoped_folder.h"

namespace {

using namespace app::viewer;
using test_support::ScopedFolder;
using testing::ElementsAre;
using testing::HasSubstr;

/// Does at once what the worker would be asked for.
void settle(ViewModel& model) {
    for (int i = 0; i < 20 && model.browser.has_order; ++i) {
        FileBrowser& browser = model.browser;
        browser.has_order = false;
        FolderUpdate news;
        news.run = browser.run;
        news.has_news = true;
        const std::string path = browser.wanted;
        if (std::filesystem::is_regular_file(path))
            news.is_file = true;
        else
            list_folder(
                path, [] { return false; },
                [&](std::shared_ptr<const FolderListing> listing) {
                    news.listing = std::move(listing);
                });
        take_in(model, std::move(news));
    }
}

void type(ViewModel& model, const std::string& text) {
    model.browser.typed = text;
    update_rows(model.browser);
}

void enter(ViewModel& model) {
    enter_typed(model);
    settle(model);
}

std::vector<std::string> rows_of(const FileBrowser& browser) {
    std::vector<std::string> names;
    for (const size_t row : browser.rows) names.push_back(browser.listing->entries[row].shown);
    return names;
}

/// A folder with two programs, a set-up, a mesh and a folder with a program.
struct Job {
    Job() {
        std::filesystem::create_directories(folder.path() / "old/deep");
        for (const char* name : {"plate.nc", "Plate10.nc", ".secret.nc", "old/first.nc"})
            folder.write(name, "G0 X0\n");
        folder.write("plate.toml", "mesh_size = 1\n");
        folder.write("vise.stl", "solid\n");
        browse(model, FileWish::open, folder.path());
        settle(model);
    }

    ScopedFolder folder;
    ViewModel model;
    FileBrowser& browser = model.browser;
};

TEST(FileBrowser, FiltersByKindNameAndHidden) {
    Job job;
    EXPECT_THAT(rows_of(job.browser), ElementsAre("old", "plate.nc", "plate.toml", "Plate10.nc"));
    type(job.model, "PLATE1");
    EXPECT_THAT(rows_of(job.browser), ElementsAre("Plate10.nc"));
    type(job.model, "");
    job.browser.filter = FileFilter::meshes;
    update_rows(job.browser);
    EXPECT_THAT(rows_of(job.browser), ElementsAre("old", "vise.stl"));
    job.browser.filter = FileFilter::programs;
    job.browser.shows_hidden = true;
    update_rows(job.browser);
    EXPECT_THAT(rows_of(job.browser), ElementsAre("old", ".secret.nc", "plate.nc", "Plate10.nc"));
    job.browser.shows_hidden = false;
    type(job.model, ".se");
    EXPECT_THAT(rows_of(job.browser), ElementsAre(".secret.nc"));
}

TEST(FileBrowser, EnterGoesIntoFoldersAndOpensFiles) {
    Job job;
    enter(job.model); // the first row is a folder
    EXPECT_EQ(job.browser.folder, job.folder / "old");
    EXPECT_THAT(rows_of(job.browser), ElementsAre("deep", "first.nc"));
    move_selection(job.browser, 5);
    EXPECT_EQ(job.browser.selected, 1u);
    enter(job.model);
    EXPECT_THAT(job.model.wanted_paths, ElementsAre(job.folder / "old/first.nc"));
    EXPECT_EQ(job.model.popup, Popup::none);
}

TEST(FileBrowser, GoesUpAndSelectsTheFolderThatWasLeft) {
    Job job;
    std::filesystem::create_directory(job.folder.path() / "a"); // before it in the list
    type(job.model, "old/");
    enter(job.model);
    EXPECT_EQ(job.browser.folder, job.folder / "old");
    EXPECT_EQ(job.browser.typed, "");
    go_up(job.browser);
    settle(job.model);
    EXPECT_EQ(job.browser.folder, job.folder.path());
    EXPECT_EQ(rows_of(job.browser)[job.browser.selected], "old");
    for (int i = 0; i < 30; ++i) {
        go_up(job.browser);
        settle(job.model);
    }
    EXPECT_EQ(job.browser.folder, "/");
}

TEST(FileBrowser, TakesWholePathsAndThoseBelowHome) {
    Job job;
    EXPECT_EQ(meant_path(job.browser, "a/../b.nc"), job.folder / "b.nc");
    EXPECT_EQ(meant_path(job.browser, "\"/x y/b.nc\""), "/x y/b.nc");
    EXPECT_EQ(meant_path(job.browser, "~"), core::platform::home_folder().generic_string());
    EXPECT_EQ(meant_path(job.browser, "/x/"), "/x");
    type(job.model, job.folder / "old/first.nc");
    enter(job.model);
    EXPECT_THAT(job.model.wanted_paths, ElementsAre(job.folder / "old/first.nc"));
}

TEST(FileBrowser, StaysAndNamesAPathThatIsNotThere) {
    Job job;
    for (const char* typed : {"old/none.nc", "nothing like it"}) {
        type(job.model, typed);
        enter(job.model);
        EXPECT_THAT(job.browser.error, HasSubstr(job.folder / typed));
        EXPECT_EQ(job.browser.folder, job.folder.path());
        EXPECT_EQ(job.browser.typed, typed);
        EXPECT_EQ(job.model.popup, Popup::open_file);
    }
    EXPECT_TRUE(job.model.wanted_paths.empty());
}

TEST(FileBrowser, KeepsTheSelectionWhenTheFolderChanges) {
    Job job;
    move_selection(job.browser, 3);
    ASSERT_EQ(rows_of(job.browser)[job.browser.selected], "Plate10.nc");
    job.folder.write("aaa.nc", "G0\n");
    look_at(job.browser, job.folder.path());
    settle(job.model);
    EXPECT_EQ(rows_of(job.browser)[job.browser.selected], "Plate10.nc");
}

TEST(FileBrowser, KeepsWhatIsTypedWhileAFolderIsRead) {
    Job job;
    browse(job.model, FileWish::open, job.folder / "old");
    EXPECT_TRUE(job.browser.rows.empty()) << "those of another folder";
    type(job.model, "first");
    settle(job.model);
    EXPECT_EQ(job.browser.typed, "first");
    EXPECT_THAT(rows_of(job.browser), ElementsAre("first.nc"));
}

TEST(FileBrowser, SaysThatItsFolderHasGone) {
    Job job;
    enter(job.model);
    std::filesystem::remove_all(job.folder.path() / "old");
    look_at(job.browser, job.browser.folder);
    settle(job.model);
    EXPECT_EQ(job.browser.listing->error, "there is no such file or folder");
    EXPECT_TRUE(job.browser.rows.empty());
    move_selection(job.browser, 1);
    enter(job.model);
    go_up(job.browser);
    settle(job.model);
    EXPECT_THAT(rows_of(job.browser), testing::Contains("plate.nc"));
}

TEST(FileBrowser, StartsAboveAFolderThatHasGone) {
    Job job;
    browse(job.model, FileWish::open, job.folder / "x/y/z");
    settle(job.model);
    EXPECT_EQ(job.browser.folder, job.folder.path());
    EXPECT_THAT(job.browser.error, HasSubstr("x"));
}

TEST(FileBrowser, RefusesBrokenLinks) {
    Job job;
    std::filesystem::create_symlink("nowhere", job.folder.path() / "broken.nc");
    look_at(job.browser, job.folder.path());
    settle(job.model);
    type(job.model, "broken");
    enter(job.model);
    EXPECT_THAT(job.browser.error, HasSubstr("broken.nc leads nowhere"));
    EXPECT_TRUE(job.model.wanted_paths.empty());
}

TEST(FileBrowser, AddsMeshesToTheSetup) {
    Job job;
    open_document(job.model, app::SetupDocument(job.folder / "plate.toml", ""));
    browse(job.model, FileWish::mesh);
    settle(job.model);
    EXPECT_EQ(job.browser.folder, job.folder.path());
    type(job.model, "vise");
    enter(job.model);
    EXPECT_THAT(job.model.workspace.document.text(), HasSubstr("mesh = \"vise.stl\""));
    browse(job.model, FileWish::machine);
    settle(job.model);
    type(job.model, "plate.nc"); // not listed, but named
    enter(job.model);
    EXPECT_THAT(job.model.workspace.document.text(), HasSubstr("file = \"plate.nc\""));
}

TEST(FileBrowser, SavesUnderATypedName) {
    Job job;
    open_document(job.model, app::SetupDocument(job.folder / "plate.toml", ""));
    browse(job.model, FileWish::save_setup);
    settle(job.model);
    EXPECT_EQ(job.browser.typed, "plate.toml");
    EXPECT_THAT(rows_of(job.browser), ElementsAre("old", "plate.toml"));
    type(job.model, "old/");
    enter(job.model);
    EXPECT_EQ(job.browser.folder, job.folder / "old");
    job.browser.typed = "again";
    enter(job.model);
    EXPECT_EQ(job.model.save_path, job.folder / "old/again.toml");
    EXPECT_EQ(job.model.popup, Popup::open_file) << "until it is saved";
    close_browser(job.model);
    EXPECT_EQ(job.model.popup, Popup::none);
}

TEST(FileBrowser, OrdersByTimeAndSize) {
    Job job;
    namespace fs = std::filesystem;
    const auto old = fs::last_write_time(job.folder / "plate.nc") - std::chrono::hours(5);
    fs::last_write_time(job.folder / "plate.nc", old);
    fs::last_write_time(job.folder / "Plate10.nc", old - std::chrono::hours(5));
    job.folder.write("plate.toml", std::string(1000, '#'));
    look_at(job.browser, job.folder.path());
    settle(job.model);
    job.browser.order = FileOrder::newest;
    update_rows(job.browser);
    EXPECT_THAT(rows_of(job.browser), ElementsAre("old", "plate.toml", "plate.nc", "Plate10.nc"));
    job.browser.order = FileOrder::largest;
    update_rows(job.browser);
    EXPECT_EQ(rows_of(job.browser)[1], "plate.toml");
}

TEST(FileBrowser, IgnoresAnswersToEarlierQuestions) {
    Job job;
    FolderUpdate late;
    late.has_news = true;
    late.run = job.browser.run + 7;
    late.listing = std::make_shared<const FolderListing>();
    EXPECT_FALSE(take_in(job.model, late));
    EXPECT_EQ(job.browser.folder, job.folder.path());
}

TEST(FileBrowser, WritesSizesAndDates) {
    EXPECT_EQ(size_words(0), "0 B");
    EXPECT_EQ(size_words(999), "999 B");
    EXPECT_EQ(size_words(1000), "1.0 KB");
    EXPECT_EQ(size_words(999'960), "1.0 MB");
    EXPECT_EQ(size_words(~uint64_t{0}), "18447 PB");
    EXPECT_EQ(date_words(0), "");
    EXPECT_EQ(date_words(-5), "");
    EXPECT_EQ(date_words(INT64_MAX).size(), 16u);
}

} // namespace
