#include "app/session/conclusion.h"

#include <algorithm>

#include "app/session/allowed_rules.h"
#include "app/session/block_delete.h"
#include "app/session/part_check.h"

namespace app {
namespace {

/// A program of which no motion could be judged has not been checked.
void look_for_judged_motions(CheckRun& run) {
    const CheckedBlock* first = nullptr;
    for (const CheckedBlock& block : run.blocks) {
        if (block.result.motion == core::BlockMotion::none) continue;
        if (block.result.checked) return;
        if (!first) first = &block;
    }
    if (!first) return;
    core::Finding finding;
    finding.rule = "undecided";
    finding.severity = core::Severity::error;
    finding.block = first->block;
    finding.message = "No motion of the program could be judged.";
    const bool is_lost = std::any_of(run.findings.begin(), run.findings.end(),
                                     [](const auto& f) { return f.rule == "first-move"; });
    finding.cure =
        !is_lost ? "Mend first what the other findings name."
                 : "Say where the axes stand at the first block: `start` under [program] in the "
                   "set-up, or the machine's home.";
    run.findings.push_back(finding);
}

/// Nobody shall take a program for checked whose motions were not looked at.
void say_not_judged(CheckRun& run, const std::string& why) {
    const auto moves = [](const CheckedBlock& block) {
        return block.result.motion != core::BlockMotion::none;
    };
    if (why.empty() || std::none_of(run.blocks.begin(), run.blocks.end(), moves)) return;
    core::Finding finding;
    finding.rule = "undecided";
    finding.severity = core::Severity::error;
    finding.message = "The motions were not checked: " + why + ".";
    finding.cure = "Check the program on the lathe's own control.";
    run.verdict = std::max(run.verdict, core::Verdict::undecided);
    run.findings.push_back(finding);
}

/// Findings in the order of their blocks, those about the program as a whole at the end.
void put_in_order(std::vector<core::Finding>& findings) {
    std::stable_sort(findings.begin(), findings.end(), [](const auto& a, const auto& b) {
        if (!a.block || !b.block) return a.block.has_value() && !b.block;
        return core::value_of(*a.block) < core::value_of(*b.block);
    });
}

} // namespace

void conclude(PreparedCheck& check, core::SimulatorState end,
              const std::vector<LengthDoubt>& doubts, bool needs_surface) {
    CheckRun& run = check.run;
    run.statistics = end.statistics;
    run.points = core::point_count(end.stock.lines);
    run.lines = core::line_count(end.stock.lines);
    for (const std::string& assumption : end.assumptions) run.assumptions.push_back(assumption);
    look_for_judged_motions(run);
    // Nobody shall take a program for clear of which a part was not checked.
    if (run.stopped) run.verdict = std::max(run.verdict, core::Verdict::undecided);
    put_in_order(run.findings);
    say_not_judged(run, check.file.not_judged);
    run.stock = std::move(end.stock);
    if (!run.stopped && (needs_surface || run.setup.part))
        run.surface = core::stock_mesh(*run.stock);
    check_part(run);
    look_at_both_switch_positions(run, *check.program, check.file.environment);
    apply_allowed_rules(run, check.file.allow_comments);
    gather_consequences(run, doubts);
}

} // namespace app
