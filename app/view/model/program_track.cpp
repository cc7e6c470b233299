#include "app/view/model/program_track.h"

#include <algorithm>

#include "app/check/block_runner.h"
#include "app/check/prepared_check.h"
#include "core/motion/path.h"
#include "gcode/exec/interpreter.h"
#include "gcode/language/canonical.h"
#include "gcode/lower/lowering.h"
#include "render/motion_path.h"

namespace app::viewer {
namespace {

constexpr size_t most_rows = 2'000'000;

core::BlockMotion motion_of(core::MotionKind kind) {
    switch (kind) {
    case core::MotionKind::rapid:
        return core::BlockMotion::rapid;
    case core::MotionKind::feed:
        return core::BlockMotion::feed;
    case core::MotionKind::arc:
        return core::BlockMotion::arc;
    }
    return core::BlockMotion::none;
}

} // namespace

std::optional<core::AxisValues> known_values(const core::Machine& machine,
                                             const core::AxisPosition& position) {
    core::AxisValues values{};
    for (size_t i = 0; i < core::axis_count; ++i) {
        if (machine.axes[i].present && !position[i]) return {};
        values[i] = position[i].value_or(0.0);
    }
    return values;
}

ProgramTrack::ProgramTrack(const core::Setup& setup, size_t first,
                           std::optional<core::ToolNumber> tool)
    : setup_(setup), first_(first), tool_(tool ? tool : setup.tool_at_start) {}

bool ProgramTrack::add(const gcode::BlockCommands& block, std::span<const core::Event> events) {
    BlockRow& row = rows.emplace_back();
    row.line = block.line;
    row.text = block.text;
    row.file = block.file;
    row.depth = static_cast<uint32_t>(block.calls.size());
    row.time = time_;
    for (const core::Event& event : events) {
        if (const auto* change = std::get_if<core::ToolChange>(&event)) tool_ = change->tool;
        if (const auto* dwell = std::get_if<core::Dwell>(&event)) row.duration += dwell->seconds;
        if (const auto* motion = std::get_if<core::Motion>(&event)) add_motion(*motion, row);
    }
    if (block.is_cycle && moves(row)) row.motion = core::BlockMotion::cycle;
    row.tool = tool_;
    time_ += row.duration;
    return rows.size() < most_rows;
}

void ProgramTrack::add_motion(const core::Motion& motion, BlockRow& row) {
    row.motion = std::max(row.motion, motion_of(motion.kind));
    const core::Path path = core::path_of(motion, setup_.machine, drawing_error);
    row.duration += path.duration;
    render::append_motion(points, setup_, tool_length(), path,
                          {.block = static_cast<uint32_t>(first_ + rows.size() - 1),
                           .rapid = motion.kind == core::MotionKind::rapid});
}

double ProgramTrack::tool_length() const {
    if (!tool_) return 0.0;
    const auto found = setup_.tools.find(*tool_);
    return found == setup_.tools.end() ? 0.0 : found->second.length;
}

ProgramTrack track_of(const PreparedCheck& check, const core::Setup& setup,
                      const std::function<bool()>& is_closing) {
    const gcode::Environment& environment = check.file.environment;
    ProgramTrack track(setup);
    BlockRunner(check).visit_ahead(
        gcode::initial_state(environment), gcode::initial_lowering(environment),
        [&](const gcode::BlockCommands& block, std::span<const core::Event> events) {
            return track.add(block, events) && !is_closing();
        });
    return track;
}

std::optional<core::Error> why_nothing_runs(const PreparedCheck& check) {
    gcode::InterpreterState control = gcode::initial_state(check.file.environment);
    const auto next = gcode::Interpreter(*check.library, check.file.environment).next(control);
    if (!next) return next.error();
    if (*next) return std::nullopt;
    return core::Error{core::ErrorCode::missing_value, {}, "the program has no executable block"};
}

} // namespace app::viewer
