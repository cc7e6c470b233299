#include <cerrno>
#include <vector>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "core/base/file_reads.h"
#include "tests/support/scoped_folder.h"

namespace {

using core::FileAccess;
using core::FileAccessKind;
using test_support::ScopedFolder;

/// Records accesses as "content a: hello", "presence b: -" and so on, with the file name only.
struct Looks {
    std::vector<std::string> seen;
    core::FileAccessObserver listening{[this](const FileAccess& look) {
        const char* const words[] = {"content",  "presence", "in_folder",
                                     "any_case", "listing",  "kind"};
        seen.push_back(std::string(words[static_cast<int>(look.question)]) + " "
                       + std::filesystem::path(look.path).filename().string() + ": "
                       + std::string(look.answer.value_or("-")));
    }};
};

TEST(FileReads, ReportReadFilesAndMissingFiles) {
    const ScopedFolder folder;
    folder.write("a", "hello");
    const Looks looks;
    EXPECT_EQ(core::file_bytes(folder / "a"), "hello");
    EXPECT_EQ(core::file_bytes(folder / "b"), std::nullopt);
    EXPECT_TRUE(core::is_file(folder / "a"));
    EXPECT_FALSE(core::is_there(folder / "b"));
    EXPECT_FALSE(core::is_file(folder.path()));
    const std::string own = folder.path().filename().string();
    EXPECT_EQ(looks.seen,
              (std::vector<std::string>{"content a: hello", "content b: -", "presence a: file",
                                        "presence b: -", "presence " + own + ": folder"}));
}

TEST(FileReads, ReportTheTargetOfAName) {
    const ScopedFolder folder;
    folder.write("a", "hello");
    std::filesystem::create_symlink("nowhere", folder / "gone");
    std::filesystem::create_symlink("loop", folder / "loop");
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    EXPECT_EQ(core::presence_of(folder / "gone"), "link");
    EXPECT_EQ(core::presence_of(folder / "loop"), "link");
    EXPECT_EQ(core::presence_of(folder / "loop/b"), "unknown");
    EXPECT_EQ(core::presence_of(folder / "a/b"), std::nullopt);
    EXPECT_EQ(core::presence_of(folder / std::string(300, 'x')), std::nullopt);
    EXPECT_TRUE(core::is_there(folder / "gone"));
    EXPECT_FALSE(core::is_file(folder / "gone"));
    EXPECT_EQ(core::why_no_file(folder / "a"), "");
    EXPECT_EQ(core::why_no_file(folder / "b"), "there is no such file");
    EXPECT_EQ(core::why_no_file(folder / "gone"), "is a link that leads nowhere");
    EXPECT_EQ(core::why_no_file(folder / "loop/b"), "cannot be accessed");
    EXPECT_EQ(core::why_no_file(folder / "pipe"), "is a pipe or a device, not a file");
    EXPECT_EQ(core::why_no_file(folder.path()), "is a folder, not a file");
}

TEST(FileReads, WaitForNoPipeAndReadNoDevice) {
    const ScopedFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    EXPECT_EQ(core::file_bytes(folder / "pipe"), std::nullopt);
    EXPECT_EQ(errno, ENOTSUP);
    EXPECT_EQ(core::file_bytes("/dev/zero"), std::nullopt);
    EXPECT_EQ(core::file_bytes(folder.path()), std::nullopt);
    EXPECT_EQ(errno, EISDIR);
}

TEST(FileReads, OfAFileBeyondTheLimitIsNoContent) {
    const ScopedFolder folder;
    folder.write("a", "123456");
    const Looks looks;
    EXPECT_EQ(core::file_bytes(folder / "a", 6), "123456");
    EXPECT_EQ(core::file_bytes(folder / "a", 5), "123456");
    EXPECT_EQ(core::file_bytes(folder / "a", 3), "1234");
    EXPECT_EQ(looks.seen,
              (std::vector<std::string>{"content a: 123456", "content a: -", "content a: -"}));
}

TEST(FileReads, ReachAllObserversDuringTheirLifetime) {
    const ScopedFolder folder;
    folder.write("a", "1");
    const Looks older;
    {
        const Looks younger;
        core::file_bytes(folder / "a");
        EXPECT_EQ(younger.seen.size(), 1u);
    }
    EXPECT_EQ(older.seen.size(), 1u);
    core::file_bytes(folder / "a");
    EXPECT_EQ(older.seen.size(), 2u);
}

TEST(FileReads, LeaveTheReasonOfAFailureInErrno) {
    const core::FileAccessObserver listening([](const FileAccess&) { errno = 0; });
    EXPECT_FALSE(core::file_bytes("/nowhere/at/all"));
    EXPECT_EQ(errno, ENOENT);
}

} // namespace
