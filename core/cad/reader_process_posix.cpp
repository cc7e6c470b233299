#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/cad/reader_process.h"

namespace core::cad {

namespace {

/// Starts a program that writes to `output`. Its process; 0 if it cannot be started.
pid_t start(const std::vector<std::string>& words, int output) {
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t files;
    ::posix_spawn_file_actions_init(&files);
    ::posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_adddup2(&files, output, STDOUT_FILENO);
    ::posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    pid_t process = 0;
    const int failed =
        ::posix_spawn(&process, arguments[0], &files, nullptr, arguments.data(), environ);
    ::posix_spawn_file_actions_destroy(&files);
    return failed == 0 ? process : 0;
}

/// Passes on what comes through a pipe until it is closed; whether `take` wanted all of it.
bool passed_on(int pipe, const std::function<bool(std::string_view)>& take) {
    constexpr int pause = 50; // ms
    std::vector<char> block(size_t{1} << 16U);
    while (true) {
        pollfd wait{pipe, POLLIN, 0};
        const int ready = ::poll(&wait, 1, pause);
        if (ready < 0 && errno != EINTR) return true;
        if (ready <= 0) {
            if (!take({})) return false;
            continue;
        }
        const ssize_t count = ::read(pipe, block.data(), block.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return true;
        if (!take({block.data(), static_cast<size_t>(count)})) return false;
    }
}

ReaderEnd end_of(pid_t process) {
    constexpr int loader_failed = 127;
    int status = 0;
    while (::waitpid(process, &status, 0) < 0)
        if (errno != EINTR) return ReaderEnd::crashed;
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return ReaderEnd::done;
    if (WIFEXITED(status) && WEXITSTATUS(status) == loader_failed) return ReaderEnd::no_library;
    const bool was_ended =
        WIFSIGNALED(status) && (WTERMSIG(status) == SIGTERM || WTERMSIG(status) == SIGINT);
    if (was_ended) return ReaderEnd::stopped;
    const bool was_too_slow =
        WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL);
    return was_too_slow ? ReaderEnd::out_of_time : ReaderEnd::crashed;
}

} // namespace

ReaderEnd run_reader(const std::vector<std::string>& words,
                     const std::function<bool(std::string_view)>& take) {
    std::array<int, 2> pipe{};
    if (::pipe2(pipe.data(), O_CLOEXEC) != 0) return ReaderEnd::not_there;
    const pid_t process = start(words, pipe[1]);
    ::close(pipe[1]);
    const bool all = process != 0 && passed_on(pipe[0], take);
    ::close(pipe[0]);
    if (process == 0) return ReaderEnd::not_there;
    if (!all) ::kill(process, SIGKILL);
    const ReaderEnd end = end_of(process);
    return all ? end : ReaderEnd::stopped;
}

} // namespace core::cad
