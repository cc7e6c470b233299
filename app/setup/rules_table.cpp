#include "app/setup/rules_table.h"

#include <fmt/format.h>

namespace app {
namespace {

core::Severity severity_named(const std::string& word) {
    if (word == "off") return core::Severity::off;
    if (word == "note") return core::Severity::note;
    return word == "warning" ? core::Severity::warning : core::Severity::error;
}

} // namespace

core::RuleSeverities read_severities(TableReader& table, const std::string& but) {
    core::RuleSeverities severities;
    for (const std::string& rule : table.keys()) {
        if (rule == but) continue;
        const auto word = table.word(rule.c_str(), {"off", "note", "warning", "error"});
        if (!word) continue;
        if (!core::default_severity(rule)) {
            table.refuse(rule.c_str(),
                         fmt::format("is not the name of a rule; did you mean \"{}\"?",
                                     core::nearest_rule(rule)));
            continue;
        }
        severities[rule] = severity_named(*word);
        if (rule == "collision" && severities[rule] != core::Severity::error)
            table.refuse("collision", "is always an error");
    }
    return severities;
}

} // namespace app
