#include "app/debug/prompt/state_text.h"

#include <filesystem>

#include <fmt/format.h>

#include "app/base/clearance_text.h"
#include "app/base/findings.h"
#include "app/base/text.h"
#include "app/check/check_run.h"
#include "app/setup/coverage.h"
#include "core/base/text.h"
#include "core/sim/verdict.h"

namespace app {
namespace {

std::string file_name(const std::string& path) {
    return std::filesystem::path(path).filename().generic_string();
}

const core::PairClearance* deciding_pair(const core::BlockResult& result) {
    return result.deciding ? &result.pairs[*result.deciding] : nullptr;
}

/// The closest pair: "holder to clamp-1: 0.420 mm, minimum 2 mm".
std::string nearness_text(const core::Setup& setup, const core::BlockResult& result) {
    const core::PairClearance* pair = deciding_pair(result);
    const ShownClearance clearance = shown_clearance(setup, result);
    const std::string distance = clearance_text(clearance, ClearanceStyle::sentence);
    if (!pair) return clearance.is_known ? distance + " from all bodies" : "clearance " + distance;
    std::string text = fmt::format("{} to {}: {}", core::part_name(setup, pair->pair),
                                   core::body_name(setup, pair->pair), distance);
    const double keep = pair->allowance.distance;
    if (keep > 0.0) text += fmt::format(", minimum {} mm", keep);
    return text;
}

/// The verdict, in capitals unless it is clear.
std::string verdict_word(core::Verdict verdict) {
    const std::string name = core::name_of(verdict);
    return verdict == core::Verdict::clear ? name : core::upper_case(name);
}

std::string motion_text(const core::Setup& setup, const core::BlockResult& result) {
    const std::string tool =
        result.tool ? fmt::format("T{}", core::value_of(*result.tool)) : "no tool";
    if (result.motion == core::BlockMotion::none) return "no motion, " + tool;
    return fmt::format("{}, {}, {:.2f} s | {} | {}", core::name_of(result.motion), tool,
                       result.duration, nearness_text(setup, result),
                       verdict_word(result.checked ? result.verdict : core::Verdict::undecided));
}

std::string block_text(const PromptState& state, const CheckedBlock& block) {
    std::string calls;
    for (auto call = block.calls.rbegin(); call != block.calls.rend(); ++call)
        calls += fmt::format("{}{}", calls.empty() ? ", called from line " : ", from ", *call);
    std::string text = fmt::format("block {}, {}{}: {}\n", core::value_of(block.block),
                                   line_text(block), calls, trimmed(block.text));
    return text
           + wrapped(motion_text(state.session.setup_at(state.session.at()), block.result), 4, 2);
}

std::string findings_here(const PromptState& state) {
    std::string text;
    const core::BlockIndex here{static_cast<uint32_t>(state.session.at())};
    for (const core::Finding& finding : state.session.record().findings)
        if (finding.block == here) text += finding_text(finding, 4);
    return text;
}

std::string end_text(const PromptState& state) {
    const CheckRun& record = state.session.record();
    const size_t blocks = state.session.at();
    if (!record.stopped)
        return fmt::format("the program has ended, after {}: {}\n", counted(blocks, "block"),
                           record.headline());
    const core::Error& error = *record.stopped;
    return wrapped(fmt::format("the control stops here with an alarm, after {}. Line {}: {}",
                               counted(blocks, "block"), error.where.line, error.message),
                   0, 2);
}

} // namespace

bool has_block(PromptState& state) {
    state.session.knows(state.session.at());
    return state.session.at() < state.session.record().blocks.size();
}

Condition::Subject subject_of(const PromptState& state) {
    return {state.session.record(), state.session.at(), &state.session.control(),
            &state.session.environment()};
}

std::string line_text(const CheckedBlock& block) {
    if (block.file.empty()) return fmt::format("line {}", block.line);
    return fmt::format("line {} of {}", block.line, trimmed(file_name(block.file)));
}

std::string finding_text(const core::Finding& finding, size_t indent) {
    std::string text = wrapped(finding_title(finding) + ": " + finding.message, indent, 2);
    if (!finding.cure.empty()) text += wrapped(cure_text(finding), indent + 2, 2);
    return text;
}

core::Result<InspectedValue> value_here(PromptState& state, const std::string& expression) {
    auto value = value_of(expression, state.session.control(), state.session.environment());
    if (value) return value;
    Condition::Subject subject = subject_of(state);
    if (!has_block(state)) { // at the end: of the last block
        if (subject.block == 0) return value;
        --subject.block;
    }
    return evaluate(expression, subject);
}

std::string displays_text(PromptState& state) {
    std::string text;
    for (const Display& display : state.displays) {
        const auto value = value_here(state, display.expression);
        text += fmt::format("    {}: {} = {}\n", display.id, display.expression,
                            value ? value->text : value.error().message);
    }
    return text;
}

std::string location_text(PromptState& state) {
    state.listed_to = 0;
    if (!has_block(state)) return end_text(state) + displays_text(state);
    const CheckedBlock block = state.session.record().blocks[state.session.at()];
    return block_text(state, block) + findings_here(state) + displays_text(state);
}

std::string stop_text(const PromptState& state, const Stop& stop) {
    switch (stop.reason) {
    case StopReason::breakpoint:
        for (const Breakpoint& breakpoint : state.session.breakpoints())
            if (breakpoint.id == stop.id)
                return fmt::format("breakpoint {}: {}\n", stop.id, text_of(breakpoint));
        return fmt::format("temporary breakpoint {}\n", stop.id);
    case StopReason::watch:
        return fmt::format("watchpoint {}: {}\n", stop.id, stop.message);
    case StopReason::beginning:
        return "the beginning of the program\n";
    case StopReason::interrupted:
        return "interrupted\n";
    default:
        return "";
    }
}

} // namespace app
