#pragma once

#include <chrono>
#include <deque>
#include <optional>
#include <string>
#include <utility>

namespace app {

struct BatchProgress;
struct CheckProgress;

/// From now on SIGINT, SIGTERM and SIGHUP request a check to stop; a second signal at least half a
/// second later ends the process. A closed pipe no longer ends it: writing to it fails, and other
/// reports are still written.
void stop_on_interrupt();

/// Whether a stop was requested.
bool is_interrupted();

/// Estimates the time left from the progress of the last seconds: blocks at the end of a program
/// often take much longer, or much less, than those at its beginning.
class TimeLeft {
public:
    /// The estimate in seconds; empty while it would be unreliable. Call it with rising times.
    std::optional<double> after(double seconds, double fraction);

private:
    std::deque<std::pair<double, double>> samples_; // seconds and fraction
};

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
    TimeLeft time_left_;
};

/// Text of the line, at most 79 characters, with the estimated time left, seconds, if any.
std::string progress_text(const CheckProgress& progress, std::optional<double> left);
std::string progress_text(const BatchProgress& progress, std::optional<double> left);

} // namespace app
