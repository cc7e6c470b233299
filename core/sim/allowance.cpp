#include "core/sim/allowance.h"

#include <algorithm>
#include <array>

#include "core/sim/clearance.h"

namespace core {
namespace {

constexpr double default_contact = 0.05; // for pairs that may touch
constexpr double stock_distance = 1.0;   // of the holder and the machine from the stock
constexpr double fixture_distance = 2.0;

/// What a rule may call a body: by its own name, or by its kind.
struct Names {
    std::string own, kind;

    bool include(const std::string& name) const { return name == own || name == kind; }
};

/// The last rule that names the pair wins.
std::optional<Allowance> ruled(const Setup& setup, const Names& part, const Names& body) {
    std::optional<Allowance> found;
    for (const AllowanceRule& rule : setup.allowances) {
        const auto names = [&](size_t i, size_t j) {
            return part.include(rule.between[i]) && body.include(rule.between[j]);
        };
        if (names(0, 1) || names(1, 0)) found = Allowance{rule.distance, rule.contact};
    }
    return found;
}

Names names_of_body(const Setup& setup, const Pair& pair) {
    if (!pair.fixture) return {"stock", "stock"};
    const Fixture& fixture = setup.fixtures[*pair.fixture];
    return {fixture.name, fixture.is_machine ? "machine" : "fixture"};
}

} // namespace

Allowance allowance_of(const Setup& setup, const Pair& pair) {
    if (!setup.allowances.empty()) {
        const Names part{part_name(setup, pair), name_of(pair.part)};
        if (const auto rule = ruled(setup, part, names_of_body(setup, pair))) return *rule;
    }
    if (pair.fixture) return {setup.allowance.value_or(fixture_distance), 0.0};
    if (pair.part >= PartKind::holder) return {setup.allowance.value_or(stock_distance), 0.0};
    return {0.0, default_contact};
}

double search_limit_of(const Setup& setup) {
    double largest = setup.allowance.value_or(0.0);
    for (const AllowanceRule& rule : setup.allowances) largest = std::max(largest, rule.distance);
    return std::max(setup.search_limit, largest + 1.0);
}

bool names_a_kind(std::string_view name) {
    constexpr std::array<std::string_view, 7> kinds = {"flutes", "shank",   "holder", "nose",
                                                       "stock",  "fixture", "machine"};
    return std::find(kinds.begin(), kinds.end(), name) != kinds.end();
}

} // namespace core
