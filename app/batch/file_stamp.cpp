#include "app/batch/file_stamp.h"

#include <algorithm>
#include <chrono>

#include <sys/stat.h>

namespace app {
namespace {

/// Between reading a file and looking at its time; the clock of files has ticks of some ms.
constexpr int64_t fresh = 50'000'000; // ns
constexpr int64_t fresh_by_seconds = 2'500'000'000;

int64_t nanoseconds(const timespec& time) {
    return int64_t{1'000'000'000} * time.tv_sec + time.tv_nsec;
}

int64_t now() {
    using namespace std::chrono;
    return duration_cast<std::chrono::nanoseconds>(system_clock::now().time_since_epoch()).count();
}

} // namespace

FileStamp stamp_of(const std::string& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return {};
    return {.is_there = true,
            .is_folder = S_ISDIR(status.st_mode),
            .is_file = S_ISREG(status.st_mode),
            .device = static_cast<uint64_t>(status.st_dev),
            .number = static_cast<uint64_t>(status.st_ino),
            .size = static_cast<uint64_t>(status.st_size),
            .modified = nanoseconds(status.st_mtim),
            .changed = nanoseconds(status.st_ctim)};
}

bool is_fresh(const FileStamp& stamp) {
    // An older file that was put in the place of another keeps the time of its bytes.
    const int64_t last = std::max(stamp.modified, stamp.changed);
    const bool has_whole_seconds = last % 1'000'000'000 == 0; // or two of them, as FAT does
    return stamp.is_there && last > now() - (has_whole_seconds ? fresh_by_seconds : fresh);
}

} // namespace app
