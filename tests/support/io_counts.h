#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>

#include <unistd.h>

namespace test_support {

/// The bytes and calls of read() and related functions of a process since its start.
struct IoCounts {
    uint64_t bytes = 0, reads = 0;
};

/// Empty if the kernel does not count. A process that has ended but has not been waited for still
/// has its counts.
inline std::optional<IoCounts> io_counts(pid_t process = ::getpid()) {
    std::ifstream file("/proc/" + std::to_string(process) + "/io");
    std::string name;
    IoCounts counts;
    bool has_bytes = false, has_reads = false;
    for (uint64_t value = 0; file >> name >> value;) {
        if (name == "rchar:") counts.bytes = value, has_bytes = true;
        if (name == "syscr:") counts.reads = value, has_reads = true;
    }
    if (!has_bytes || !has_reads) return {};
    return counts;
}

} // namespace test_support
