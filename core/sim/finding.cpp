#include "core/sim/finding.h"

#include "core/sim/setup.h"
#include "core/sim/verdict.h"

namespace core {

const char* name_of(Verdict verdict) {
    switch (verdict) {
    case Verdict::clear:
        return "clear";
    case Verdict::undecided:
        return "undecided";
    case Verdict::violation:
        return "violation";
    default:
        return "collision";
    }
}

Severity severity_of(const Setup& setup, const std::string& rule) {
    const auto set = setup.rules.find(rule);
    return set != setup.rules.end() ? set->second
                                    : default_severity(rule).value_or(Severity::warning);
}

void settle_severity(const Setup& setup, Finding& finding) {
    if (finding.severity != Severity::note || setup.rules.count(finding.rule))
        finding.severity = severity_of(setup, finding.rule);
}

} // namespace core
