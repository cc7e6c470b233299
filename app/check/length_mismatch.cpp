#include "app/check/length_mismatch.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "app/check/check_run.h"
#include "core/base/rule_table.h"
#include "core/sim/run/simulator.h"
#include "gcode/language/canonical.h"

namespace app {
namespace {

constexpr double wear = 1.0; // mm; smaller differences between table and tool count as wear

bool is_cause(std::string_view rule) {
    return rule == core::rule_id("missing-length-offset")
           || rule == core::rule_id("length-offset-cancelled")
           || rule == core::rule_id("offset-not-tool");
}

bool has_cause(std::span<const gcode::Warning> warnings) {
    return std::any_of(warnings.begin(), warnings.end(),
                       [](const gcode::Warning& warning) { return is_cause(warning.rule); });
}

/// The tool, and the length that the control uses, after the events of a block.
struct Counted {
    std::optional<core::ToolNumber> tool;
    core::LengthOffsetChange offset;
    bool is_new = false;

    void take(const core::ToolChange& change) {
        tool = change.tool;
        is_new = true;
    }
    void take(const core::LengthOffsetChange& change) {
        offset = change;
        is_new = true;
    }
    template <typename Other>
    void take(const Other&) {}
};

/// Whether a tool that is too low can cause a finding.
bool can_be_caused_by_length(const core::Finding& finding) {
    if (is_cause(finding.rule) || finding.rule == core::rule_id("spindle-off")) return false;
    if (finding.rule == core::rule_id("tool-change-unsafe")) return false;
    return finding.rule == core::rule_id("over-travel") || !finding.pair[0].empty()
           || finding.rule == core::rule_id("air-cut")
           || finding.rule == core::rule_id("offset-implausible")
           || finding.rule == core::rule_id("nothing-cut");
}

/// The axis letter, with which a finding about a limit begins.
char axis_of(const core::Finding& finding) { return finding.message.substr(0, 1)[0]; }

/// Whether a finding of the program as written and one of the corrected program have the same
/// subject, regardless of severity.
bool are_about_the_same(const core::Finding& found, const core::Finding& left) {
    if (!found.pair[0].empty()) return found.block == left.block && found.pair == left.pair;
    if (found.rule != left.rule) return false;
    if (found.rule == core::rule_id("over-travel"))
        return found.block == left.block && axis_of(found) == axis_of(left);
    return true; // a rule about many blocks
}

/// Whether the block of a finding was also run with the true length and then did not give it.
bool is_consequence(const LengthMismatch& mismatch, const core::Finding& finding) {
    if (!finding.block || *finding.block < mismatch.first || *finding.block > mismatch.last)
        return false;
    if (!mismatch.corrected_to || *finding.block > *mismatch.corrected_to) return false;
    return can_be_caused_by_length(finding)
           && std::none_of(mismatch.remaining.begin(), mismatch.remaining.end(),
                           [&](const auto& left) { return are_about_the_same(finding, left); });
}

/// "the stock", "clamp-1 and the stock", "clamp-1, clamp-2 and the stock".
std::string listed(const std::set<std::string>& names) {
    std::string text;
    size_t left = names.size();
    for (const std::string& name : names) {
        if (!text.empty()) text += left == 1 ? " and " : ", ";
        text += name;
        --left;
    }
    return text;
}

/// Whether the block of a finding collides.
bool collides_in(const CheckRecord& record, const core::Finding& finding) {
    const core::BlockResult block = record.blocks[core::value_of(*finding.block)].result;
    return block.verdict == core::Verdict::collision;
}

/// The consequences of a wrong length.
struct Consequences {
    std::set<core::BlockIndex> blocks;
    std::set<std::string> bodies;
    core::Severity worst = core::Severity::off;
    bool collides = false;

