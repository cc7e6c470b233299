#pragma once

#include <chrono>
#include <csignal>
#include <string>
#include <vector>

#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

namespace test_support {

/// A program in a terminal, as used interactively.
class Terminal {
public:
    /// `words` are the program and its arguments, `home` is the home folder of its user.
    Terminal(const std::vector<std::string>& words, const std::string& home) {
        struct winsize size = {.ws_row = 40, .ws_col = 120, .ws_xpixel = 0, .ws_ypixel = 0};
        child_ = ::forkpty(&master_, nullptr, nullptr, &size);
        if (child_ != 0) return;
        std::vector<char*> arguments;
        for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
        arguments.push_back(nullptr);
        ::setenv("TERM", "dumb", 1);
        ::setenv("INPUTRC", "/dev/null", 1);
        ::setenv("HOME", home.c_str(), 1);
        ::unsetenv("XDG_STATE_HOME");
        ::execv(arguments[0], arguments.data());
        ::_exit(127);
    }
    ~Terminal() {
        if (child_ > 0) {
            ::kill(child_, SIGKILL);
            ::waitpid(child_, nullptr, 0);
        }
        ::close(master_);
    }
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;

    void type(const std::string& keys) {
        for (size_t at = 0; at < keys.size();) {
            const ssize_t written = ::write(master_, keys.data() + at, keys.size() - at);
            if (written <= 0) return;
            at += static_cast<size_t>(written);
        }
    }

    /// Runs an action while the program is stopped, so that the program sees all changes together.
    template <typename Action>
    void while_stopped(const Action& action) const {
        ::kill(child_, SIGSTOP);
        ::waitpid(child_, nullptr, WUNTRACED);
        action();
        ::kill(child_, SIGCONT);
    }

    /// Returns the screen up to and including this text; all of it if the text does not come in
    /// time.
    std::string until(const std::string& text) {
        const auto end = Clock::now() + patience; // clock: gives up after 2 min
        while (Clock::now() < end) {              // clock: as above
            if (const size_t at = screen_.find(text); at != std::string::npos) {
                const std::string seen = screen_.substr(0, at + text.size());
                screen_.erase(0, at + text.size());
                return seen;
            }
            if (!more()) break;
        }
        return "never '" + text + "' but: " + screen_;
    }

    /// Returns the output so far that has not been read.
    std::string seen_so_far() {
        struct pollfd ready = {.fd = master_, .events = POLLIN, .revents = 0};
        while (::poll(&ready, 1, 0) > 0 && more()) // clock: takes what is there
            ;
        return screen_;
    }

    /// The exit status of the program; -1 if it does not end in time.
    int status() {
        const auto end = Clock::now() + patience; // clock: gives up after 2 min
        while (more())
            if (Clock::now() > end) return -1; // clock: as above
        int status = -1;
        ::waitpid(child_, &status, 0);
        child_ = -1;
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }

private:
    using Clock = std::chrono::steady_clock; // clock: gives up after 2 min
    static constexpr std::chrono::seconds patience{120};

    /// Reads available output; false when the program has closed its side.
    bool more() {
        struct pollfd ready = {.fd = master_, .events = POLLIN, .revents = 0};
        if (::poll(&ready, 1, 1000) == 0) return true; // clock: polls
        char buffer[4096];
        const ssize_t count = ::read(master_, buffer, sizeof buffer);
        if (count <= 0) return false;
        screen_.append(buffer, static_cast<size_t>(count));
        return true;
    }

    int master_ = -1;
    pid_t child_ = -1;
    std::string screen_;
};

} // namespace test_support
