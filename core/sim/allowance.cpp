#include "core/sim/allowance.h"

namespace core {
namespace {

constexpr double default_contact = 0.05; // for pairs that may touch
constexpr double holder_distance = 1.0;  // from the stock
constexpr double fixture_distance = 2.0;

/// The last rule that names the pair wins; a name stands for a body or a kind of body.
std::optional<Allowance> ruled(const Setup& setup, const std::string& part, const std::string& body,
                               const std::string& kind) {
    std::optional<Allowance> found;
    for (const AllowanceRule& rule : setup.allowances) {
        const auto names = [&](size_t i, size_t j) {
            return rule.between[i] == part && (rule.between[j] == body || rule.between[j] == kind);
        };
        if (names(0, 1) || names(1, 0)) found = Allowance{rule.distance, rule.contact};
    }
    return found;
}

} // namespace

Allowance stock_allowance(const Setup& setup, PartKind part) {
    if (const auto rule = ruled(setup, name_of(part), "stock", "stock")) return *rule;
    if (part == PartKind::holder) return {setup.allowance.value_or(holder_distance), 0.0};
    return {0.0, default_contact};
}

Allowance fixture_allowance(const Setup& setup, PartKind part, const Fixture& fixture) {
    if (const auto rule = ruled(setup, name_of(part), fixture.name, "fixture")) return *rule;
    return {setup.allowance.value_or(fixture_distance), 0.0};
}

} // namespace core
