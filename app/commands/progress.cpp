#include "app/commands/progress.h"

#include <csignal>
#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

namespace app {
namespace {

volatile std::sig_atomic_t interrupted = 0;

extern "C" void note_interrupt(int) {
    interrupted = 1;
    std::signal(SIGINT, SIG_DFL);
}

std::string duration_text(double seconds) {
    const auto whole = static_cast<long>(seconds + 0.5);
    if (whole >= 3600) return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
    if (whole >= 60) return fmt::format("{} min {} s", whole / 60, whole % 60);
    return fmt::format("{} s", whole);
}

} // namespace

void stop_on_interrupt() { std::signal(SIGINT, note_interrupt); }

bool is_interrupted() { return interrupted != 0; }

std::string progress_text(const CheckProgress& progress, double seconds) {
    constexpr int width = 20;
    const int filled = static_cast<int>(progress.share * width);
    std::string text = fmt::format(
        "[{}{}] {:3.0f} %  {} blocks, {} finding{}", std::string(static_cast<size_t>(filled), '#'),
        std::string(static_cast<size_t>(width - filled), '.'), 100.0 * progress.share,
        progress.blocks, progress.findings, progress.findings == 1 ? "" : "s");
    // Early guesses are worth nothing.
    if (progress.share > 0.02 && seconds > 1.0)
        text += fmt::format(", {} left",
                            duration_text(seconds * (1.0 - progress.share) / progress.share));
    return text.substr(0, 79);
}

ProgressLine::ProgressLine() : is_terminal_(isatty(STDERR_FILENO) == 1) {}

void ProgressLine::show(const CheckProgress& progress) {
    using namespace std::chrono_literals;
    if (!is_terminal_) return;
    const Clock::time_point now = Clock::now();
    if (now - last_ < 100ms) return;
    last_ = now;
    is_shown_ = true;
    const double seconds = std::chrono::duration<double>(now - start_).count();
    std::fputs(fmt::format("\r{:<79}", progress_text(progress, seconds)).c_str(), stderr);
    std::fflush(stderr);
}

void ProgressLine::clear() {
    if (!std::exchange(is_shown_, false)) return;
    std::fputs(fmt::format("\r{:79}\r", "").c_str(), stderr);
    std::fflush(stderr);
}

} // namespace app
