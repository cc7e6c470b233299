#pragma once

#include <chrono>

namespace app {

struct BatchProgress;
struct CheckProgress;

/// From now on Ctrl-C, and what a scheduler or a closed terminal sends, asks a check to stop, once;
/// the next one, half a second later or more, ends the process. Outlives readers, too.
void stop_on_interrupt();

/// From now on a reader of our output that goes away ends nothing: writing fails, and reports that
/// go elsewhere are written all the same.
void outlive_readers();

/// Whether something did.
bool is_interrupted();

/// A line on standard error that says how far a check has come; nothing unless that is a terminal.
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

/// What the line says, `seconds` after the start. No longer than 79 characters.
std::string progress_text(const CheckProgress& progress, double seconds);
std::string progress_text(const BatchProgress& progress, double seconds);

} // namespace app
