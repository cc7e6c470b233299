#include "gcode/messages.h"

#include <fmt/format.h>

#include "gcode/execution.h"
#include "gcode/lexer.h"
#include "gcode/program_parameters.h"

namespace gcode {
namespace {

/// The parameter whose `#` stands here, written out; as it stands where there is none.
std::string parameter_text(Lexer& lexer, const ProgramParameters& parameters, int decimals) {
    const size_t begin = lexer.at++;
    core::Result<Value> value = Value{};
    if (lexer.peek() == '<') {
        const auto name = parse_name(lexer);
        if (!name) return lexer.written_from(begin);
        value = parameters.named(*name, {});
    } else {
        size_t end = lexer.at;
        while (end < lexer.line.size() && is_digit(lexer.line[end])) ++end;
        if (end == lexer.at || end - lexer.at > 6) return lexer.written_from(begin);
        const int number = std::stoi(std::string(lexer.line.substr(lexer.at, end - lexer.at)));
        lexer.at = end;
        value = parameters.numbered(number, {});
    }
    if (!value || !*value) return "######";
    return fmt::format("{:.{}f}", **value, decimals);
}

/// The text of `(DEBUG, ...)` and `(PRINT, ...)`: parameters are written out with six digits, until
/// `%d` (none), `%f` (four) or `%.3f` sets another number from there on.
std::string written_out(std::string_view text, const ProgramParameters& parameters) {
    std::string out;
    int decimals = 6;
    Lexer lexer{.line = text};
    while (lexer.at < text.size()) {
        const std::string_view rest = text.substr(lexer.at);
        if (rest.starts_with("%d")) {
            decimals = 0;
            lexer.at += 2;
        } else if (rest.starts_with("%f")) {
            decimals = 4;
            lexer.at += 2;
        } else if (rest.size() > 3 && rest.starts_with("%.") && is_digit(rest[2])
                   && rest[3] == 'f') {
            decimals = rest[2] - '0';
            lexer.at += 4;
        } else if (rest.front() == '#') {
            out += parameter_text(lexer, parameters, decimals);
        } else {
            out.push_back(rest.front());
            ++lexer.at;
        }
    }
    return out;
}

} // namespace

std::optional<ActiveComment> active_comment(std::string_view text) {
    struct Kind {
        std::string_view keyword;
        bool has_parameters;
    };
    constexpr Kind kinds[] = {{"MSG,", false}, {"DEBUG,", true}, {"PRINT,", true}, {"LOG,", true}};
    for (const Kind& kind : kinds) {
        Lexer lexer{.line = text};
        if (lexer.accept_word(kind.keyword))
            return ActiveComment{text.substr(lexer.at), kind.has_parameters};
    }
    return std::nullopt;
}

core::Result<void> say_message(Execution& execution) {
    if (!execution.dialect.has_active_comments || execution.block.comments.empty()) return {};
    const Comment& last = execution.block.comments.back();
    const auto comment = active_comment(last.text);
    if (!comment) return {};
    const ProgramParameters parameters(execution.state, execution.environment);
    execution.column = last.span.column;
    execution.emit(Message{comment->has_parameters ? written_out(comment->text, parameters)
                                                   : std::string(comment->text)});
    return {};
}

} // namespace gcode
