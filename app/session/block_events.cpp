#include "app/session/block_events.h"

#include "app/session/m_codes.h"

namespace app {
namespace {

/// T0 empties the spindle, unless a tool has that number.
void take_tool_zero(core::Event& event) {
    auto* change = std::get_if<core::ToolChange>(&event);
    if (change && !change->tool) change->tool = core::ToolNumber{0};
}

/// The fixtures that are moved before a block.
std::vector<core::Event> fixture_events(const core::Setup& setup, const gcode::BlockResult& block) {
    std::vector<core::Event> events;
    for (const core::FixtureMove& move : setup.fixture_moves) {
        const bool here = move.line && block.file.empty() && block.line == *move.line;
        if (!here && !(move.code && has_m_code(block.text, *move.code))) continue;
        events.emplace_back(core::FixtureChange{move.from, false});
        if (move.to) events.emplace_back(core::FixtureChange{*move.to, true});
    }
    return events;
}

void take_any_speed(core::Event& event) {
    auto* spindle = std::get_if<core::SpindleChange>(&event);
    if (spindle && spindle->speed == 0.0) spindle->speed = 1.0;
}

} // namespace

std::vector<core::Event> events_of(const core::Setup& setup, const gcode::BlockResult& block,
                                   gcode::Lowering& lowering, bool speed_by_hand) {
    std::vector<core::Event> events = fixture_events(setup, block);
    for (core::Event& event : gcode::lower(block, lowering)) events.push_back(event);
    for (core::Event& event : events) {
        if (setup.tools.contains(core::ToolNumber{0})) take_tool_zero(event);
        if (speed_by_hand) take_any_speed(event);
    }
    return events;
}

} // namespace app
