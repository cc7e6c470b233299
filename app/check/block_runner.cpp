#include "app/check/block_runner.h"

#include <cctype>
#include <utility>

#include <fmt/format.h>

#include "app/check/block_events.h"
#include "app/check/prepared_check.h"
#include "app/check/run_state.h"
#include "core/base/rule_table.h"
#include "core/base/text.h"
#include "gcode/text/source.h"

namespace app {
namespace {

/// Makes a sentence of a text: adds a full stop, and a capital unless the text begins with a name.
std::string as_sentence(std::string text) {
    const auto is_small = [&](size_t i) {
        return i < text.size()
               && (std::islower(static_cast<unsigned char>(text[i])) || text[i] == ' ');
    };
    if (is_small(0) && is_small(1)) text[0] = core::upper(text[0]);
    if (!text.empty() && text.back() != '.') text += '.';
    return text;
}

} // namespace

core::Finding finding_of(const core::Setup& setup, const gcode::Warning& warning) {
    core::Finding finding;
    finding.rule = warning.rule;
    finding.severity = core::default_severity(finding.rule).value_or(core::Severity::warning);
    if (warning.severity == gcode::Severity::note) finding.severity = core::Severity::note;
    if (const auto set = setup.rules.find(finding.rule); set != setup.rules.end())
        finding.severity = set->second;
    finding.message = as_sentence(warning.message);
    finding.cure = warning.cure;
    return finding;
}

BlockRunner::BlockRunner(const PreparedCheck& check)
    : check_(check),
      setup_(&check.run.setup),
      interpreter_(*check.library, check.file.environment),
      next_(gcode::initial_state(check.file.environment)) {}

std::optional<core::Error> BlockRunner::refusal(const gcode::BlockCommands& block,
                                                const gcode::Lowering& lowering) const {
    if (lowering.moved_tilted)
        return core::Error{core::ErrorCode::unsupported,
                           {.line = block.line, .column = 1},
                           "this block moves in a tilted plane or with a tilted tool, but the "
                           "machine in the set-up has no rotary axes: add them as [[axis]]",
                           std::string(block.file)};
    if (!lowering.other_axis) return std::nullopt;
    return core::Error{core::ErrorCode::unsupported,
                       {.line = block.line, .column = 1},
                       fmt::format("this block moves axis {}, which the machine in the set-up does "
                                   "not have: add an [[axis]] of that name",
                                   gcode::axis_letters[*lowering.other_axis]),
                       std::string(block.file)};
}

void BlockRunner::add_warnings(const gcode::BlockCommands& block, const RunState& state,
                               std::vector<core::Finding>& findings) const {
    for (const gcode::Warning& warning : block.warnings) {
        // A work offset in the set-up counts as set even if it is all zeros.
        const auto active = static_cast<int>(state.control.modal.offsets.active);
        if (warning.rule == core::rule_id("work-offset-unset")
            && check_.file.offsets_set.contains(active))
            continue;
        core::Finding finding = finding_of(*setup_, warning);
        finding.block = block.block;
        if (finding.severity != core::Severity::off) findings.push_back(std::move(finding));
    }
}

core::Result<std::optional<BlockStep>> BlockRunner::step(RunState& state) {
    const auto failed = [&](core::Error error) {
        return tl::unexpected(core::in_file(std::move(error), check_.program->file));
    };
    next_ = state.control;
    const auto read = interpreter_.next(next_);
    if (!read) return failed(read.error());
    if (!*read) {
        std::swap(state.control, next_);
        return std::nullopt;
    }
    const gcode::BlockCommands& block = **read;
    gcode::Lowering lowering = state.lowering;
    const std::vector<core::Event> events =
        events_of(*setup_, block, lowering, check_.file.speed_by_hand);
    if (auto refused = refusal(block, lowering)) return failed(*std::move(refused));
    auto judged = judge ? judge(events, state.machine) : core::Judgement();
    if (!judged)
        return failed({judged.error().code,
                       {.line = block.line, .column = 1},
                       std::move(judged).error().message,
                       std::string(block.file)});
    for (const size_t move : fixture_moves_of(*setup_, block)) state.moves_made.insert(move);
    BlockStep step{{block.block,
                    block.line,
                    std::string(block.text),
                    std::string(block.file),
                    block.calls,
                    {}}};
    const core::BlockEvents of_block{block.block, block.is_cycle, events, block.goes_home,
                                     judge ? &*judged : nullptr};
    track_length(state.lengths, *setup_, of_block, block.warnings, state.machine);
    if (before_block) before_block(block, state);
    std::swap(state.control, next_);
    state.lowering = lowering;
    step.checked.result = core::run_block(*setup_, of_block, state.machine);
    add_warnings(block, state, step.findings);
    for (core::Finding& finding : step.checked.result.findings) step.findings.push_back(finding);
    track_offsets(state.offsets, *setup_, state.control, of_block, state.machine);
    track_units(state.units, of_block);
    core::add_block(state.clock, of_block, step.timed);
    return step;
}

void BlockRunner::visit_ahead(gcode::InterpreterState control, gcode::Lowering lowering,
                              const BlockVisit& visit) {
    while (true) {
        const auto next = interpreter_.next(control);
        if (!next || !*next) return;
        if (!visit(**next, events_of(*setup_, **next, lowering, check_.file.speed_by_hand))) return;
    }
}

} // namespace app
