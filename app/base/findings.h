#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "app/base/text.h"
#include "core/sim/finding.h"

namespace app {

/// "error near-miss": severity and rule, with which the text of a finding begins. The severity
/// takes at least `width` characters.
std::string finding_title(const core::Finding& finding, size_t width = 0);

/// Where a finding is, after its title: ", line 12 of sub.nc: G0 Z5."; empty for line 0, if it is
/// about the program as a whole. `file` is that of a subprogram; of the block's text at most
/// `longest` bytes are shown.
std::string finding_location(uint32_t line, const std::string& file, const std::string& text,
                             size_t longest = 40);

/// "Cure: Raise Z."; empty without a cure.
std::string cure_text(const core::Finding& finding);

/// Findings that reports show as one: `Finding` is core::Finding or derived from it.
template <typename Finding>
struct GroupOf {
    std::vector<const Finding*> findings; // in their order
    const Finding* worst = nullptr;       // see core::is_worse; of equal ones the first
};

/// What a finding is about: its rule and its pair of bodies or, if it is about none, its message.
std::tuple<std::string, std::string, std::string> subject_of(const core::Finding& finding);

/// The findings in groups with equal keys, those that are off left out.
///
/// Result: sorted by the severity of their worst finding, then in the order of their first one.
template <typename Finding, typename KeyOf>
std::vector<GroupOf<Finding>> grouped_by(const std::vector<Finding>& findings, KeyOf key_of) {
    std::vector<GroupOf<Finding>> groups;
    std::map<decltype(key_of(findings.front())), size_t> known;
    for (const Finding& finding : findings) {
        if (finding.severity == core::Severity::off) continue;
        const auto [at, is_new] = known.try_emplace(key_of(finding), groups.size());
        if (is_new) groups.push_back({});
        GroupOf<Finding>& group = groups[at->second];
        group.findings.push_back(&finding);
        if (!group.worst || core::is_worse(finding, *group.worst)) group.worst = &finding;
    }
    std::stable_sort(groups.begin(), groups.end(), [](const auto& a, const auto& b) {
        return a.worst->severity > b.worst->severity;
    });
    return groups;
}

/// Whether a finding is an error other than an incomplete set-up.
bool is_error_of_program(const core::Finding& finding);

/// Whether a finding says that coverage is missing that is required.
bool lacks_coverage(const core::Finding& finding);

/// How many findings have this severity.
template <typename Finding>
size_t count_of(const std::vector<Finding>& findings, core::Severity severity) {
    return static_cast<size_t>(
        std::count_if(findings.begin(), findings.end(),
                      [&](const Finding& finding) { return finding.severity == severity; }));
}

/// "1 error, 2 warnings, 0 notes".
template <typename Finding>
std::string counts_text(const std::vector<Finding>& findings) {
    return counts_text(count_of(findings, core::Severity::error),
                       count_of(findings, core::Severity::warning),
                       count_of(findings, core::Severity::note));
}

} // namespace app
