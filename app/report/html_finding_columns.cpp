#include "app/report/html_finding_columns.h"

#include <algorithm>

#include "app/report/rule_tally.h"
#include "app/report/text_layout.h"

namespace app {
namespace {

/// The first findings of a program, the worst severities before others.
std::vector<const KeptFinding*> worst_findings(const ProgramResult& program, size_t most) {
    std::vector<const KeptFinding*> findings;
    for (const KeptFinding& finding : program.findings) findings.push_back(&finding);
    std::stable_sort(findings.begin(), findings.end(),
                     [](const auto* a, const auto* b) { return a->severity > b->severity; });
    if (findings.size() > most) findings.resize(most);
    return findings;
}

} // namespace

std::string pair_name(const std::array<std::string, 2>& pair) {
    return pair[0].empty() ? std::string() : pair[0] + " / " + pair[1];
}

int64_t shown_text(TextTable& texts, const std::string& text) {
    constexpr size_t longest = 2'000; // bytes
    return texts.index_of(clipped(trimmed(text), longest));
}

void FindingColumns::add(const ProgramResult& program) {
    const auto worst = worst_findings(program, most_);
    for (const KeptFinding* finding : worst) add(*finding);
    count_.add(static_cast<int64_t>(worst.size()));
    const auto tallies = rule_tallies(program);
    kinds_.add(static_cast<int64_t>(tallies.size()));
    for (const RuleTally& tally : tallies) {
        tally_.push_back(rules_.index_of(tally.rule));
        tally_.push_back(static_cast<int64_t>(tally.severity));
        tally_.push_back(static_cast<int64_t>(tally.findings));
    }
}

void FindingColumns::add(const KeptFinding& finding) {
    severity_.add(static_cast<int64_t>(finding.severity));
    rule_.add(rules_.index_of(finding.rule));
    block_.add(finding.block ? int64_t{*finding.block} : -1);
    line_.add(finding.line);
    file_.add(shown_text(texts_, finding.file));
    text_.add(shown_text(texts_, finding.text));
    message_.add(shown_text(texts_, finding.message));
    cure_.add(shown_text(texts_, finding.cure));
    pair_.add(shown_text(texts_, pair_name(finding.pair)));
    shortfall_.add(um_above(finding.shortfall));
}

std::string FindingColumns::json() const {
    return R"({"rules":)" + rules_.json() + R"(,"count":)" + count_.json() + R"(,"kinds":)"
           + kinds_.json() + R"(,"tally":)" + number_array(tally_) + R"(,"severity":)"
           + severity_.json() + R"(,"rule":)" + rule_.json() + R"(,"block":)" + block_.json()
           + R"(,"line":)" + line_.json() + R"(,"file":)" + file_.json() + R"(,"text":)"
           + text_.json() + R"(,"message":)" + message_.json() + R"(,"cure":)" + cure_.json()
           + R"(,"pair":)" + pair_.json() + R"(,"shortfall":)" + shortfall_.json() + "}";
}

} // namespace app
