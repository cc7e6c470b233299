#include "app/library/result/batch_result.h"

#include <algorithm>

#include "app/base/findings.h"

namespace app {

int status_of(const BatchResult& batch) {
    int status = batch.unchecked.empty() ? 0 : 2;
    for (const ProgramResult& program : batch.programs)
        status = std::max(status, status_of(program));
    return status;
}

size_t count_of(const ProgramResult& result, core::Severity severity) {
    return count_of(result.findings, severity);
}

const char* name_of(Outcome outcome) {
    constexpr const char* names[] = {"clear",   "no error",   "no motion", "undecided",
                                     "errors",  "violation",  "collision", "stopped",
                                     "not run", "not checked"};
    return names[static_cast<size_t>(outcome)];
}

Outcome outcome_of(const ProgramResult& result) {
    if (result.error) return result.blocks == 0 ? Outcome::not_run : Outcome::stopped;
    switch (result.verdict) {
    case core::Verdict::undecided:
        return Outcome::undecided;
    case core::Verdict::violation:
        return Outcome::violation;
    case core::Verdict::collision:
        return Outcome::collision;
    case core::Verdict::clear:
        break;
    }
    if (result.coverage && !result.coverage->moves) return Outcome::no_motion;
    if (status_of(result) == 1) return Outcome::errors;
    return result.coverage && result.coverage->is_complete() ? Outcome::clear : Outcome::no_error;
}

} // namespace app
