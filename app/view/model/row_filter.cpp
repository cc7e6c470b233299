#include "app/view/model/row_filter.h"

#include <algorithm>
#include <map>
#include <sstream>

#include <fmt/format.h>

#include "app/debug/condition_parser.h"
#include "app/debug/inspected_value.h"
#include "core/base/text.h"

namespace app::viewer {
namespace {

using FindingsOfBlock = std::map<size_t, std::vector<const core::Finding*>>;

/// Whether an invalid condition was meant as one: it has a comparison or a logical operator, or
/// consists only of keywords.
bool is_meant_as_condition(const std::string& text) {
    if (text.find_first_of("<>=~&|") != std::string::npos) return true;
    std::istringstream words(core::lower_case(text));
    std::string word;
    bool only_names = true;
    while (words >> word) {
        if (word == "and" || word == "or" || word == "not") return true;
        only_names = only_names && truth_named(word);
    }
    return only_names;
}

FindingsOfBlock by_block(const std::vector<core::Finding>& findings) {
    FindingsOfBlock sorted;
    for (const core::Finding& finding : findings)
        if (finding.block) sorted[core::value_of(*finding.block)].push_back(&finding);
    return sorted;
}

} // namespace

RowFilter::RowFilter(const std::string& text) {
    const std::string wanted(core::stripped(text));
    if (wanted.empty()) return;
    auto condition = Condition::read(wanted);
    if (condition && !condition->uses_control()) {
        condition_ = *std::move(condition);
    } else if (condition) {
        refusal_ =
            fmt::format("The list cannot filter by {}, a value of the control. Shift+F9 sets a "
                        "breakpoint on it; ~ \"{}\" searches the lines for the text.",
                        condition->control_value(), wanted);
    } else if (is_meant_as_condition(wanted)) {
        refusal_ =
            fmt::format("Column {}: {}", condition.error().where.column, condition.error().message);
    } else {
        wanted_ = core::lower_case(wanted);
    }
}

std::vector<size_t> RowFilter::passed(const std::vector<BlockRow>& rows,
                                      const std::vector<core::Finding>& findings) const {
    std::vector<size_t> through;
    if (empty()) return through;
    const bool asks_findings = condition_ && condition_->wanted().findings;
    const FindingsOfBlock known = asks_findings ? by_block(findings) : FindingsOfBlock{};
    const auto holds = [&](size_t block) {
        if (!condition_)
            return core::lower_case(rows[block].text).find(wanted_) != std::string::npos;
        BlockFacts facts = facts_of(rows[block], block);
        if (const auto found = known.find(block); found != known.end())
            facts.findings = found->second;
        return condition_->holds(facts);
    };
    for (size_t block = 0; block < rows.size(); ++block)
        if (holds(block)) through.push_back(block);
    return through;
}

} // namespace app::viewer
