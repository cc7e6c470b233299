#include <algorithm>
#include <filesystem>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/view/model/folder_listing.h"
#include "tests/support/scoped_folder.h"

namespace {

using namespace app::viewer;
using test_support::ScopedFolder;

std::shared_ptr<const FolderListing> listing_of(const std::string& folder) {
    std::shared_ptr<const FolderListing> last;
    list_folder(
        folder, [] { return false; },
        [&](std::shared_ptr<const FolderListing> listing) { last = std::move(listing); });
    return last;
}

std::vector<std::string> shown_in(const FolderListing& listing) {
    std::vector<std::string> names;
    for (const FolderEntry& entry : listing.entries) names.push_back(entry.shown);
    return names;
}

const FolderEntry& entry_named(const FolderListing& listing, const std::string& name) {
    return *std::find_if(listing.entries.begin(), listing.entries.end(),
                         [&](const FolderEntry& entry) { return entry.shown == name; });
}

TEST(FolderListing, HasFoldersFirstAndKnowsKinds) {
    const ScopedFolder folder;
    std::filesystem::create_directory(folder.path() / "zoo");
    for (const char* name : {"b10.nc", "B9.nc", "O1234", "vise.STL", "notes.pdf", ".hidden.nc"})
        folder.write(name, "G0 X0\n");
    folder.write("mill.toml", "# a mill\n\n[[axis]]\nname = \"X\"\n");
    folder.write("plate.toml", "mesh_size = 1\n");
    const auto listing = listing_of(folder.path());
    EXPECT_EQ(shown_in(*listing),
              (std::vector<std::string>{"zoo", ".hidden.nc", "B9.nc", "b10.nc", "mill.toml",
                                        "notes.pdf", "O1234", "plate.toml", "vise.STL"}));
    EXPECT_EQ(entry_named(*listing, "zoo").kind, FileKind::folder);
    EXPECT_EQ(entry_named(*listing, "O1234").kind, FileKind::program);
    EXPECT_EQ(entry_named(*listing, "mill.toml").kind, FileKind::machine);
    EXPECT_EQ(entry_named(*listing, "plate.toml").kind, FileKind::setup);
    EXPECT_EQ(entry_named(*listing, "vise.STL").kind, FileKind::mesh);
    EXPECT_EQ(entry_named(*listing, "notes.pdf").kind, FileKind::other);
    EXPECT_TRUE(entry_named(*listing, ".hidden.nc").is_hidden);
    EXPECT_EQ(entry_named(*listing, "B9.nc").size, 6u);
    EXPECT_GT(entry_named(*listing, "B9.nc").modified, 0);
    EXPECT_TRUE(listing->is_whole);
}

TEST(FolderListing, SurvivesBrokenLinksPipesAndStrangeNames) {
    const ScopedFolder folder;
    std::filesystem::create_symlink("nowhere", folder.path() / "broken.nc");
    std::filesystem::create_symlink("loop.nc", folder.path() / "loop.nc");
    std::filesystem::create_directory_symlink(".", folder.path() / "itself");
    ASSERT_EQ(::mkfifo((folder / "pipe.nc").c_str(), 0600), 0);
    folder.write("caf\xE9.nc", "G0\n"); // Latin-1
    folder.write("two\nlines.nc", "G0\n");
    const auto listing = listing_of(folder.path());
    ASSERT_EQ(listing->entries.size(), 6u);
    EXPECT_TRUE(entry_named(*listing, "broken.nc").is_broken);
    EXPECT_TRUE(entry_named(*listing, "loop.nc").is_broken);
    EXPECT_EQ(entry_named(*listing, "itself").kind, FileKind::folder);
    EXPECT_FALSE(entry_named(*listing, "pipe.nc").is_broken);
    EXPECT_EQ(entry_named(*listing, "caf\xC3\xA9.nc").name, "caf\xE9.nc");
    for (const FolderEntry& entry : listing->entries)
        EXPECT_EQ(entry.shown.find('\n'), std::string::npos);
}

TEST(FolderListing, SaysWhyAFolderCannotBeListed) {
    const ScopedFolder folder;
    EXPECT_EQ(listing_of(folder / "gone")->error, "there is no such file or folder");
    folder.write("file", "");
    EXPECT_NE(listing_of(folder / "file")->error, "");
    if (::geteuid() == 0) return; // may read everything
    std::filesystem::create_directory(folder.path() / "locked");
    ::chmod((folder / "locked").c_str(), 0);
    EXPECT_NE(listing_of(folder / "locked")->error, "");
    ::chmod((folder / "locked").c_str(), 0700);
}

TEST(FolderListing, StopsWhenItIsNotWantedAnyMore) {
    const ScopedFolder folder;
    for (int i = 0; i < 50; ++i) folder.write(std::to_string(i), "");
    size_t polls = 0, published = 0;
    list_folder(
        folder.path(), [&] { return ++polls > 20; },
        [&](const std::shared_ptr<const FolderListing>&) { ++published; });
    EXPECT_EQ(published, 0u);
}

/// The order by a slow comparison: each name as a list of letters and numbers.
bool is_before_slowly(const std::string& a, const std::string& b) {
    const auto parts = [](const std::string& name) {
        std::vector<std::pair<int, long>> list;
        for (size_t i = 0; i < name.size();) {
            size_t end = i;
            while (end < name.size() && name[end] >= '0' && name[end] <= '9') ++end;
            // A digit sorts as its character where the other name has a letter.
            if (end > i)
                list.emplace_back('0', std::stol(name.substr(i, end - i)));
            else
                list.emplace_back(name[end++], 0);
            i = end;
        }
        return list;
    };
    const auto left = parts(a), right = parts(b);
    return left != right ? left < right : a < b;
}

TEST(FolderListing, OrdersNumbersInNamesAsNumbers) {
    EXPECT_TRUE(is_before("part 2.nc", "part 10.nc"));
    EXPECT_FALSE(is_before("part 10.nc", "part 2.nc"));
    EXPECT_TRUE(is_before("a", "a1"));
    std::mt19937 random(11);
    const auto name = [&] {
        std::string text;
        for (size_t n = random() % 6; n > 0; --n) text += "abz019"[random() % 6];
        return text;
    };
    for (int i = 0; i < 20000; ++i) {
        const std::string a = name(), b = name();
        EXPECT_EQ(is_before(a, b), is_before_slowly(a, b)) << a << " " << b;
        EXPECT_FALSE(is_before(a, b) && is_before(b, a));
    }
}

} // namespace
