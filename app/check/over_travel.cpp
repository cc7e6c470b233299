#include "app/check/over_travel.h"

#include <iterator>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "app/base/text.h"
#include "app/check/check_run.h"
#include "gcode/language/canonical.h"
#include "gcode/language/control.h"
#include "gcode/language/environment.h"

namespace app {
namespace {

/// The findings about one limit of an axis.
struct Excess {
    size_t first = 0, farthest = 0; // indices of findings
    std::vector<core::BlockIndex> blocks;
};

/// "line 12", "line 12 of sub.nc".
std::string line_text(const CheckedBlock& block) {
    return fmt::format("line {}{}", block.line,
                       block.file.empty() ? std::string() : " of " + trimmed(block.file));
}

/// "line 7", "lines 7, 9-12"; of the program or of one subprogram. Empty if they are in several.
std::string lines_text(const CheckRecord& record, const std::vector<core::BlockIndex>& blocks) {
    const CheckedBlock first = record.blocks[core::value_of(blocks.front())];
    std::vector<uint32_t> lines;
    for (const core::BlockIndex index : blocks) {
        const CheckedBlock block = record.blocks[core::value_of(index)];
        if (block.file != first.file) return {};
        if (lines.empty() || lines.back() != block.line) lines.push_back(block.line);
    }
    const std::string ranges = line_ranges(std::move(lines));
    const bool is_one = ranges.find_first_not_of("0123456789") == std::string::npos;
    return is_one ? line_text(first)
                  : fmt::format("lines {}{}", ranges,
                                first.file.empty() ? std::string() : " of " + trimmed(first.file));
}

/// Adds how many blocks go beyond the limit, and how far.
void add_extent(CheckRecord& record, const Excess& excess) {
    core::Finding& first = record.findings[excess.first];
    const core::Finding& farthest = record.findings[excess.farthest];
    const std::string lines = lines_text(record, excess.blocks);
    first.message += fmt::format(" {} blocks go beyond it{}, ", excess.blocks.size(),
                                 lines.empty() ? lines : " (" + lines + ")");
    if (excess.first == excess.farthest)
        first.message += "none of them farther.";
    else
        first.message += fmt::format("the farthest by {}, to {}, in {}.",
                                     core::beyond_text(*farthest.over_travel),
                                     core::target_text(*farthest.over_travel),
                                     line_text(record.blocks[core::value_of(*farthest.block)]));
}

} // namespace

void combine_over_travels(CheckRecord& record, CheckReport& report) {
    std::map<std::pair<size_t, bool>, Excess> limits;
    std::vector<size_t> combined;
    for (size_t i = 0; i < record.findings.size(); ++i) {
        const core::Finding& finding = record.findings[i];
        if (!finding.over_travel || !finding.block) continue;
        const core::OverTravel& far = *finding.over_travel;
        const auto [at, is_new] = limits.try_emplace({far.axis, far.is_upper}, Excess{i, i, {}});
        Excess& excess = at->second;
        if (!is_new) combined.push_back(i);
        if (far.beyond > record.findings[excess.farthest].over_travel->beyond) excess.farthest = i;
        if (excess.blocks.empty() || excess.blocks.back() != *finding.block)
            excess.blocks.push_back(*finding.block);
    }
    for (const auto& [limit, excess] : limits)
        if (excess.blocks.size() > 1)
            add_extent(record, excess);
        else // several motions of one block
            record.findings[excess.first].message = record.findings[excess.farthest].message;
    std::vector<core::Finding> kept;
    auto next = combined.begin();
    for (size_t i = 0; i < record.findings.size(); ++i) {
        const bool is_combined = next != combined.end() && *next == i;
        if (is_combined) ++next;
        (is_combined ? report.combined_findings : kept).push_back(std::move(record.findings[i]));
    }
    record.findings = std::move(kept);
}

namespace {

/// Cure of a move to machine coordinates that goes beyond a limit of an axis.
std::string cure_of_machine_move(size_t axis, const gcode::Environment& environment,
                                 const gcode::Offsets& offsets) {
    constexpr gcode::ControlQuestion question = gcode::ControlQuestion::machine_moves_tip;
    const char letter = core::axis_letters[axis];
    const auto answer = environment.control.answer(question);
    const gcode::ControlParameter* parameter = gcode::find_parameter(question, environment.dialect);
    if (!parameter || offsets.tool[axis] == 0.0 || !answer.value_or(true))
        return fmt::format("Change the {} of this block: it is a machine coordinate, so neither "
                           "the work offset nor the position of the work has an effect on it.",
                           letter);
    const std::string cure =
        fmt::format("Add D0 to this block: a tool length is active, so it moves the tip of the "
                    "tool to this {}, and the machine farther.",
                    letter);
    if (answer) return cure;
    return fmt::format(
        "{} If the control moves the gauge line there, state \"{}\" = 1 under [control] "
        "in the set-up.",
        cure, parameter->key);
}

} // namespace

void cure_machine_moves(std::vector<core::Finding>& findings, const gcode::BlockCommands& block,
                        const gcode::Environment& environment, const gcode::Offsets& offsets) {
    if (!block.in_machine) return;
    for (core::Finding& finding : findings)
        if (finding.over_travel)
            finding.cure = cure_of_machine_move(finding.over_travel->axis, environment, offsets);
}

} // namespace app
