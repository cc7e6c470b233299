#include "app/setup/coverage.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/base/text.h"
#include "core/base/rule_table.h"
#include "core/sim/finding.h"

namespace app {
namespace {

/// "holder of T1" or "holders of T1, T2".
std::string tools_text(const char* one, const char* several,
                       const std::vector<core::ToolNumber>& tools) {
    constexpr size_t most = 12;
    std::string text = tools.size() == 1 ? one : several;
    for (size_t i = 0; i < std::min(tools.size(), most); ++i)
        text += fmt::format("{} T{}", i == 0 ? "" : ",", core::value_of(tools[i]));
    return tools.size() > most ? text + fmt::format(" and {} more", tools.size() - most) : text;
}

/// The names of the items of which this is known.
std::string names_text(const Coverage& coverage, Known known) {
    std::string text;
    for (const CoverageItem& item : items_of(coverage)) {
        if (item.known != known) continue;
        if (coverage.limits_need_offsets && item.key == std::string_view("limits")) continue;
        if (coverage.stock_is_elsewhere && item.key == std::string_view("stock")) continue;
        std::string name = item.name;
        if (item.key == std::string_view("holders") && !coverage.tools_without_holder.empty())
            name = tools_text("holder of", "holders of", coverage.tools_without_holder);
        if (item.key == std::string_view("tools") && !coverage.tools_assumed.empty())
            name = tools_text("size of", "sizes of", coverage.tools_assumed);
        text += (text.empty() ? "" : ", ") + name;
    }
    return text;
}

} // namespace

const char* name_of(Known known) {
    constexpr const char* names[] = {"missing", "inferred", "described"};
    return names[static_cast<size_t>(known)];
}

std::array<CoverageItem, 7> items_of(const Coverage& coverage) {
    return {{{"stock", "stock", coverage.stock},
             {"tools", "sizes of tools", coverage.tools},
             {"holders", "holders", coverage.holders},
             {"fixtures", "fixtures", coverage.fixtures},
             {"offsets", "work offsets", coverage.offsets},
             {"limits", "axis limits", coverage.limits},
             {"start", "start position", coverage.start}}};
}

void count_tools(const std::set<core::ToolNumber>& feeding,
                 const std::set<core::ToolNumber>& moving,
                 const std::function<bool(core::ToolNumber)>& has_holder, Coverage& coverage) {
    coverage.tools_without_holder.clear();
    for (const core::ToolNumber number : feeding)
        if (!has_holder(number)) coverage.tools_without_holder.push_back(number);
    coverage.holders = coverage.tools_without_holder.empty() ? Known::described : Known::missing;
    std::erase_if(coverage.tools_assumed,
                  [&](core::ToolNumber number) { return !moving.contains(number); });
    coverage.tools = coverage.tools_assumed.empty() ? Known::described : Known::inferred;
}

void reduce_by(const std::vector<core::Finding>& findings, Coverage& coverage) {
    for (const core::Finding& finding : findings) {
        if (finding.rule == core::rule_id("nothing-moves")) coverage.moves = false;
        if (finding.rule == core::rule_id("first-move")) coverage.start = Known::inferred;
        if (finding.rule != core::rule_id("offset-implausible")) continue;
        coverage.stock_is_elsewhere |= coverage.stock == Known::described;
        coverage.stock = std::min(coverage.stock, Known::inferred);
    }
}

bool Coverage::is_complete() const {
    const auto items = items_of(*this);
    return std::all_of(items.begin(), items.end(),
                       [](const CoverageItem& item) { return item.known == Known::described; });
}

std::string uncovered_text(const Coverage& coverage) {
    const std::string missing = names_text(coverage, Known::missing);
    const std::string inferred = names_text(coverage, Known::inferred);
    std::string text = missing.empty() ? "" : missing + ": not described";
    if (!inferred.empty()) text += (text.empty() ? "" : "; ") + inferred + ": assumed";
    if (coverage.stock_is_elsewhere)
        text +=
            std::string(text.empty() ? "" : "; ") + "stock: not everywhere where the program cuts";
    if (coverage.limits_need_offsets)
        text += std::string(text.empty() ? "" : "; ")
                + "axis limits: not checked, because no work offset is stated";
    return text;
}

std::string headline_of(const Judged& judged, const Coverage& coverage) {
    if (judged.is_stopped) return "STOPPED, not checked to its end";
    if (judged.verdict != core::Verdict::clear) return verdict_text(judged.verdict);
    if (!coverage.moves) return "NOTHING CHECKED, the program moves nothing";
    if (judged.has_errors) return "ERRORS in the program; clearances are sufficient";
    if (judged.lacks_required)
        return "REQUIRED COVERAGE IS MISSING; no error in the program itself";
    return coverage.is_complete() ? verdict_text(judged.verdict) : "NO ERROR IN THE PROGRAM ITSELF";
}

} // namespace app
