#include "core/sim/finding.h"

#include <array>
#include <utility>

#include "core/sim/verdict.h"

namespace core {
namespace {

/// The rules of this version, with their own severities.
constexpr std::array<std::pair<const char*, Severity>, 14> rules = {{
    {"collision", Severity::error},
    {"near-miss", Severity::error},
    {"undecided", Severity::error},
    {"rapid-in-stock", Severity::error},
    {"rapid-near-clamp", Severity::error},
    {"holder-into-wall", Severity::error},
    {"spindle-off", Severity::error},
    {"tool-change-unsafe", Severity::error},
    {"over-travel", Severity::error},
    {"missing-length-offset", Severity::error},
    {"offset-not-tool", Severity::warning},
    {"tool-not-in-table", Severity::warning},
    {"first-move", Severity::warning},
    {"program", Severity::warning},
}};

} // namespace

const char* name_of(Severity severity) {
    switch (severity) {
    case Severity::off: return "off";
    case Severity::note: return "note";
    case Severity::warning: return "warning";
    default: return "error";
    }
}

const char* name_of(Verdict verdict) {
    switch (verdict) {
    case Verdict::clear: return "clear";
    case Verdict::undecided: return "undecided";
    case Verdict::violation: return "violation";
    default: return "collision";
    }
}

std::optional<Severity> default_severity(const std::string& rule) {
    for (const auto& [name, severity] : rules)
        if (rule == name) return severity;
    return std::nullopt;
}

} // namespace core
