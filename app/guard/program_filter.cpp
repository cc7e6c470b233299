#include "app/guard/program_filter.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "app/base/findings.h"
#include "app/base/text.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/library/store/result_store.h"
#include "app/setup/control/offset_differences.h"
#include "app/setup/setup_file.h"
#include "gcode/language/canonical.h"

namespace app {
namespace {

/// "plate.ngc: COLLISION in line 12".
std::string headline(const ProgramResult& result) {
    return wrapped(fmt::format("{}: {}", result.program, headline_of(result)), 0, 2);
}

std::string error_words(const StoredError& error) {
    std::string place = error.file;
    if (error.line > 0) place += fmt::format("{}line {}", place.empty() ? "" : ", ", error.line);
    return wrapped(place.empty() ? error.message : place + ": " + error.message, 0, 2);
}

std::string finding_words(const StoredFinding& finding) {
    const std::string title =
        finding_title(finding) + finding_location(finding.line, finding.file, finding.text);
    std::string text = wrapped(title, 0, 2) + wrapped(finding.message, 2);
    if (const std::string cure = cure_text(finding); !cure.empty()) text += wrapped(cure, 2);
    return text;
}

} // namespace

std::string FilterProgress::line(double fraction, Clock::time_point now) {
    constexpr std::chrono::milliseconds pause(200);
    const int percent = static_cast<int>(100.0 * std::clamp(fraction, 0.0, 1.0));
    if (percent <= shown_ || (last_ && now - *last_ < pause)) return {};
    shown_ = percent;
    last_ = now;
    return fmt::format("FILTER_PROGRESS={}\n", percent);
}

core::Result<ProgramResult> filter_result(const CheckJob& job, ResultStore* store) {
    if (store) {
        if (auto found = store->find(job); found && *found) return **std::move(found);
    }
    FEELER_TRY(const CheckRun run, run_check(job));
    ProgramResult result = result_of(run, job.setup);
    if (store && store->keep(job, run, result)) static_cast<void>(store->flush());
    return result;
}

bool may_load(const ProgramResult& result) { return status_of(result) == 0; }

bool has_other_offsets(const ProgramResult& result) {
    return std::any_of(
        result.assumptions.begin(), result.assumptions.end(),
        [](const std::string& assumption) { return assumption.ends_with(differs_from_variables); });
}

std::string text_of_other_offsets(const OffsetComparison& compared) {
    constexpr double tolerance = 0.01; // mm or degrees
    std::string text;
    for (const ComparedOffset& value : compared.values) {
        const auto index = gcode::offset_of_name(value.work_offset);
        if (!index || !compared.used.contains(*index) || !value.setup || !value.control) continue;
        if (std::abs(*value.setup - *value.control) <= tolerance) continue;
        text += fmt::format("{} is {:.4f} in LinuxCNC and {:.4f} in the set-up ({}).\n", value.name,
                            *value.control, *value.setup, value.is_angle ? "degrees" : "mm");
    }
    if (text.empty()) return text;
    return text
           + wrapped("So the check is not about the place where LinuxCNC would run the program. "
                     "State the offset as it is, or leave it out of the set-up: then LinuxCNC's "
                     "counts, and the program must be loaded again after touching off.",
                     0, 2)
           + "\n" + not_loaded;
}

std::string refusal_text(const ProgramResult& result) {
    constexpr size_t most = 5;
    std::string text = headline(result);
    if (result.error) text += "\n" + error_words(*result.error);
    size_t errors = 0;
    for (const StoredFinding& finding : result.findings)
        if (finding.severity == core::Severity::error && errors++ < most)
            text += "\n" + finding_words(finding);
    if (errors > most)
        text +=
            fmt::format("\n{} in all; \"feeler check\" lists them.\n", counted(errors, "error"));
    return text + "\n" + not_loaded;
}

std::string passing_text(const ProgramResult& result) {
    std::string text = headline(result);
    if (const std::string uncovered = uncovered_text(result); !uncovered.empty())
        text += wrapped("not checked: " + uncovered, 2, 2);
    return text;
}

} // namespace app
