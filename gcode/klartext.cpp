#include "gcode/klartext.h"

#include <fmt/format.h>

#include "gcode/error_rules.h"

namespace gcode {
namespace {

using core::ErrorCode;
using enum CommandKind;

/// Whether the block's code of a group is one that counts from the block's beginning.
bool begins_block(const Execution& execution, ModalGroup group, int last_tenths) {
    const CodeWord* entry = execution.statement.of(group);
    return entry && entry->code->tenths != last_tenths;
}

bool ends_block(const Execution& execution, ModalGroup group, int last_tenths) {
    const CodeWord* entry = execution.statement.of(group);
    return entry && entry->code->tenths == last_tenths;
}

void warn_of_m_codes(Execution& execution) {
    for (const Word* word : execution.statement.unknown_m_codes)
        execution.warn(word->span, fmt::format("{}: unknown here, so a code of the machine's "
                                               "builder; it is passed over",
                                               written(*word)));
    for (const CodeWord& entry : execution.statement.codes())
        if (entry.code->letter == 'M' && entry.code->tenths == tenths(128))
            execution.warn(entry.word->span, "M128: the linear axes do not follow the rotary ones "
                                             "here; ends are taken as they are written");
}

core::Result<void> take_feed(Execution& execution) {
    const CommandKind kind = execution.block.command.kind;
    if (kind == rounding || kind == chamfer) return {}; // it holds there alone
    if (const Word* word = execution.statement.word('E')) {
        if (!execution.state.klartext->call_feed)
            return core::fail(ErrorCode::missing_value,
                              "FAUTO: no TOOL CALL with an F came before it", word->span);
        execution.modal().feed = execution.state.klartext->call_feed;
    }
    return set_feed(execution);
}

core::Result<void> program_error_of(const Execution& execution) {
    const Word* word = execution.statement.word('P');
    return core::fail(ErrorCode::invalid_value,
                      fmt::format("FN 14: the program stops itself here with its error {:.12g}",
                                  word ? word->value : 0.0),
                      execution.block.command.span);
}

core::Result<void> run_statement(Execution& execution) {
    switch (execution.block.command.kind) {
    case none:
    case note:
    case modes:
        return {};
    case rounding:
    case chamfer:
        return make_corner(execution);
    case tool_call:
        return call_klartext_tool(execution);
    case tool_definition:
        return define_klartext_tool(execution);
    case cycle_definition:
        return define_cycle(execution);
    case read_system:
        return read_system_datum(execution);
    case program_error:
        return program_error_of(execution);
    default:
        return move_in_klartext(execution);
    }
}

bool is_motion(CommandKind kind) {
    return kind >= straight && kind <= tangent_polar && kind != pole;
}

/// M99 calls once, M89 after every motion from its own on, until M99 or another cycle.
core::Result<void> call_cycle(Execution& execution) {
    const Command& command = execution.block.command;
    KlartextState& klartext = execution.state.klartext.write();
    if (command.calls_from_here) klartext.calls_after_motions = true;
    const bool moves = is_motion(command.kind)
                       && (command.kind != straight || execution.statement.has_axis_word());
    const bool calls =
        command.calls_cycle || command.calls_from_here || (klartext.calls_after_motions && moves);
    if (command.calls_cycle) klartext.calls_after_motions = false;
    return calls ? call_defined_cycle(execution) : core::Result<void>{};
}

} // namespace

core::Result<void> run_klartext(Execution& execution) {
    const Command& command = execution.block.command;
    warn_of_m_codes(execution);
    const bool late_spindle = ends_block(execution, ModalGroup::spindle, tenths(5));
    const bool late_coolant = ends_block(execution, ModalGroup::coolant, tenths(9));
    for (const auto step : {set_units, select_plane, take_feed})
        if (auto done = step(execution); !done) return done;
    if (begins_block(execution, ModalGroup::spindle, tenths(5)))
        if (auto done = turn_spindle(execution); !done) return done;
    if (begins_block(execution, ModalGroup::coolant, tenths(9)))
        if (auto done = set_coolant(execution); !done) return done;
    if (auto done = run_statement(execution); !done) return done;
    const bool calls = command.calls_cycle || command.calls_from_here
                       || execution.state.klartext->calls_after_motions;
    if (calls)
        if (auto done = call_cycle(execution); !done) return done;
    if (late_spindle)
        if (auto done = turn_spindle(execution); !done) return done;
    if (late_coolant)
        if (auto done = set_coolant(execution); !done) return done;
    return stop(execution);
}

tl::unexpected<core::Error> refuse_statement(const Execution& execution, std::string_view why) {
    const core::SourceSpan where = execution.block.command.span;
    const std::string_view text = execution.block.text;
    const size_t begin = std::min<size_t>(where.column - 1, text.size());
    const std::string_view words = text.substr(begin, where.length);
    return core::fail(ErrorCode::invalid_value,
                      fmt::format("{}: {}", words.substr(0, words.find_first_of(";~\r\n")), why),
                      where);
}

core::Result<double> klartext_feed(const Execution& execution) {
    const std::optional<double> feed = execution.modal().feed;
    if (feed && *feed > 0.0) return *feed;
    tl::unexpected<core::Error> error = refuse_statement(
        execution, feed ? "this motion has the feed F0" : "no feed F came before this motion");
    error.value().code = no_feed;
    return error;
}

double q_number(const Execution& execution, int number) {
    return execution.state.parameters->numbered(number).value_or(0.0);
}

double q_length(const Execution& execution, int number) {
    return to_mm(q_number(execution, number), execution.modal().unit);
}

} // namespace gcode
