#include "app/check/program_use.h"

#include <algorithm>
#include <variant>

#include "app/check/prepared_check.h"
#include "gcode/exec/interpreter.h"
#include "gcode/language/canonical.h"
#include "gcode/text/source.h"

namespace app {
namespace {

bool has_motion(const gcode::BlockCommands& block) {
    return std::any_of(block.commands.begin(), block.commands.end(), gcode::is_motion);
}

bool has_feed(const gcode::BlockCommands& block) {
    return std::any_of(block.commands.begin(), block.commands.end(), [](const auto& command) {
        return gcode::is_motion(command)
               && !std::holds_alternative<gcode::StraightTraverse>(command);
    });
}

/// Whether program zero is not that of the work offset.
bool is_shifted(const gcode::Offsets& offsets) {
    const auto is_zero = [](double value) { return value == 0.0; };
    const auto is_known_zero = [](const auto& value) { return value && *value == 0.0; };
    return offsets.has_frame || offsets.work.rotation_deg != 0.0
           || !std::all_of(offsets.local.begin(), offsets.local.end(), is_zero)
           || !std::all_of(offsets.axis.begin(), offsets.axis.end(), is_known_zero);
}

template <typename Value>
void keep(std::set<Value>& values, const Value& value) {
    if (values.size() < most_kept_values) values.insert(value);
}

/// Collects the use of tools and offsets from the states after the blocks that move.
class UseCollector {
public:
    explicit UseCollector(const PreparedCheck& check) : check_(check) {}

    void add(const gcode::BlockCommands& block, const gcode::ModalState& modal) {
        for (const gcode::CanonicalCommand& command : block.commands)
            if (const auto* length = std::get_if<gcode::UseToolLengthOffset>(&command))
                length_ = *length;
        if (!has_motion(block)) return;
        add_tool(modal, has_feed(block));
        if (!block.in_machine) add_offset(block, modal.offsets);
    }
    ProgramUse use;

private:
    ToolUse& entry_of(const std::optional<core::ToolNumber>& tool) {
        const auto [at, is_new] = places_.try_emplace(tool, use.tools.size());
        if (is_new) use.tools.push_back({.tool = tool});
        return use.tools[at->second];
    }

    /// Rapids without a tool are on the way to the first tool change.
    void add_tool(const gcode::ModalState& modal, bool feeds) {
        const auto tool = modal.tool ? modal.tool : check_.run.setup.tool_at_start;
        if (!tool && !feeds) return;
        ToolUse& entry = entry_of(tool);
        if (feeds) add_length(entry);
        if (modal.compensation != gcode::Side::none && modal.radius_number > 0)
            keep(entry.radii, modal.radius_number);
        if (modal.spindle == core::SpindleDirection::stopped) return;
        entry.has_surface_speed = entry.has_surface_speed || modal.surface_speed;
        entry.least_speed = std::min(entry.least_speed.value_or(modal.speed), modal.speed);
        entry.most_speed = std::max(entry.most_speed.value_or(modal.speed), modal.speed);
    }

    /// Only feeds count: after a tool change the length of the tool before may still be in effect.
    void add_length(ToolUse& entry) const {
        const bool has_length = length_ && (length_->number || length_->offset[2] != 0.0);
        entry.feeds_without_length = entry.feeds_without_length || !has_length;
        if (!has_length) return;
        if (length_->number) keep(entry.lengths, *length_->number);
        keep(entry.control_lengths, length_->offset[2]);
        entry.length_is_assumed = entry.length_is_assumed || length_->is_assumed;
    }

    void add_offset(const gcode::BlockCommands& block, const gcode::Offsets& offsets) {
        const auto [at, is_new] = use.offsets.try_emplace(offsets.active);
        ZeroUse& entry = at->second;
        const gcode::AxisValues& origin = offsets.work.origin;
        if (is_new) {
            entry.origin = {origin[0], origin[1], origin[2]};
            if (offsets.active < gcode::work_offset_count
                && origin != check_.file.environment.work_offset(offsets.active))
                entry.set_in = main_line(block);
        } else if (!entry.set_in && entry.origin != core::Vec3(origin[0], origin[1], origin[2])) {
            entry.set_in = main_line(block);
        }
        if (!entry.shifted_in && is_shifted(offsets)) entry.shifted_in = main_line(block);
    }

    static uint32_t main_line(const gcode::BlockCommands& block) {
        return block.calls.empty() ? block.line : block.calls.front();
    }

    const PreparedCheck& check_;
    std::map<std::optional<core::ToolNumber>, size_t> places_; // in the list of tools
    std::optional<gcode::UseToolLengthOffset> length_;         // the last one
};

} // namespace

ProgramUse program_use(const PreparedCheck& check, const std::function<bool()>& is_stopped) {
    gcode::Environment environment = check.file.environment;
    environment.limits.is_stopped = is_stopped;
    gcode::Interpreter interpreter(*check.library, environment);
    gcode::InterpreterState state = gcode::initial_state(environment);
    UseCollector collector(check);
    while (true) {
        const auto block = interpreter.next(state);
        if (!block || !*block) return std::move(collector.use);
        collector.add(**block, state.modal);
    }
}

} // namespace app
