#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "app/library/result/program_result.h"
#include "core/base/result.h"

namespace app {

struct CheckJob;
struct OffsetComparison;
class ResultStore;

/// The progress of a filter as LinuxCNC's windows read it: lines FILTER_PROGRESS=37 on standard
/// error. It only rises, and a window that reads ten lines a second keeps up.
class FilterProgress {
public:
    using Clock = std::chrono::steady_clock;

    /// The line to write at this time; empty if there is none. `fraction`: 0 to 1.
    std::string line(double fraction, Clock::time_point now);

private:
    int shown_ = -1;
    std::optional<Clock::time_point> last_;
};

/// The result of a job: that of an earlier check if nothing it depends on has changed since, or
/// that of a check, which is then stored. `store` may be null, and is not used if it fails.
///
/// Errors: those of run_check.
core::Result<ProgramResult> filter_result(const CheckJob& job, ResultStore* store);

/// Whether the control may load a program with this result: it was run to its end without an error.
bool may_load(const ProgramResult& result);

/// Whether the set-up states a work offset otherwise than the control's variables file.
bool has_other_offsets(const ProgramResult& result);

/// Which of these the program uses, with both values, and what to do; empty if there is none.
std::string text_of_other_offsets(const OffsetComparison& compared);

/// The end of what an operator is told of a program that the control must not load.
inline constexpr const char* not_loaded =
    "The program is not loaded. One that was loaded before still is.\n";

/// Why the control must not load it, for its operator: the verdict and the first errors, each with
/// its line, the block and the cure. UTF-8, with line ends.
std::string refusal_text(const ProgramResult& result);

/// What an operator should know of a program that is loaded: the verdict, and what was not checked.
std::string passing_text(const ProgramResult& result);

} // namespace app
