#include "app/batch/outcome.h"

namespace app {

const char* name_of(Outcome outcome) {
    constexpr const char* names[] = {"clear",     "undecided", "errors",  "violation",
                                     "collision", "stopped",   "not run", "not checked"};
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
    return status_of(result) == 0 ? Outcome::clear : Outcome::errors;
}

} // namespace app
