#include <fmt/format.h>

#include "app/check/check_run.h"
#include "app/debug/prompt/command_table.h"
#include "app/debug/prompt/location.h"
#include "app/debug/prompt/state_text.h"

namespace app {
namespace {

using core::ErrorCode;

std::string stop_and_location(PromptState& state, const Stop& stop) {
    return stop_text(state, stop) + location_text(state);
}

/// The answer to a search: `what` says what was not found, if nothing was.
std::string search_text(PromptState& state, const Stop& stop, const std::string& what) {
    if (stop.reason == StopReason::end || stop.reason == StopReason::error
        || stop.reason == StopReason::beginning)
        return fmt::format("no {} {}\n", what,
                           stop.reason == StopReason::beginning ? "before here" : "from here on")
               + location_text(state);
    return stop_and_location(state, stop);
}

CommandResult want_nothing(const std::string& arguments) {
    if (arguments.empty()) return std::string();
    return core::fail(
        ErrorCode::syntax,
        fmt::format("this command takes no arguments: '{}' is not allowed", arguments));
}

/// Goes to a position and describes it. On an error nothing changes.
CommandResult gone_to(PromptState& state, size_t position) {
    if (auto done = state.session.go_to(position); !done) return tl::unexpected(done.error());
    return location_text(state);
}

} // namespace

CommandResult run_program(PromptState& state, const std::string& arguments) {
    FEELER_TRY(std::string text, want_nothing(arguments));
    if (auto done = state.session.go_to(0); !done) return tl::unexpected(done.error());
    return text + stop_and_location(state, state.session.go_on());
}

CommandResult start_program(PromptState& state, const std::string& arguments) {
    FEELER_TRY(std::string text, want_nothing(arguments));
    return gone_to(state, text.size());
}

CommandResult step_on(PromptState& state, const std::string& arguments) {
    FEELER_TRY(const size_t count, count_in(arguments));
    return stop_and_location(state, state.session.step(count));
}

CommandResult step_over(PromptState& state, const std::string& arguments) {
    FEELER_TRY(const size_t count, count_in(arguments));
    return stop_and_location(state, state.session.next(count));
}

CommandResult step_back(PromptState& state, const std::string& arguments) {
    FEELER_TRY(const size_t count, count_in(arguments));
    return stop_and_location(state, state.session.step_back(count));
}

CommandResult step_back_over(PromptState& state, const std::string& arguments) {
    FEELER_TRY(const size_t count, count_in(arguments));
    return stop_and_location(state, state.session.next_back(count));
}

CommandResult finish_subprogram(PromptState& state, const std::string& arguments) {
    FEELER_TRY(std::string text, want_nothing(arguments));
    if (!has_block(state) || state.session.record().blocks[state.session.at()].calls.empty())
        return core::fail(ErrorCode::invalid_value,
                          "this is the main program: there is no subprogram to finish");
    return text + stop_and_location(state, state.session.finish());
}

CommandResult go_on(PromptState& state, const std::string& arguments) {
    FEELER_TRY(const size_t count, count_in(arguments));
    Stop stop = state.session.go_on();
    for (size_t i = 1; i < count && stop.reason == StopReason::breakpoint; ++i)
        stop = state.session.go_on();
    return stop_and_location(state, stop);
}

CommandResult reverse_resume(PromptState& state, const std::string& arguments) {
    FEELER_TRY(const size_t count, count_in(arguments));
    Stop stop = state.session.reverse_resume();
    for (size_t i = 1; i < count && stop.reason == StopReason::breakpoint; ++i)
        stop = state.session.reverse_resume();
    return stop_and_location(state, stop);
}

CommandResult go_until(PromptState& state, const std::string& arguments) {
    if (arguments.empty())
        return core::fail(ErrorCode::syntax, "until what? A line, N210, or a condition, as in "
                                             "until clearance < 1");
    std::string condition = arguments;
    if (is_location(arguments)) {
        FEELER_TRY(const Location location, location_in(state, arguments));
        condition = fmt::format("line = {} and file = \"{}\"", location.line, location.file);
    }
    FEELER_TRY(const Condition goal, Condition::read(condition));
    return search_text(state, state.session.until(goal), fmt::format("block with {}", arguments));
}

CommandResult go_to(PromptState& state, const std::string& arguments) {
    const auto [first, rest] = split_word(arguments);
    if (first == "start" || first == "beginning") return gone_to(state, 0);
    if (first == "end") {
        while (state.session.record_for(0.1))
            if (state.session.is_interrupted && state.session.is_interrupted()) break;
        size_t last = state.session.record().blocks.size();
        // The block at which an alarm stops is in the record, but cannot be run.
        while (last > 0 && !state.session.knows(last - 1)) --last;
        return gone_to(state, last);
    }
    if (first == "block") {
        FEELER_TRY(const size_t block, number_in(rest));
        FEELER_TRY([[maybe_unused]] const bool is_run, state.session.reaches(block));
        return gone_to(state, block);
    }
    if (first.empty())
        return core::fail(ErrorCode::syntax, "go where? block 17, line 120, N210, start or end");
    FEELER_TRY(const Location location, location_in(state, first == "line" ? rest : arguments));
    FEELER_TRY(const size_t position, position_of(state, location));
    return gone_to(state, position);
}

CommandResult go_to_finding(PromptState& state, const std::string& arguments) {
    FEELER_TRY(std::string text, want_nothing(arguments));
    return text + search_text(state, state.session.next_finding(), "problem");
}

CommandResult go_back_to_finding(PromptState& state, const std::string& arguments) {
    FEELER_TRY(std::string text, want_nothing(arguments));
    return text + search_text(state, state.session.previous_finding(), "problem");
}

CommandResult go_to_tool(PromptState& state, const std::string& arguments) {
    FEELER_TRY(std::string text, want_nothing(arguments));
    return text + search_text(state, state.session.next_tool(), "tool change");
}

CommandResult go_back_to_tool(PromptState& state, const std::string& arguments) {
    FEELER_TRY(std::string text, want_nothing(arguments));
    return text + search_text(state, state.session.previous_tool(), "tool change");
}

} // namespace app
