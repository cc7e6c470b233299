#include "core/sim/finding.h"

#include "core/base/nearest_name.h"
#include "core/sim/rule_table.h"
#include "core/sim/setup.h"
#include "core/sim/verdict.h"

namespace core {

const char* name_of(Severity severity) {
    switch (severity) {
    case Severity::off:
        return "off";
    case Severity::note:
        return "note";
    case Severity::warning:
        return "warning";
    default:
        return "error";
    }
}

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

std::optional<Severity> default_severity(const std::string& rule) {
    for (const auto& [name, severity] : rule_table())
        if (rule == name) return severity;
    return std::nullopt;
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

std::string nearest_rule(const std::string& name) { return nearest_name(name, rule_names()); }

} // namespace core
