#pragma once

#include <chrono>

namespace app {

struct BatchProgress;
struct CheckProgress;

/// From now on SIGINT, SIGTERM and SIGHUP request a check to stop; a second signal at least half a
/// second later ends the process. Includes ignore_broken_pipes.
void stop_on_interrupt();

/// From now on a closed pipe does not end the process: writing to it fails, and other reports are
/// still written.
void ignore_broken_pipes();

/// Whether a stop was requested.
bool is_interrupted();

/// A progress line on standard error; prints nothing if that is not a terminal.
class ProgressLine {
public:
    ProgressLine();
    ~ProgressLine() { clear(); }
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    void show(const CheckProgress& progress);
    void show(const BatchProgress& progress);
    void clear();

private:
    using Clock = std::chrono::steady_clock;

    template <typename Progress>
    void show_any(const Progress& progress);

    bool is_terminal_;
    bool is_shown_ = false;
    Clock::time_point start_ = Clock::now();
    Clock::time_point last_ = start_;
};

/// Text of the line `seconds` after the start, at most 79 characters.
std::string progress_text(const CheckProgress& progress, double seconds);
std::string progress_text(const BatchProgress& progress, double seconds);

} // namespace app
