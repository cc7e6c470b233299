#include "core/sim/finding.h"

#include "core/base/text.h"
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

namespace {

/// `program` stands for what the interpreter remarks about a block.
constexpr RuleEntry rules[] = {
    {"collision", Severity::error},
    {"near-miss", Severity::error},
    {"undecided", Severity::error},
    {"missing-length-offset", Severity::error},
    {"offset-not-tool", Severity::warning},
    {"length-offset-cancelled", Severity::warning},
    {"tool-not-in-table", Severity::warning},
    {"stick-out-short", Severity::error},
    {"work-offset-unset", Severity::warning},
    {"offset-implausible", Severity::warning},
    {"home-through-part", Severity::error},
    {"machine-move-with-state", Severity::warning},
    {"rapid-in-stock", Severity::error},
    {"rapid-near-clamp", Severity::error},
    {"dog-leg-rapid", Severity::error},
    {"low-retract", Severity::warning},
    {"incremental-left-on", Severity::warning},
    {"state-left-over", Severity::warning},
    {"restart-in-the-middle", Severity::warning},
    {"units-jump", Severity::warning},
    {"missing-decimal-point", Severity::warning},
    {"block-delete", Severity::warning},
    {"arc-radius", Severity::error},
    {"over-engagement", Severity::warning},
    {"tool-change-unsafe", Severity::error},
    {"singular-orientation", Severity::warning},
    {"spindle-off", Severity::error},
    {"no-feed", Severity::error},
    {"over-travel", Severity::error},
    {"rotary-with-tool-down", Severity::error},
    {"first-move", Severity::warning},
    {"fixture-move", Severity::error},
    {"rest-material", Severity::note},
    {"gouge", Severity::error},
    {"loose-piece", Severity::warning},
    {"holder-into-wall", Severity::error},
    {"air-cut", Severity::note},
    {"refused", Severity::error},
    {"program", Severity::warning},
};

} // namespace

std::span<const RuleEntry> rule_table() { return rules; }

std::vector<std::string> rule_names() {
    std::vector<std::string> names;
    for (const RuleEntry& rule : rules) names.emplace_back(rule.name);
    return names;
}

} // namespace core
