#include "app/report/rule_tally.h"

#include <map>

namespace app {
namespace {

/// Sorts errors first.
using Key = std::pair<int, std::string>;

Key key_of(core::Severity severity, const std::string& rule) {
    return {-static_cast<int>(severity), rule};
}

std::vector<RuleTally> values_of(const std::map<Key, RuleTally>& tallies) {
    std::vector<RuleTally> values;
    for (const auto& [key, tally] : tallies) values.push_back(tally);
    return values;
}

} // namespace

std::vector<RuleTally> rule_tallies(const ProgramResult& program) {
    std::map<Key, RuleTally> tallies;
    for (const KeptFinding& finding : program.findings) {
        const RuleTally fresh{finding.severity, finding.rule, 1, 0};
        ++tallies.try_emplace(key_of(finding.severity, finding.rule), fresh).first->second.findings;
    }
    return values_of(tallies);
}

std::vector<RuleTally> rule_tallies(const BatchResult& batch) {
    std::map<Key, RuleTally> tallies;
    for (const ProgramResult& program : batch.programs)
        for (const RuleTally& here : rule_tallies(program)) {
            const RuleTally fresh{here.severity, here.rule, 0, 0};
            RuleTally& tally =
                tallies.try_emplace(key_of(here.severity, here.rule), fresh).first->second;
            ++tally.programs;
            tally.findings += here.findings;
        }
    return values_of(tallies);
}

} // namespace app
