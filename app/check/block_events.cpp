#include "app/check/block_events.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>

#include <fmt/format.h>

#include "core/base/rule_table.h"
#include "core/sim/setup.h"
#include "gcode/exec/following.h"
#include "gcode/lower/lowering.h"

namespace app {
namespace {

/// T0 empties the spindle, unless a tool has that number.
void take_tool_zero(core::Event& event) {
    auto* change = std::get_if<core::ToolChange>(&event);
    if (change && !change->tool) change->tool = core::ToolNumber{0};
}

/// Whether an M code takes effect after the motion of its block on all controls: M0, M1 and M60,
/// which stop the program. For other codes the machine builder decides.
bool comes_after_motion(int code) { return code == 0 || code == 1 || code == 60; }

bool is_of_line(const core::FixtureMove& move, const gcode::BlockCommands& block) {
    return move.line && block.file.empty() && block.line == *move.line;
}

/// The fixture changes of a block, before and after its motions.
struct FixtureEvents {
    std::vector<core::Event> before, after;
};

FixtureEvents fixture_events(const core::Setup& setup, const gcode::BlockCommands& block) {
    FixtureEvents events;
    for (const size_t i : fixture_moves_of(setup, block)) {
        const core::FixtureMove& move = setup.fixture_moves[i];
        const bool coded = !is_of_line(move, block);
        // If the order is unknown, the fixture is present at both positions during the motion.
        (coded ? events.after : events.before).emplace_back(core::FixtureChange{move.from, false});
        if (!move.to) continue;
        (coded && comes_after_motion(*move.code) ? events.after : events.before)
            .emplace_back(core::FixtureChange{*move.to, true});
    }
    return events;
}

void take_any_speed(core::Event& event) {
    auto* spindle = std::get_if<core::SpindleChange>(&event);
    if (spindle && spindle->speed == 0.0) spindle->speed = 1.0;
}

} // namespace

std::vector<size_t> fixture_moves_of(const core::Setup& setup, const gcode::BlockCommands& block) {
    std::vector<size_t> moves;
    for (size_t i = 0; i < setup.fixture_moves.size(); ++i) {
        const core::FixtureMove& move = setup.fixture_moves[i];
        if (is_of_line(move, block) || (move.code && has_m_code(block.text, *move.code)))
            moves.push_back(i);
    }
    return moves;
}

std::vector<core::Event> events_of(const core::Setup& setup, const gcode::BlockCommands& block,
                                   gcode::Lowering& lowering, bool speed_by_hand) {
    const FixtureEvents fixtures = fixture_events(setup, block);
    std::vector<core::Event> events = fixtures.before;
    for (core::Event& event : gcode::lower(block, lowering)) events.push_back(event);
    events.insert(events.end(), fixtures.after.begin(), fixtures.after.end());
    for (core::Event& event : events) {
        if (setup.tools.contains(core::ToolNumber{0})) take_tool_zero(event);
        if (speed_by_hand) take_any_speed(event);
    }
    return events;
}

std::optional<size_t> displaced_axis(std::span<const core::Event> events) {
    for (const core::Event& event : events) {
        const auto* motion = std::get_if<core::Motion>(&event);
        for (size_t axis = 3; motion && axis < core::axis_count; ++axis)
            if (motion->from[axis] != motion->to[axis]
                || gcode::is_away_from_zero(axis, motion->to[axis].value_or(0.0)))
                return axis;
    }
    return std::nullopt;
}

std::string doubt_about(const gcode::BlockCommands& block, std::span<const core::Event> events,
                        bool has_axes) {
    if (const auto axis = has_axes ? std::nullopt : displaced_axis(events))
        return fmt::format("axis {} is not described", core::axis_letters[*axis]);
    if (block.path == core::PathCertainty::doubtful) return "where the block leads is in doubt";
    if (block.path != core::PathCertainty::known) return "where the machine is, is not known";
    const auto is_doubt = [](const gcode::Warning& warning) {
        return warning.rule == core::rule_id("undecided");
    };
    return std::any_of(block.warnings.begin(), block.warnings.end(), is_doubt)
               ? "what the control makes of the block is not known"
               : "";
}

std::optional<NextBlock> first_block(const std::function<void(const BlockVisit&)>& show,
                                     bool has_axes) {
    std::optional<NextBlock> found;
    show([&](const gcode::BlockCommands& block, std::span<const core::Event> events) {
        found = {{events.begin(), events.end()}, doubt_about(block, events, has_axes)};
        return false;
    });
    return found;
}

bool has_m_code(std::string_view block, int code) {
    int depth = 0;
    for (size_t i = 0; i < block.size(); ++i) {
        const char c = block[i];
        if (c == ';' && depth == 0) return false;
        if (c == '(') ++depth;
        if (c == ')' && depth > 0) --depth;
        if (depth > 0 || (c != 'M' && c != 'm')) continue;
        size_t at = i + 1;
        while (at < block.size() && block[at] == ' ') ++at;
        std::string digits;
        while (at < block.size() && std::isdigit(static_cast<unsigned char>(block[at])))
            digits += block[at++];
        if (!digits.empty() && digits.size() < 6 && std::atoi(digits.c_str()) == code) return true;
    }
    return false;
}

} // namespace app
