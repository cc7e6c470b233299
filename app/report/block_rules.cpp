#include "app/report/block_rules.h"

#include <algorithm>

namespace app {

std::map<core::BlockIndex, std::vector<std::string>> rules_of_blocks(const CheckRun& run) {
    std::vector<const core::Finding*> all;
    for (const auto* findings : {&run.findings, &run.taken_in})
        for (const core::Finding& finding : *findings)
            if (finding.block) all.push_back(&finding);
    std::stable_sort(all.begin(), all.end(),
                     [](const auto* a, const auto* b) { return a->severity > b->severity; });
    std::map<core::BlockIndex, std::vector<std::string>> rules;
    for (const core::Finding* finding : all) {
        std::vector<std::string>& some = rules[*finding->block];
        if (std::find(some.begin(), some.end(), finding->rule) == some.end())
            some.push_back(finding->rule);
    }
    return rules;
}

} // namespace app
