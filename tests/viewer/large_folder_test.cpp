#include <chrono>
#include <cstdio>
#include <thread>

#include <gtest/gtest.h>

#include "app/view/model/folder_listing.h"
#include "tests/support/scoped_folder.h"

namespace {

using namespace app::viewer;
using test_support::ScopedFolder;

TEST(FolderWorker, ListsAHundredThousandFilesInItsOwnTime) {
    const ScopedFolder folder;
    for (int i = 0; i < 100'000; ++i) {
        const std::string name = folder / (std::to_string(i) + ".nc");
        std::FILE* file = std::fopen(name.c_str(), "w");
        ASSERT_TRUE(file);
        std::fclose(file);
    }
    FolderWorker worker([] {});
    const uint64_t run = worker.start({.path = folder.path()});
    std::shared_ptr<const FolderListing> last;
    // clock: gives up after 2 min
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    // clock: as above
    while ((!last || !last->is_whole) && std::chrono::steady_clock::now() < end) {
        FolderUpdate news = worker.take();
        if (news.listing) last = news.listing;
        EXPECT_TRUE(!news.has_news || news.run == run);
        std::this_thread::sleep_for(std::chrono::milliseconds(1)); // clock: polls
    }
    ASSERT_TRUE(last && last->is_whole);
    EXPECT_EQ(last->entries.size(), 100'000u);
    EXPECT_EQ(last->entries[99'999].name, "99999.nc");
}

} // namespace
