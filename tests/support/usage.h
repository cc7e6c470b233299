#pragma once

#include <optional>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/io_counts.h"

namespace test_support {

/// The resources used by a program, and how it ended.
struct Usage {
    int status = -1;          // of exit
    double cpu_seconds = 0.0; // of all threads // clock: for tests/speed
    long kib = 0;             // peak memory
    std::optional<IoCounts> io{};
};

/// Runs a program without a shell; its standard output goes to the given file.
inline Usage usage_of(const std::vector<std::string>& words, const std::string& output) {
    const pid_t child = ::fork();
    if (child == 0) {
        std::vector<char*> arguments;
        for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
        arguments.push_back(nullptr);
        const int file = ::open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        ::dup2(file, STDOUT_FILENO);
        ::execv(arguments[0], arguments.data());
        ::_exit(127);
    }
    siginfo_t ended{};
    ::waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT);
    const std::optional<IoCounts> io = io_counts(child);
    int status = 0;
    struct rusage usage = {};
    ::wait4(child, &status, 0, &usage);
    const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1,
            // clock: for tests/speed
            seconds(usage.ru_utime) + seconds(usage.ru_stime), usage.ru_maxrss, io};
}

} // namespace test_support
