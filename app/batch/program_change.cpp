#include "app/batch/program_change.h"

#include <array>
#include <map>
#include <tuple>

#include "app/batch/block_text.h"

namespace app {
namespace {

using Findings = std::vector<KeptFinding>;
using Identity = std::tuple<std::string, core::Severity, std::array<std::string, 2>, std::string>;

std::vector<Identity> identities(const Findings& findings, const PlaceOfFinding& place_of) {
    std::vector<Identity> named;
    for (const KeptFinding& finding : findings)
        named.emplace_back(finding.rule, finding.severity, finding.pair, place_of(finding));
    return named;
}

/// The findings that have none of the others to go with; those that do go one with one.
Findings missing_in(const std::vector<Identity>& others, const Findings& findings,
                    const std::vector<Identity>& named) {
    std::map<Identity, size_t> free;
    for (const Identity& identity : others) ++free[identity];
    Findings missing;
    for (size_t i = 0; i < findings.size(); ++i) {
        size_t& left = free[named[i]];
        if (left > 0)
            --left;
        else
            missing.push_back(findings[i]);
    }
    return missing;
}

double margin_of(const Tightest& tightest) {
    return tightest.upper.value_or(tightest.lower) - tightest.allowance;
}

} // namespace

ProgramChange change_between(const ProgramResult& before, const ProgramResult& after) {
    const PlaceOfFinding by_text = [](const KeptFinding& finding) {
        return finding.file + "\n" + numberless(finding.text);
    };
    return change_between(before, after, by_text, by_text);
}

ProgramChange change_between(const ProgramResult& before, const ProgramResult& after,
                             const PlaceOfFinding& place_before,
                             const PlaceOfFinding& place_after) {
    const auto were = identities(before.findings, place_before);
    const auto are = identities(after.findings, place_after);
    ProgramChange change{.verdict_differs = before.verdict != after.verdict,
                         .longer = after.cycle_time - before.cycle_time,
                         .new_findings = missing_in(were, after.findings, are),
                         .gone_findings = missing_in(are, before.findings, were)};
    if (before.tightest && after.tightest)
        change.nearer = margin_of(*before.tightest) - margin_of(*after.tightest);
    return change;
}

} // namespace app
