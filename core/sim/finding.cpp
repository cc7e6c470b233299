#include "core/sim/finding.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>
#include <vector>

#include "core/sim/verdict.h"

namespace core {
namespace {

/// Every rule a set-up may name, with its own severity. `program` stands for what the interpreter
/// remarks about a block.
constexpr std::array<std::pair<const char*, Severity>, 38> rules = {{
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
    {"program", Severity::warning},
}};

/// How many letters must be changed, put in or left out.
size_t letters_apart(const std::string& a, const std::string& b) {
    std::vector<size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), size_t{0});
    for (size_t i = 0; i < a.size(); ++i) {
        size_t diagonal = std::exchange(row[0], i + 1);
        for (size_t j = 0; j < b.size(); ++j) {
            const size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({changed, diagonal + 1, row[j] + 1});
        }
    }
    return row.back();
}

} // namespace

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
    for (const auto& [name, severity] : rules)
        if (rule == name) return severity;
    return std::nullopt;
}

std::string nearest_rule(const std::string& name) {
    const auto* nearest = std::min_element(rules.begin(), rules.end(), [&](auto& a, auto& b) {
        return letters_apart(name, a.first) < letters_apart(name, b.first);
    });
    return nearest->first;
}

} // namespace core
