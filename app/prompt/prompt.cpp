#include "app/prompt/prompt.h"

#include <fmt/format.h>

#include "app/prompt/command_table.h"
#include "app/prompt/place_text.h"
#include "app/report/text_layout.h"

namespace app {
namespace {

/// The message, with the place in what was written if there is one.
std::string error_text(const core::Error& error) {
    std::string text = error.message;
    if (error.where.column > 0)
        text += fmt::format(" (column {} of the condition)", error.where.column);
    if (!error.file.empty()) text = error.file + ": " + text;
    return text + "\n";
}

} // namespace

std::string Prompt::greeting() {
    const CheckRun& record = state_.session.record();
    std::string text =
        fmt::format("{}: {} lines\n", record.program_file, state_.session.program().line_count());
    if (state_.session.setup_file().is_inferred)
        text += "the set-up is inferred from the program; 'info program' says how\n";
    return text + "'help' lists the commands; 'run', 'step' or 'next-finding' begin\n"
           + place_text(state_);
}

PromptAnswer Prompt::answer(std::string_view line) {
    std::string text = trimmed(line);
    if (text.empty()) text = state_.repeated;
    if (text.empty()) return {};
    const auto [name, arguments] = split_word(text);
    const auto command = command_named(name);
    if (!command) return {error_text(command.error()), true};
    auto result = (*command)->carry_out(state_, arguments);
    // What `list 20` goes on with is `list`.
    state_.repeated = !(*command)->repeats         ? std::string()
                      : (*command)->name == "list" ? std::string("list")
                                                   : text;
    if (!result) return {error_text(result.error()), true};
    return {*std::move(result), false, state_.ends};
}

PromptAnswer Prompt::answer_script(std::string_view line) {
    const std::string text = trimmed(line);
    if (text.empty() || text[0] == '#') return {};
    return answer(text);
}

} // namespace app
