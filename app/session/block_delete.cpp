#include "app/session/block_delete.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/session/program_motions.h"
#include "core/sim/finding_text.h"

namespace app {
namespace {

/// A motion as a number; what differs in end, kind or arc differs in it, but for rare chances.
uint64_t digest_of(const core::Motion& motion) {
    uint64_t digest = 14695981039346656037U;
    const auto add = [&](double value) {
        digest = (digest ^ std::hash<double>{}(value)) * 1099511628211U;
    };
    add(static_cast<double>(motion.kind));
    for (const auto& place : {motion.from, motion.to})
        for (const auto& axis : place) add(axis.value_or(1e300));
    if (motion.arc) add(motion.arc->angle);
    return digest;
}

/// A motion, and the line that it comes from.
struct Step {
    uint64_t digest;
    uint32_t line;
};

std::vector<Step> steps_of(const gcode::Program& program, gcode::Environment environment,
                           bool block_delete) {
    environment.block_delete = block_delete;
    std::vector<Step> steps;
    visit_events(program, environment, [&](const ProgramEvent& event) {
        if (const auto* motion = std::get_if<core::Motion>(&event.event))
            steps.push_back({digest_of(*motion), event.line});
    });
    return steps;
}

} // namespace

void look_at_both_switch_positions(CheckRun& run, const gcode::Program& program,
                                   const gcode::Environment& environment) {
    const auto note = std::find_if(run.findings.begin(), run.findings.end(),
                                   [](const auto& f) { return f.rule == "block-delete"; });
    if (note == run.findings.end()) return;
    const std::vector<Step> off = steps_of(program, environment, false);
    const std::vector<Step> on = steps_of(program, environment, true);
    const auto [here, there] =
        std::mismatch(off.begin(), off.end(), on.begin(), on.end(),
                      [](const Step& a, const Step& b) { return a.digest == b.digest; });
    if (here == off.end() && there == on.end()) {
        note->message = "Blocks with '/' are run here; the path is the same with the switch on.";
        note->cure.clear();
        return;
    }
    note->severity = core::severity_of(run.setup, note->rule);
    note->message = fmt::format("blocks with '/' are run here; with the switch on at the machine "
                                "the path is another one from line {} on",
                                here != off.end() ? here->line : there->line);
}

} // namespace app
