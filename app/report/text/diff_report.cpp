#include "app/report/text/diff_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/base/clearance_text.h"
#include "app/base/findings.h"
#include "app/base/text.h"
#include "app/base/version.h"
#include "core/sim/verdict.h"

namespace app {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t few = 12; // blocks listed per kind without --blocks

std::string clearance_of(const BlockMeasure& block) {
    return clearance_text({block.margin.has_value(), block.lower, block.upper, block.allowance},
                          ClearanceStyle::column);
}

std::string clearance_in_mm(const BlockMeasure& block) {
    return clearance_of(block) + (block.margin ? " mm" : "");
}

std::string pair_text(const BlockMeasure& block) {
    return block.pair[0].empty() ? "" : trimmed(block.pair[0]) + " / " + trimmed(block.pair[1]);
}

/// "3.200 -> 0.120 mm, 3.080 nearer, holder / clamp-1". If the deciding pairs differ, so may their
/// minimum clearances; then margins are compared.
std::string change_text(const ChangedBlock& changed) {
    const BlockMeasure &was = changed.before, &is = changed.after;
    const double change = std::abs(changed.nearer);
    if (was.pair == is.pair && was.allowance == is.allowance) {
        std::string text = fmt::format("{} -> {}", clearance_of(was), clearance_in_mm(is));
        if (change > 0.0)
            text += fmt::format(", {:.3f} {}", change, changed.nearer > 0.0 ? "nearer" : "farther");
        return is.pair[0].empty() ? text : text + ", " + pair_text(is);
    }
    const auto side = [](const BlockMeasure& block) {
        const std::string pair = pair_text(block);
        return clearance_in_mm(block) + (pair.empty() ? "" : " " + pair);
    };
    std::string text = fmt::format("{} -> {}", side(was), side(is));
    if (change > 0.0)
        text += fmt::format(", margin {:.3f} {}", change, changed.nearer > 0.0 ? "less" : "more");
    return text;
}

std::string block_text(const ChangedBlock& changed) {
    const BlockMeasure &was = changed.before, &is = changed.after;
    std::string line = was.line == is.line ? fmt::format("line {}", is.line)
                                           : fmt::format("line {} -> {}", was.line, is.line);
    if (!is.file.empty()) line += " of " + trimmed(is.file);
    std::string text = fmt::format("  {:<18} {}\n", line, clipped(trimmed(is.text), 56));
    text += "      " + change_text(changed);
    if (was.verdict != is.verdict)
        text += fmt::format(", {} -> {}", core::name_of(was.verdict), core::name_of(is.verdict));
    return text + "\n";
}

std::string blocks_text(const char* title, const std::vector<ChangedBlock>& blocks, bool all) {
    if (blocks.empty()) return {};
    std::string text = fmt::format("{}:\n", title);
    const size_t shown = all ? blocks.size() : std::min(few, blocks.size());
    for (size_t i = 0; i < shown; ++i) text += block_text(blocks[i]);
    if (shown < blocks.size())
        text += fmt::format("  and {} more (--blocks lists them)\n", blocks.size() - shown);
    return text + "\n";
}

std::string finding_list(const char* title, const std::vector<StoredFinding>& findings) {
    if (findings.empty()) return {};
    std::string text = fmt::format("{}:\n", title);
    for (const StoredFinding& finding : findings) text += "  " + finding_line(finding) + "\n";
    return text + "\n";
}

std::string name_of_version(const ProgramResult& result) {
    return trimmed(result.setup.empty() ? result.program
                                        : result.program + " with " + result.setup);
}

Json block_json(const BlockMeasure& block) {
    Json json = {{"block", block.block}, {"line", block.line}};
    if (!block.file.empty()) json["file"] = utf8_text(block.file);
    json["text"] = utf8_text(block.text);
    json["verdict"] = core::name_of(block.verdict);
    const bool known = block.margin.has_value();
    json["clearance"] = nullptr;
    if (known)
        json["clearance"] = {{"lower", block.lower},
                             {"upper", block.upper ? Json(*block.upper) : Json(nullptr)}};
    const bool has_pair = !block.pair[0].empty();
    json["allowance"] = has_pair ? Json(block.allowance) : Json(nullptr);
    json["pair"] = has_pair ? Json(block.pair) : Json(nullptr);
    return json;
}

Json changed_json(const std::vector<ChangedBlock>& blocks) {
    Json list = Json::array();
    for (const ChangedBlock& each : blocks)
        list.push_back({{"nearer", each.nearer},
                        {"before", block_json(each.before)},
                        {"after", block_json(each.after)}});
    return list;
}

Json alone_json(const std::vector<BlockMeasure>& blocks) {
    Json list = Json::array();
    for (const BlockMeasure& each : blocks) list.push_back(block_json(each));
    return list;
}

} // namespace

std::string diff_text(const ProgramDiff& diff, bool all) {
    std::string text =
        fmt::format("{}\n-> {}\n\n", name_of_version(diff.before), name_of_version(diff.after));
    text += blocks_text("Nearer", diff.nearer, all) + blocks_text("Farther", diff.farther, all);
    text += finding_list("New findings", diff.change.new_findings);
    text += finding_list("Resolved findings", diff.change.gone_findings);
    text += fmt::format("{} nearer, {} farther, {} as before, {} new, {} gone\n",
                        counted(diff.nearer.size(), "block"), diff.farther.size(), diff.same,
                        diff.added.size(), diff.removed.size());
    text += fmt::format("Cycle time {} -> {}\n", duration_text(diff.before.cycle_time),
                        duration_text(diff.after.cycle_time));
    text += fmt::format("{} -> {}\n", headline_of(diff.before), headline_of(diff.after));
    if (const std::string uncovered = uncovered_text(diff.after); !uncovered.empty())
        text += wrapped("Unchecked: " + uncovered, 0, 2);
    return printable(text);
}

std::string diff_json(const ProgramDiff& diff) {
    const Json json = {{"feeler", version},
                       {"schema", 1},
                       {"before", Json::parse(json_of(diff.before))},
                       {"after", Json::parse(json_of(diff.after))},
                       {"worse", diff.is_worse()},
                       {"longer", diff.change.longer},
                       {"same", diff.same},
                       {"nearer", changed_json(diff.nearer)},
                       {"farther", changed_json(diff.farther)},
                       {"added", alone_json(diff.added)},
                       {"removed", alone_json(diff.removed)},
                       {"new_findings", findings_json(diff.change.new_findings)},
                       {"gone_findings", findings_json(diff.change.gone_findings)}};
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string finding_line(const StoredFinding& finding) {
    return finding_title(finding) + finding_location(finding.line, finding.file, finding.text);
}

nlohmann::ordered_json findings_json(const std::vector<StoredFinding>& findings) {
    ProgramResult holder;
    holder.findings = findings;
    return nlohmann::ordered_json::parse(json_of(holder)).at("findings");
}

} // namespace app
