#include "app/session/cured_run.h"

#include "app/session/block_events.h"
#include "gcode/execution.h"

namespace app {

CuredRun::CuredRun(gcode::ProgramLibrary& library, const gcode::Environment& environment,
                   const core::Setup& setup, bool speed_by_hand, const ProgramPlace& before,
                   const LengthDoubt& doubt)
    : setup_(setup),
      speed_by_hand_(speed_by_hand),
      length_(doubt.length),
      interpreter_(library, environment),
      place_(before.at),
      lowering_(before.lowering),
      state_(before.state),
      offsets_(before.offsets) {
    if (!doubt.number) return;
    gcode::LengthOffset& entry = place_.tables.write().lengths[*doubt.number];
    entry.length = length_;
    entry.wear = 0.0;
}

void CuredRun::put_length_on() {
    const gcode::Offsets& offsets = place_.modal.offsets;
    if (offsets.tool[2] == length_) return;
    gcode::Offsets cured = offsets;
    cured.tool[2] = lowering_.offsets.tool[2] = length_;
    gcode::change_offsets(place_.modal, cured);
}

void CuredRun::follow(const gcode::BlockResult& real, const core::Setup& setup) {
    is_lost_ = is_lost_ || &setup != &setup_;
    if (is_lost_) return;
    put_length_on();
    const auto next = interpreter_.next(place_);
    is_lost_ = !next || !*next || (*next)->block != real.block || (*next)->line != real.line
               || (*next)->file != real.file;
    if (is_lost_) return;
    const gcode::BlockResult& block = **next;
    const std::vector<core::Event> events = events_of(setup_, block, lowering_, speed_by_hand_);
    const core::BlockEvents of_block{block.block, block.is_cycle, events, block.goes_home};
    core::BlockResult result = core::run_block(setup_, of_block, state_);
    is_lost_ = !result.checked;
    if (is_lost_) return;
    for (core::Finding& finding : result.findings) found_.push_back(std::move(finding));
    watch_offsets(offsets_, setup_, place_, of_block, state_);
    last_ = block.block;
}

void CuredRun::end(LengthDoubt& doubt) {
    const auto tool = state_.tool ? setup_.tools.find(*state_.tool) : setup_.tools.end();
    if (tool != setup_.tools.end())
        if (auto air = core::end_air(state_.watch.air, tool->second.description.diameter))
            found_.push_back(*std::move(air));
    for (core::Finding& finding : implausible_offsets(offsets_, setup_))
        found_.push_back(std::move(finding));
    doubt.cured_to = last_;
    doubt.left = std::move(found_);
}

} // namespace app
