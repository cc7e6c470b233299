#include "app/session/block_runner.h"

#include <cctype>
#include <utility>

#include <fmt/format.h>

#include "app/session/block_events.h"

namespace app {
namespace {

/// As a sentence: with a capital, but for names, and a full stop.
std::string as_sentence(std::string text) {
    const auto is_small = [&](size_t i) {
        return i < text.size()
               && (std::islower(static_cast<unsigned char>(text[i])) || text[i] == ' ');
    };
    if (is_small(0) && is_small(1))
        text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    if (!text.empty() && text.back() != '.') text += '.';
    return text;
}

} // namespace

core::Error named(core::Error error, const std::string& file) {
    if (error.file.empty()) error.file = file;
    return error;
}

core::Finding remark(const core::Setup& setup, const gcode::Warning& warning) {
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

std::optional<std::vector<core::Event>>
first_events(const std::function<void(const BlockVisit&)>& show) {
    std::optional<std::vector<core::Event>> found;
    show([&](const gcode::BlockResult&, std::span<const core::Event> events) {
        found.emplace(events.begin(), events.end());
        return false;
    });
    return found;
}

std::optional<core::Error> BlockRunner::refusal(const gcode::BlockResult& block,
                                                const gcode::Lowering& lowering) const {
    if (lowering.moved_tilted)
        return core::Error{core::ErrorCode::unsupported,
                           {.line = block.line, .column = 1},
                           "this block moves in a tilted plane or with a tool that is turned, "
                           "and the machine of the set-up has no rotary axes that could: add "
                           "them as [[axis]]",
                           std::string(block.file)};
    if (!lowering.other_axis) return std::nullopt;
    return core::Error{core::ErrorCode::unsupported,
                       {.line = block.line, .column = 1},
                       fmt::format("this block moves axis {}, which the machine of the set-up "
                                   "does not have: add an [[axis]] of that name to its machine",
                                   gcode::axis_letters[*lowering.other_axis]),
                       std::string(block.file)};
}

void BlockRunner::remark_on(const gcode::BlockResult& block, const RunPlace& place,
                            std::vector<core::Finding>& findings) const {
    for (const gcode::Warning& warning : block.warnings) {
        // What the set-up states is stated, be it all zero.
        const auto active = static_cast<int>(place.control.modal.offsets.active);
        if (warning.rule == "work-offset-unset" && check_.file.offsets_set.contains(active))
            continue;
        core::Finding finding = remark(*setup_, warning);
        finding.block = block.block;
        if (finding.severity != core::Severity::off) findings.push_back(std::move(finding));
    }
}

core::Result<std::optional<BlockStep>> BlockRunner::step(RunPlace& place) {
    before_ = place.control;
    const auto next = interpreter_.next(place.control);
    if (!next) return tl::unexpected(named(next.error(), check_.program->file));
    if (!*next) return std::nullopt;
    const gcode::BlockResult& block = **next;
    const gcode::Lowering lowering_before = place.lowering;
    const std::vector<core::Event> events =
        events_of(*setup_, block, place.lowering, check_.file.speed_by_hand);
    const auto give_up = [&](core::Error error) {
        place.control = before_;
        place.lowering = lowering_before;
        return tl::unexpected(named(std::move(error), check_.program->file));
    };
    if (auto refused = refusal(block, place.lowering)) return give_up(*std::move(refused));
    auto judged = judge ? judge(events, place.machine) : core::Judgement();
    if (!judged)
        return give_up({judged.error().code,
                        {.line = block.line, .column = 1},
                        std::move(judged).error().message,
                        std::string(block.file)});
    for (const size_t move : fixture_moves_of(*setup_, block)) place.moves_made.insert(move);
    BlockStep step{{block.block,
                    block.line,
                    std::string(block.text),
                    std::string(block.file),
                    block.calls,
                    {}}};
    const core::BlockEvents of_block{block.block, block.is_cycle, events, block.goes_home,
                                     judge ? &*judged : nullptr};
    watch_length(place.lengths, *setup_, of_block, block.warnings, place.machine);
    if (before_block)
        before_block(block,
                     {before_, lowering_before, place.machine, place.offsets, place.lengths});
    step.checked.result = core::run_block(*setup_, of_block, place.machine);
    remark_on(block, place, step.findings);
    for (core::Finding& finding : step.checked.result.findings) step.findings.push_back(finding);
    watch_offsets(place.offsets, *setup_, place.control, of_block, place.machine);
    watch_units(place.units, of_block);
    core::add_block(place.clock, of_block, step.timed);
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
