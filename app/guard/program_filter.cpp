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
#include "app/setup/setup_file.h"

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

namespace {

/// The assumption that a work offset is another one than on the control; empty if there is none.
std::string_view offset_difference(const ProgramResult& result) {
    const auto found = std::find_if(
        result.assumptions.begin(), result.assumptions.end(),
        [](const std::string& assumption) { return assumption.ends_with(differs_from_variables); });
    return found == result.assumptions.end() ? std::string_view() : std::string_view(*found);
}

} // namespace

bool may_load(const ProgramResult& result) {
    return status_of(result) == 0 && offset_difference(result).empty();
}

std::string refusal_text(const ProgramResult& result) {
    constexpr size_t most = 5;
    std::string text = headline(result);
    if (result.error) text += "\n" + error_words(*result.error);
    size_t errors = 0;
    for (const StoredFinding& finding : result.findings)
        if (finding.severity == core::Severity::error && errors++ < most)
            text += "\n" + finding_words(finding);
    if (const std::string_view differing = offset_difference(result); !differing.empty())
        text += "\n"
                + wrapped(fmt::format("{}. So the check is not about the place where the control "
                                      "would run the program. State the offset as it is, or leave "
                                      "it out of the set-up: then that of the control counts, and "
                                      "the program must be loaded again after touching off.",
                                      differing),
                          0, 2);
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
