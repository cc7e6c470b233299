#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/platform.h"

namespace core::platform {
namespace {

namespace fs = std::filesystem;

struct Folder {
    fs::path path = make_temporary_folder("feeler-platform");

    Folder() = default;
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    ~Folder() {
        std::error_code ignored;
        if (!path.empty()) fs::remove_all(path, ignored);
    }
};

void write(const fs::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

std::string content(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// Letters of several scripts, as in the names of programs.
const std::string any_script = "T\xC3\xA4sche \xD0\x9F\xD1\x80 \xE5\x8A\xA0\xE5\xB7\xA5.nc";

TEST(Platform, FactsTellFilesApart) {
    const Folder folder;
    ASSERT_FALSE(folder.path.empty());
    const fs::path a = folder.path / any_script, b = folder.path / "b";
    EXPECT_FALSE(facts_of(a));
    write(a, "12345");
    write(b, "12345");
    const auto of_a = facts_of(a), of_b = facts_of(b), of_folder = facts_of(folder.path);
    ASSERT_TRUE(of_a && of_b && of_folder);
    EXPECT_TRUE(of_a->is_file);
    EXPECT_FALSE(of_a->is_folder);
    EXPECT_EQ(of_a->size, 5u);
    EXPECT_TRUE(of_folder->is_folder);
    EXPECT_FALSE(of_folder->is_file);
    EXPECT_EQ(of_a->device, of_b->device);
    EXPECT_NE(of_a->number, of_b->number);
    EXPECT_EQ(facts_of(folder.path / "." / any_script)->number, of_a->number);
    // clock: an hour is for clocks of file servers
    const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
    const std::chrono::nanoseconds age = since_1970 - std::chrono::nanoseconds(of_a->modified);
    EXPECT_LT(std::chrono::abs(age), std::chrono::hours(1));
}

TEST(Platform, ReadsAtAnyPositionWhileTheFileIsReplaced) {
    const Folder folder;
    const fs::path path = folder.path / any_script, fresh = folder.path / "fresh";
    write(path, "0123456789");
    std::error_code failure;
    const auto file = RandomAccessFile::open(path, failure);
    ASSERT_TRUE(file) << failure.message();
    char bytes[4] = {};
    EXPECT_EQ(file->read(bytes, 4, 3), 4u);
    EXPECT_EQ(std::string(bytes, 4), "3456");
    EXPECT_EQ(file->read(bytes, 4, 8), 2u);
    EXPECT_EQ(file->read(bytes, 4, 10), 0u);
    EXPECT_EQ(file->read(bytes, 4, 1000), 0u);
    EXPECT_EQ(file->read(bytes, 1, 0), 1u);
    EXPECT_EQ(bytes[0], '0');
    write(fresh, "new");
    EXPECT_FALSE(replace_file(fresh, path));
    EXPECT_EQ(content(path), "new");
    EXPECT_EQ(file->read(bytes, 4, 3), 4u);
    EXPECT_EQ(std::string(bytes, 4), "3456");
    EXPECT_FALSE(RandomAccessFile::open(folder.path / "none", failure));
    EXPECT_EQ(failure, std::errc::no_such_file_or_directory);
}

TEST(Platform, ReplacesFiles) {
    const Folder folder;
    const fs::path fresh = folder.path / "fresh", old = folder.path / any_script;
    write(old, "old");
    std::FILE* const file = open_file(fresh, "wb");
    ASSERT_TRUE(file);
    std::fputs("new\n", file);
    EXPECT_TRUE(write_through(file));
    std::fclose(file);
    EXPECT_FALSE(replace_file(fresh, old));
    EXPECT_EQ(content(old), "new\n");
    EXPECT_FALSE(fs::exists(fresh));
    EXPECT_TRUE(replace_file(fresh, old)); // it no longer exists
    EXPECT_EQ(content(old), "new\n");
}

TEST(Platform, KnowsItsProgram) {
    EXPECT_TRUE(fs::is_regular_file(program_path()));
    EXPECT_GE(build_id().size(), 32u);
    EXPECT_EQ(build_id(), build_id());
    EXPECT_NE(process_id(), 0u);
    EXPECT_GT(physical_memory(), 1e8);
    EXPECT_EQ(environment_variable("FEELER_NO_SUCH_VARIABLE"), "");
    EXPECT_NE(environment_variable("PATH"), "");
    EXPECT_TRUE(settings_folder().is_absolute());
    EXPECT_TRUE(state_folder().is_absolute());
}

TEST(Platform, RunsProgramsQuietly) {
    EXPECT_FALSE(run_quietly({"feeler-no-such-program"}));
    const std::string itself = program_path().string();
    EXPECT_EQ(run_quietly({itself, "--gtest_list_tests"}), 0);
    // The word with blanks arrives whole.
    const Folder folder;
    const fs::path list = folder.path / "two words" / any_script;
    EXPECT_EQ(run_quietly({itself, "--gtest_list_tests", "--gtest_output=xml:" + list.string()}),
              0);
    EXPECT_TRUE(fs::is_regular_file(list));
}

TEST(Platform, CountsTime) {
    // clock: only that both go on
    const auto clocks = [] { return std::pair(steady_milliseconds(), thread_cpu_seconds()); };
    const auto begin = clocks();
    auto end = begin;
    while (end.first == begin.first || end.second == begin.second) end = clocks();
    EXPECT_GT(end.first, begin.first);
    EXPECT_GT(end.second, begin.second);
}

TEST(FileLock, IsHeldByOneOwnerAtATime) {
    const Folder folder;
    const std::filesystem::path path = folder.path / "a.lock";
    bool is_held = false;
    {
        auto lock = FileLock::take(path, is_held);
        ASSERT_TRUE(lock);
        EXPECT_FALSE(is_held);
        EXPECT_FALSE(FileLock::take(path, is_held));
        EXPECT_TRUE(is_held);
        const FileLock moved = *std::move(lock);
        lock.reset();
        EXPECT_FALSE(FileLock::take(path, is_held));
    }
    EXPECT_FALSE(std::filesystem::exists(path));
    EXPECT_TRUE(FileLock::take(path, is_held));
    EXPECT_FALSE(FileLock::take(folder.path / "none" / "a.lock", is_held));
    EXPECT_FALSE(is_held);
}

} // namespace
} // namespace core::platform
