#include "core/base/rule_table.h"

#include <algorithm>
#include <iterator>

#include "core/base/text.h"

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

std::span<const RuleEntry> rule_table() { return all_rules; }

const RuleEntry* find_rule(std::string_view name) {
    const auto* found = std::find_if(std::begin(all_rules), std::end(all_rules),
                                     [&](const RuleEntry& rule) { return rule.name == name; });
    return found == std::end(all_rules) ? nullptr : found;
}

std::string title_of_rule(const std::string& name) {
    const RuleEntry* rule = find_rule(name);
    return rule ? std::string(rule->title) : name;
}

std::vector<std::string> rule_names() {
    std::vector<std::string> names;
    for (const RuleEntry& rule : all_rules) names.emplace_back(rule.name);
    return names;
}

std::optional<Severity> default_severity(const std::string& rule) {
    const RuleEntry* entry = find_rule(rule);
    return entry ? std::optional(entry->severity) : std::nullopt;
}

std::string nearest_rule(const std::string& name) { return nearest_name(name, rule_names()); }

} // namespace core
