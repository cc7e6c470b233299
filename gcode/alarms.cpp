#include "gcode/alarms.h"

#include <fmt/format.h>

#include "gcode/fanuc_parameters.h"

namespace gcode {

core::Result<void> heed_alarm(const Block& block, const Dialect& dialect, double number,
                              Value value, core::SourceSpan where, BlockResult& result) {
    constexpr double alarm = 3000.0, message_stop = 3006.0;
    if (!remembers_words(dialect.system_parameters)) return {};
    const std::string text =
        block.comments.empty() ? std::string() : std::string(block.comments.back().text);
    if (number == alarm)
        return core::fail(core::ErrorCode::invalid_value,
                          fmt::format("the program raises alarm {:.12g} here{}{}; the control goes "
                                      "no further",
                                      dialect.first_alarm + value.value_or(0.0),
                                      text.empty() ? "" : ": ", text),
                          where);
    if (number != message_stop) return {};
    if (!text.empty()) {
        result.commands.emplace_back(Message{text});
        result.columns.push_back(where.column);
    }
    result.commands.emplace_back(ProgramStop{});
    result.columns.push_back(where.column);
    return {};
}

void note_clock(const Block& block, InterpreterState& state, BlockResult& result) {
    const auto& steps = block.pool.instructions;
    for (size_t i = 0; !state.said_time && i + 1 < steps.size(); ++i) {
        const bool reads = steps[i].operation == Operation::number
                           && steps[i + 1].operation == Operation::numbered
                           && is_of_clock(static_cast<int>(steps[i].number));
        if (!reads) continue;
        state.said_time = true;
        result.warnings.push_back(
            {Severity::warning,
             {.line = block.line, .column = steps[i].column},
             fmt::format("#{:.0f}: there is no clock here: it is noon of 1 January 2020, and "
                         "timers go on by a second a block",
                         steps[i].number)});
    }
}

void announce_offsets(const Offsets& before, const ModalState& modal, BlockResult& result) {
    if (before == modal.offsets) return;
    if (before.tool != modal.offsets.tool) {
        result.commands.emplace_back(UseToolLengthOffset{modal.length_number, modal.offsets.tool,
                                                         modal.offsets.follows_tip});
        result.columns.push_back(1);
    }
    if (before.work != modal.offsets.work) {
        result.commands.emplace_back(SetOffset{modal.offsets});
        result.columns.push_back(1);
    }
}

} // namespace gcode
