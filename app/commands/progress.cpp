#include "app/commands/progress.h"

#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <utility>

#include <fmt/format.h>

#include "app/base/text.h"
#include "app/check/check_run.h"
#include "app/library/run/batch_run.h"
#include "core/base/platform.h"

namespace app {
namespace {

// Lock-free: set by a signal handler, read by any thread.
std::atomic<int64_t> interrupted_at = 0; // ms of the steady clock; 0: never

/// Tools that signal a process group, such as timeout, deliver the same signal twice at once. Only
/// a second signal at least half a second later ends the process.
extern "C" void note_interrupt(int signal) {
    int64_t first = 0;
    const int64_t now = core::platform::steady_milliseconds();
    if (interrupted_at.compare_exchange_strong(first, now) || now - first < 500) return;
    core::platform::end_by_interrupt(signal);
}

/// Seconds as coarse as an estimate is: to 5 s below a minute, to 10 s above.
double rounded_up(double seconds) {
    const double unit = seconds < 10.0 ? 1.0 : seconds < 60.0 ? 5.0 : 10.0;
    return std::ceil(seconds / unit) * unit;
}

std::string bar_text(double fraction, const std::string& what, std::optional<double> left) {
    constexpr int width = 20;
    const int filled = static_cast<int>(fraction * width);
    std::string text =
        fmt::format("[{}{}] {:3.0f} %  {}", std::string(static_cast<size_t>(filled), '#'),
                    std::string(static_cast<size_t>(width - filled), '.'), 100.0 * fraction, what);
    if (left) text += fmt::format(", {} left", duration_text(rounded_up(*left)));
    return text.substr(0, 79);
}

} // namespace

void stop_on_interrupt() {
    core::platform::catch_interrupts(core::platform::Interrupts::all, note_interrupt);
    core::platform::ignore_broken_pipes();
}

bool is_interrupted() { return interrupted_at != 0; }

std::string progress_text(const CheckProgress& progress, std::optional<double> left) {
    return bar_text(
        progress.fraction,
        fmt::format("{} blocks, {}", progress.blocks, counted(progress.findings, "finding")), left);
}

std::string progress_text(const BatchProgress& progress, std::optional<double> left) {
    return bar_text(progress.fraction,
                    fmt::format("{} of {} programs, {} with errors", progress.done,
                                progress.programs, progress.with_errors),
                    left);
}

std::optional<double> TimeLeft::after(double seconds, double fraction) {
    constexpr double window = 10.0, least = 2.0;                                  // s
    if (!samples_.empty() && fraction < samples_.back().second) samples_.clear(); // a loop
    samples_.emplace_back(seconds, fraction);
    // Keep one sample that is older than the window.
    while (samples_.size() > 2 && samples_[1].first < seconds - window) samples_.pop_front();
    const auto [begin, done] = samples_.front();
    if (seconds - begin < least || fraction <= done || fraction >= 1.0) return std::nullopt;
    return (seconds - begin) * (1.0 - fraction) / (fraction - done);
}

ProgressLine::ProgressLine() : is_terminal_(core::platform::is_terminal(stderr)) {}

void ProgressLine::show(const CheckProgress& progress) { show_any(progress); }
void ProgressLine::show(const BatchProgress& progress) { show_any(progress); }

template <typename Progress>
void ProgressLine::show_any(const Progress& progress) {
    using namespace std::chrono_literals;
    if (!is_terminal_) return;
    const Clock::time_point now = Clock::now();
    if (now - last_ < 100ms) return;
    last_ = now;
    is_shown_ = true;
    const double seconds = std::chrono::duration<double>(now - start_).count();
    std::fputs(fmt::format("\r{:<79}",
                           progress_text(progress, time_left_.after(seconds, progress.fraction)))
                   .c_str(),
               stderr);
    std::fflush(stderr);
}

void ProgressLine::clear() {
    if (!std::exchange(is_shown_, false)) return;
    std::fputs(fmt::format("\r{:79}\r", "").c_str(), stderr);
    std::fflush(stderr);
}

} // namespace app