    void take(const CheckRecord& record, const core::Finding& finding) {
        worst = std::max(worst, finding.severity);
        const bool goes_too_far = finding.rule == core::rule_id("over-travel");
        if (finding.pair[0].empty() && !goes_too_far) return;
        blocks.insert(*finding.block);
        bodies.insert(goes_too_far                 ? "the limit of Z"
                      : finding.pair[1] == "stock" ? "the stock"
                                                   : finding.pair[1]);
        collides = collides || collides_in(record, finding);
    }
};

/// "The tool is 95.000 mm lower than intended and collides with the stock in 14 blocks from ...".
std::string sentence(const CheckRecord& record, const Consequences& all, double too_low) {
    const auto line = [&](core::BlockIndex block) {
        return record.blocks.line(core::value_of(block));
    };
    const std::string where =
        all.blocks.size() == 1
            ? fmt::format("in line {}", line(*all.blocks.begin()))
            : fmt::format("in {} blocks from line {} to line {}", all.blocks.size(),
                          line(*all.blocks.begin()), line(*all.blocks.rbegin()));
    return fmt::format("The tool is {:.3f} mm lower than intended and {} {} {}.", too_low,
                       all.collides ? "collides with" : "comes too close to", listed(all.bodies),
                       where);
}

std::optional<core::Finding> cause_of(const CheckRecord& record, const LengthMismatch& mismatch) {
    for (const core::Finding& finding : record.findings)
        if (finding.block == mismatch.first && is_cause(finding.rule)) return finding;
    return std::nullopt;
}

/// Adds the sentence to the finding of the cause, or to `first`, the first consequence, if the
/// cause has a lower severity.
void add_sentence(CheckRecord& record, const core::Finding& cause, const Consequences& all,
                  double too_low, std::optional<core::Finding> first) {
    if (all.blocks.empty()) return;
    const std::string what = sentence(record, all, too_low);
    const auto at =
        std::find_if(record.findings.begin(), record.findings.end(), [&](const auto& other) {
            return other.block == cause.block && other.rule == cause.rule;
        });
    if (!first) {
        at->message += " " + what;
        at->cure += " Then check again.";
        return;
    }
    first->message += fmt::format(" Cause: the length offset, see {} in line {}. {}", cause.rule,
                                  record.blocks.line(core::value_of(*cause.block)), what);
    first->cure = cause.cure + " Then check again.";
    record.findings.insert(at + 1, *std::move(first));
}

} // namespace

void track_length(LengthTracker& tracker, const core::Setup& setup, const core::BlockEvents& block,
                  std::span<const gcode::Warning> warnings, core::SimulatorState& state) {
    Counted counted{state.tool, state.length_offset};
    for (const core::Event& event : block.events)
        std::visit([&](const auto& one) { counted.take(one); }, event);
    if (counted.is_new) tracker.is_open = state.rules.length_in_doubt = false;
    if (tracker.is_open) tracker.mismatches.back().last = block.block;
    const bool has_finding = has_cause(warnings);
    if (!has_finding && !(counted.is_new && counted.offset.number)) return;
    const auto tool = counted.tool ? setup.tools.find(*counted.tool) : setup.tools.end();
    if (tool == setup.tools.end()) return;
    const double too_low = tool->second.length - counted.offset.length;
    if (too_low <= wear) return;
    state.rules.length_in_doubt = true;
    if (!has_finding) return;
    tracker.mismatches.push_back({.first = block.block,
                                  .last = block.block,
                                  .too_low = too_low,
                                  .length = tool->second.length,
                                  .number = counted.offset.number,
                                  .corrected_to = {},
                                  .remaining = {}});
    tracker.is_open = true;
}

void track_changed_length(LengthTracker& tracker, const core::Setup& setup,
                          core::SimulatorState& state) {
    const auto tool = state.tool ? setup.tools.find(*state.tool) : setup.tools.end();
    if (tool == setup.tools.end()) return;
    const bool is_short = tool->second.length - state.length_offset.length > wear;
    tracker.is_open = tracker.is_open && is_short;
    state.rules.length_in_doubt = is_short && (state.length_offset.number || tracker.is_open);
}

void combine_consequences(CheckRecord& record, CheckReport& report,
                          const std::vector<LengthMismatch>& mismatches) {
    for (const LengthMismatch& mismatch : mismatches) {
        const auto cause = cause_of(record, mismatch);
        if (!cause) continue;
        const auto is_caused = [&](const core::Finding& finding) {
            return is_consequence(mismatch, finding);
        };
        Consequences all;
        for (const core::Finding& finding : record.findings)
            if (is_caused(finding)) all.take(record, finding);
        std::optional<core::Finding> first;
        if (all.worst > cause->severity && !all.blocks.empty())
            first = *std::find_if(record.findings.begin(), record.findings.end(),
                                  [&](const auto& other) {
                                      return is_caused(other) && other.severity == all.worst
                                             && (!all.collides || collides_in(record, other));
                                  });
        std::copy_if(record.findings.begin(), record.findings.end(),
                     std::back_inserter(report.combined_findings), is_caused);
        std::erase_if(record.findings, is_caused);
        add_sentence(record, *cause, all, mismatch.too_low, std::move(first));
    }
}

} // namespace app
