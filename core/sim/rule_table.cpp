#include "core/sim/rule_table.h"

namespace core {
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
