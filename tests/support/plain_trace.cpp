#include "tests/support/plain_trace.h"

#include "gcode/language/dialect.h"
#include "gcode/lower/trace.h"
#include "gcode/text/source.h"
#include "tests/support/reference_interpreter.h"

namespace test_support {
namespace {

/// Unknown coordinates are zero, where the reference starts.
Axes axes_of(const gcode::Position& position) {
    Axes axes{};
    for (size_t axis = 0; axis < 9; ++axis) axes[axis] = position[axis].value_or(0.0);
    return axes;
}

std::string name_of(core::SpindleDirection direction) {
    if (direction == core::SpindleDirection::stopped) return "stopped";
    return direction == core::SpindleDirection::clockwise ? "clockwise" : "counterclockwise";
}

void take_offsets(const gcode::Offsets& offsets, PlainState& state) {
    state.work_offset = static_cast<int>(offsets.active) + 1;
    state.work = offsets.work.origin;
    state.rotation_deg = offsets.work.rotation_deg;
    state.axis = axes_of(offsets.axis);
    for (size_t axis = 0; axis < 9; ++axis) state.axis[axis] += offsets.local[axis];
}

template <typename T>
void take_override(const T& command, PlainState& state) {
    bool* const switches[] = {&state.feed_override, &state.speed_override, &state.adaptive_feed,
                              &state.feed_hold};
    *switches[static_cast<size_t>(command.kind)] = command.enabled;
}

/// Modes changed by a command, by the names of its fields.
template <typename T>
void take_state(const T& command, PlainState& state) {
    if constexpr (requires { command.offsets; }) take_offsets(command.offsets, state);
    if constexpr (requires { command.mist; })
        state.mist = command.mist, state.flood = command.flood;
    if constexpr (requires { command.direction; })
        state.spindle = name_of(command.direction), state.speed = command.speed;
    if constexpr (requires { command.surface_speed; }) {
        state.speed = command.speed;
        state.fastest_speed = command.fastest_speed;
    }
    if constexpr (requires { command.plane; }) state.plane = gcode::name_of(command.plane);
    if constexpr (requires { command.naive_tolerance; }) {
        constexpr const char* names[] = {"exact_path", "exact_stop", "continuous"};
        state.path = names[static_cast<size_t>(command.mode)];
        state.tolerance = command.tolerance, state.naive_tolerance = command.naive_tolerance;
    }
    if constexpr (requires { command.enabled; }) take_override(command, state);
    if constexpr (requires { command.offset[8]; }) state.tool_offset = command.offset;
    if constexpr (requires { command.feed; }) state.feed = command.feed;
    if constexpr (requires { command.pitch; }) state.pitch = command.pitch;
    if constexpr (requires { *command.tool; })
        state.tool = command.tool ? core::value_of(*command.tool) : 0;
    else if constexpr (requires { command.tool; })
        state.selected_tool = core::value_of(command.tool);
}

/// The values of a command that is not a motion.
template <typename T>
std::vector<double> values_of(const T& command) {
    if constexpr (requires { command.with_motion; })
        return {double(command.number), command.value, double(command.is_analog),
                double(command.with_motion)};
    else if constexpr (requires { command.seconds; })
        return {command.seconds};
    else if constexpr (requires { *command.tool; })
        return {command.tool ? double(core::value_of(*command.tool)) : 0.0};
    else
        return {};
}

/// Modes take effect with the next command that is not a mode; modes that the reference does not
/// report are left out.
bool is_mode(const std::string& kind) {
    constexpr const char* modes[] = {
        "select_tool",      "spindle",         "coolant",
        "select_plane",     "set_offset",      "use_tool_length_offset",
        "set_path_mode",    "enable_override", "wait_for_input",
        "use_spindle_mode", "orient_spindle",  "set_feed_mode",
        "name_tool"};
    return std::find(std::begin(modes), std::end(modes), kind) != std::end(modes);
}

template <typename T>
void take(const T& said, size_t line, const std::string& kind, PlainState& state, PlainRun& run) {
    if constexpr (requires { said.text; }) {
        run.messages.push_back(said.text);
        return;
    }
    take_state(said, state);
    if (is_mode(kind)) return;
    PlainCommand command;
    command.line = line;
    command.kind = kind;
    command.state = state;
    if constexpr (requires { said.end; })
        command.end = axes_of(said.end);
    else
        command.values = values_of(said);
    if constexpr (requires { said.turns; }) {
        command.centre[0] = said.centre[0], command.centre[1] = said.centre[1];
        command.turns = said.turns;
    }
    if constexpr (requires { said.back_again; })
        if (said.back_again) command.kind = "rigid_tap";
    run.commands.push_back(command);
}

void add_tools(gcode::Environment& environment) {
    for (const ReferenceTool& tool : reference_tools()) {
        gcode::LengthOffset row;
        row.length = tool.offset[2];
        row.diameter = tool.diameter;
        row.shift = tool.offset;
        row.shift[2] = 0.0;
        row.front_deg = tool.front_deg, row.back_deg = tool.back_deg;
        row.orientation = tool.orientation;
        environment.length_offsets[core::OffsetNumber{tool.number}] = row;
    }
}

} // namespace

gcode::Environment reference_environment() {
    gcode::Environment environment;
    environment.dialect = gcode::DialectId::linuxcnc;
    environment.start = gcode::zero_position;
    add_tools(environment);
    return environment;
}

PlainRun plain_run(const gcode::Run& run) {
    PlainRun plain;
    PlainState state;
    for (const gcode::BlockCommands& block : run.blocks)
        for (const gcode::CanonicalCommand& command : block.commands)
            std::visit(
                [&](const auto& said) {
                    take(said, block.line, std::string(gcode::command_name(command)), state, plain);
                },
                command);
    if (!run.error) return plain;
    plain.refused = run.error->where.line;
    plain.message = run.error->message;
    return plain;
}

PlainRun run_feeler(const std::string& program) {
    const auto read = gcode::program_from_text(program, "program.ngc");
    if (read) return plain_run(gcode::run(*read, reference_environment()));
    PlainRun refused;
    refused.refused = read.error().where.line;
    refused.message = read.error().message;
    return refused;
}

} // namespace test_support
