#pragma once

#include <chrono>
#include <csignal>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/scoped_folder.h"
#include "tests/support/shell.h"

namespace test_support {

/// Whether a process has a handler for a signal.
inline bool catches(pid_t process, int signal) {
    std::ifstream status("/proc/" + std::to_string(process) + "/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("SigCgt:"))
            return (std::stoull(line.substr(7), nullptr, 16) >> (signal - 1) & 1) != 0;
    return false;
}

/// A program that runs in parallel to the test, without a shell. Its output goes to files.
class RunningProgram {
public:
    explicit RunningProgram(const std::vector<std::string>& words) {
        child_ = ::fork();
        if (child_ == 0) {
            for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
            redirect("/dev/null", O_RDONLY, STDIN_FILENO);
            redirect(folder_ / "out", O_WRONLY | O_CREAT | O_APPEND, STDOUT_FILENO);
            redirect(folder_ / "err", O_WRONLY | O_CREAT | O_APPEND, STDERR_FILENO);
            std::vector<char*> arguments;
            for (const std::string& word : words)
                arguments.push_back(const_cast<char*>(word.c_str()));
            arguments.push_back(nullptr);
            ::execv(arguments[0], arguments.data());
            ::_exit(127);
        }
    }
    ~RunningProgram() {
        if (child_ <= 0) return;
        ::kill(child_, SIGKILL);
        ::waitpid(child_, nullptr, 0);
    }
    RunningProgram(const RunningProgram&) = delete;
    RunningProgram& operator=(const RunningProgram&) = delete;

    /// Waits until a condition is true. False if the program ends first, or after two minutes.
    template <typename Condition>
    bool wait_for(const Condition& condition) {
        // clock: gives up after 2 min
        const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(2);
        while (std::chrono::steady_clock::now() < end) { // clock: as above
            if (condition()) return true;
            siginfo_t ended{};
            ::waitid(P_PID, static_cast<id_t>(child_), &ended, WEXITED | WNOHANG | WNOWAIT);
            if (ended.si_pid != 0) return condition();
            std::this_thread::sleep_for(std::chrono::milliseconds(5)); // clock: polls
        }
        return false;
    }
    /// Waits until the program has written each of these texts to standard output.
    bool wait_for_output(const std::vector<std::string>& texts) {
        return wait_for([&] {
            const std::string out = bytes_of(folder_ / "out");
            for (const std::string& text : texts)
                if (out.find(text) == std::string::npos) return false;
            return true;
        });
    }
    bool wait_until_it_catches(int signal) {
        return wait_for([&] { return catches(child_, signal); });
    }

    void send(int signal) const { ::kill(child_, signal); }

    /// Waits for the end of the program.
    Ran result() {
        int status = 0;
        ::waitpid(child_, &status, 0);
        child_ = -1;
        const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        return {code, bytes_of(folder_ / "out"), bytes_of(folder_ / "err")};
    }

private:
    static void redirect(const std::string& path, int flags, int to) {
        ::dup2(::open(path.c_str(), flags, 0600), to);
    }

    const ScopedFolder folder_;
    pid_t child_ = -1;
};

} // namespace test_support
