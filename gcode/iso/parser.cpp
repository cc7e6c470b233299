#include <algorithm>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "gcode/exec/execution.h"
#include "gcode/exec/program_parameters.h"
#include "gcode/iso/flow_parser.h"
#include "gcode/iso/iso.h"
#include "gcode/iso/plain_words.h"
#include "gcode/language/expression_parser.h"
#include "gcode/language/lexer.h"

namespace gcode {

/// A comment that the control acts on.
struct ActiveComment {
    std::string_view text; // after its keyword
    bool has_parameters;   // whether their values are inserted
};

/// (MSG, ...), (DEBUG, ...), (PRINT, ...) and (LOG, ...); empty for any other comment.
std::optional<ActiveComment> active_comment(std::string_view text);

namespace {

using core::ErrorCode;

constexpr std::string_view word_letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZ";

/// Two or more letters in a row are a keyword of some other control, so the message says so.
core::Error missing_number(const Lexer& lexer, size_t begin) {
    size_t end = begin;
    while (end < lexer.line.size() && is_letter(lexer.line[end])) ++end;
    if (end - begin > 1)
        return {ErrorCode::unsupported, lexer.span(begin, end),
                fmt::format("'{}' is not a word of this control's language: a letter must be "
                            "followed by a number",
                            lexer.line.substr(begin, end - begin))};
    return {ErrorCode::syntax, lexer.span(begin, begin + 1),
            fmt::format("'{}' must be followed by a number", lexer.line[begin])};
}

/// The position of the first character of a line that is too long; empty if none is. Blanks,
/// slashes and comments do not count.
///
/// Source: Grbl 1.1, protocol.c, protocol_main_loop; LINE_BUFFER_SIZE is 80, with the final NUL.
std::optional<size_t> first_surplus(std::string_view text, size_t longest) {
    size_t count = 0;
    bool in_comment = false;
    for (size_t at = 0; at < text.size() && (in_comment || text[at] != ';'); ++at) {
        const char c = text[at];
        if (in_comment) {
            in_comment = c != ')';
        } else if (c == '(') {
            in_comment = true;
        } else if (c != '/' && static_cast<unsigned char>(c) > ' ') {
            if (++count > longest) return at;
        }
    }
    return std::nullopt;
}

bool calls_macro(double code) { return code == 65.0 || code == 66.0 || code == 66.1; }

class LineParser {
public:
    LineParser(std::string_view text, uint32_t line, const Dialect& dialect, Block& block)
        : lexer_{.line = text, .line_number = line, .comments_nest = dialect.comments_nest},
          dialect_(dialect),
          block_(block) {}

    core::Result<void> parse() {
        while (!block_.tape_mark) {
            const char c = lexer_.peek();
            if (c == '\0') break;
            if (auto done = item(c); !done) return done;
        }
        if (auto checked = check_length(); !checked) return checked;
        return check_flow();
    }

private:
    core::Result<void> check_length() const {
        if (dialect_.longest_line == 0 || block_.tape_mark) return {};
        const auto at = first_surplus(lexer_.line, dialect_.longest_line);
        if (!at) return {};
        return core::fail(
            ErrorCode::syntax,
            fmt::format("'{}' is one character too many: Grbl takes {} besides blanks "
                        "and comments and does not run a longer line (error 11)",
                        lexer_.line.substr(*at, 1), dialect_.longest_line),
            lexer_.span(*at, *at + 1));
    }

    /// A jump or loop must be alone in its block, except for a block number; assignments follow
    /// THEN.
    core::Result<void> check_flow() const {
        const FlowKind kind = block_.flow.kind;
        if (!dialect_.has_fanuc_flow || kind == FlowKind::none || kind == FlowKind::if_then)
            return {};
        const auto numbers = [](const Word& word) { return word.letter == 'N'; };
        if (block_.assignments.empty()
            && std::all_of(block_.words.begin(), block_.words.end(), numbers))
            return {};
        return core::fail(ErrorCode::syntax,
                          "a jump or loop must be in a block by itself: move the other words to "
                          "the block before or after it",
                          block_.flow.span);
    }

    core::Result<void> item(char c) {
        if (c == '(') {
            FEELER_TRY(const Comment comment, lexer_.bracket_comment());
            block_.comments.push_back(comment);
            block_.has_message =
                dialect_.has_active_comments && active_comment(comment.text).has_value();
            return {};
        }
        if (c == ';') return end_of_block();
        if (c == '/') return block_delete();
        if (c == '%') return tape_mark();
        if (c == '#') return assignment();
        if (c == ',' && dialect_.has_corner_words) return corner_word();
        if ((c == '@' || c == '^') && dialect_.has_polar_words) return word(c, c);
        if (c == ':' && dialect_.has_fanuc_flow && block_.is_empty()) return word(c, 'O');
        if (c == '<' && dialect_.has_fanuc_flow && block_.is_empty()) return program_name();
        if (is_letter(c)) return lettered(upper(c));
        return stray(c);
    }

    /// `;` begins a comment. Where it ends the block, what follows it may be a block, which the
    /// control runs.
    core::Result<void> end_of_block() {
        block_.comments.push_back(lexer_.line_comment());
        if (!dialect_.semicolon_ends_block || block_.comments.back().text.empty()) return {};
        Dialect one_block = dialect_;
        one_block.semicolon_ends_block = false;
        Comment rest = block_.comments.back();
        while (true) {
            Block next;
            if (!LineParser(rest.text, lexer_.line_number, one_block, next).parse()) return {};
            if (!next.is_empty() || next.prints) break;
            if (next.comments.empty() || next.comments.back().text.empty()) return {};
            const Comment& last = next.comments.back();
            if (last.text.data() + last.text.size() != rest.text.data() + rest.text.size())
                return {};
            rest = last;
        }
        Lexer found{.line = lexer_.line,
                    .at = static_cast<size_t>(rest.text.data() - lexer_.line.data())};
        found.peek();
        return core::fail(
            ErrorCode::syntax,
            fmt::format("'{}': on this control ';' ends the block, so this is a block of its own: "
                        "put it on a line of its own, or write it as a comment in ( and )",
                        found.line.substr(found.at)),
            lexer_.span(found.at, lexer_.line.size()));
    }

    /// `/` comes first, or right after the N word; on some controls also before the words to be
    /// skipped. `/10` is not a block delete. Where there is none, a `/` is passed over.
    core::Result<void> block_delete() {
        const size_t begin = lexer_.at++;
        int number = 1;
        if (dialect_.block_delete == BlockDelete::none) {
            block_.block_delete = number;
            return {};
        }
        if (lexer_.at < lexer_.line.size() && lexer_.line[lexer_.at] >= '1'
            && lexer_.line[lexer_.at] <= '9')
            number = lexer_.line[lexer_.at++] - '0';
        const bool after_number = block_.words.size() == 1 && block_.words[0].letter == 'N';
        const bool in_place = block_.words.empty() || (after_number && block_.assignments.empty());
        const bool within = dialect_.deletes_within_blocks && block_.assignments.empty()
                            && block_.flow.kind == FlowKind::none;
        if (!in_place && within) {
            if (!block_.words_before_slash) block_.words_before_slash = block_.words.size();
            return {};
        }
        if (!in_place || block_.block_delete)
            return core::fail(ErrorCode::syntax, "'/' must be at the start of the block",
                              lexer_.span_from(begin));
        block_.block_delete = number;
        return {};
    }

    /// Text after a tape mark on its line is the name that some controls put there. Where the mark
    /// has no effect, a block number may be before it: the control does not run the line.
    core::Result<void> tape_mark() {
        const bool numbered = block_.words.size() == 1 && block_.words[0].letter == 'N';
        if (numbered && dialect_.runs_on_after_end) block_.words.clear();
        if (!block_.words.empty())
            return core::fail(ErrorCode::syntax, "'%' must be at the start of the line",
                              lexer_.span(lexer_.at, lexer_.at + 1));
        block_.tape_mark = true;
        return {};
    }

    /// `<NAME>` in place of an O number.
    core::Result<void> program_name() {
        const size_t end = lexer_.line.find('>', lexer_.at);
        if (end == std::string_view::npos) return lexer_.unexpected_character();
        lexer_.at = end + 1;
        block_.is_program_name = true;
        return {};
    }

    core::Result<void> assignment() {
        const size_t begin = lexer_.at++;
        if (!dialect_.has_parameters) return refuse_parameters(begin, 1);
        Assignment entry;
        if (lexer_.peek() == '<') {
            FEELER_TRY(std::string name, parse_name(lexer_));
            entry.is_named = true;
            entry.name = static_cast<uint32_t>(block_.pool.names.size());
            block_.pool.names.push_back(std::move(name));
        } else {
            FEELER_TRY(entry.number, value_as_expression());
        }
        if (!lexer_.accept('='))
            return core::fail(ErrorCode::syntax,
                              fmt::format("'{}' alone has no effect: set the parameter with '=', "
                                          "or use it as the value of a word",
                                          lexer_.written_from(begin)),
                              lexer_.span_from(begin));
        Number plain;
        FEELER_TRY(entry.value,
                   dialect_.brackets_optional_in_assignments
                       ? parse_sum(lexer_, dialect_.expressions, block_.pool, plain)
                       : parse_value(lexer_, dialect_.expressions, block_.pool, plain));
        entry.plain = plain.value;
        entry.span = lexer_.span_from(begin);
        block_.assignments.push_back(entry);
        return {};
    }

    tl::unexpected<core::Error> refuse_parameters(size_t begin, int error) const {
        return core::fail(
            ErrorCode::unsupported,
            fmt::format("'{}': Grbl has no parameters and no expressions, and does not "
                        "run this line (error {})",
                        lexer_.written_from(begin), error),
            lexer_.span_from(begin));
    }

    core::Result<Expression> value_as_expression() {
        Number plain;
        FEELER_TRY(const Expression found,
                   parse_value(lexer_, dialect_.expressions, block_.pool, plain));
        if (found) return found;
        const auto first = static_cast<uint32_t>(block_.pool.instructions.size());
        block_.pool.instructions.push_back(
            {Operation::number, static_cast<uint32_t>(lexer_.at), plain.value});
        return Expression{first, 1};
    }

    /// `,R5` and `,C2` between two moves.
    core::Result<void> corner_word() {
        const size_t begin = lexer_.at++;
        const char letter = upper(lexer_.peek());
        if (letter != 'R' && letter != 'C' && letter != 'A')
            return core::fail(ErrorCode::syntax, "',' must be followed by R, C or A",
                              lexer_.span_from(begin));
        return word(letter, static_cast<char>(lower(letter)), begin);
    }

    /// DPRNT, BPRNT, POPEN and PCLOS: output to a printer or file, without effect on the motion.
    /// Returns whether there was one.
    core::Result<bool> print_statement() {
        const size_t begin = lexer_.at;
        if (lexer_.accept_word("POPEN") || lexer_.accept_word("PCLOS")) return block_.prints = true;
        if (!lexer_.accept_word("DPRNT") && !lexer_.accept_word("BPRNT")) return false;
        int depth = 0;
        while (lexer_.peek() != '\0') {
            const char c = lexer_.line[lexer_.at++];
            depth += (c == '[') - (c == ']');
            if (c == ']' && depth == 0) return block_.prints = true;
            if (depth == 0) break;
        }
        return core::fail(ErrorCode::syntax,
                          fmt::format("'{}' needs a list in brackets, such as [X#100[53]]",
                                      lexer_.line.substr(begin, 5)),
                          lexer_.span_from(begin));
    }

    core::Result<void> lettered(char letter) {
        const size_t begin = lexer_.at;
        if (dialect_.has_fanuc_flow && (letter == 'P' || letter == 'D' || letter == 'B')) {
            FEELER_TRY(const bool prints, print_statement());
            if (prints) return {};
        }
        const bool has_flow = block_.flow.kind != FlowKind::none;
        FEELER_TRY(const bool flows, parse_flow(lexer_, dialect_, block_));
        if (flows && has_flow)
            return core::fail(
                ErrorCode::syntax,
                fmt::format("'{}' must be in a block by itself", lexer_.written_from(begin)),
                lexer_.span_from(begin));
        if (flows) return {};
        if (word_letters.find(letter) == std::string_view::npos)
            return core::fail(ErrorCode::syntax,
                              fmt::format("'{}' is not a word of this language; write an exponent "
                                          "such as 1E3 as a plain number",
                                          lexer_.line.substr(lexer_.at, 1)),
                              lexer_.span(lexer_.at, lexer_.at + 1));
        return word(letter, letter);
    }

    core::Result<void> word(char, char letter, std::optional<size_t> from = {}) {
        const size_t begin = from.value_or(lexer_.at);
        ++lexer_.at;
        const char next = lexer_.peek();
        const bool has_value =
            lexer_.is_at_number() || next == '#' || next == '[' || is_letter(next);
        if (!has_value) return tl::unexpected(missing_number(lexer_, begin));
        Word entry{.letter = letter};
        Number plain;
        auto value = parse_value(lexer_, dialect_.expressions, block_.pool, plain);
        if (!value) {
            const bool no_digits = lexer_.is_at_number() && value.error().where.length == 1
                                   && value.error().code == ErrorCode::syntax && next != '#';
            if (is_letter(next) || no_digits) return tl::unexpected(missing_number(lexer_, begin));
            return tl::unexpected(std::move(value).error());
        }
        entry.expression = *value;
        entry.value = plain.value;
        entry.has_point = plain.has_point;
        entry.span = lexer_.span_from(begin);
        if (entry.expression && !dialect_.has_parameters) return refuse_parameters(begin, 2);
        if (dialect_.refused_letters.find(letter) != std::string_view::npos)
            return core::fail(ErrorCode::unsupported,
                              fmt::format("{}: Grbl has no word {} and does not run this line "
                                          "(error 20)",
                                          lexer_.written_from(begin), letter),
                              entry.span);
        return add(entry);
    }

    core::Result<void> add(const Word& entry) {
        const bool is_offset = entry.letter == 'I' || entry.letter == 'J' || entry.letter == 'K';
        const bool repeatable = entry.letter == 'G' || entry.letter == 'M'
                                || (is_offset && dialect_.offset_words_may_repeat);
        const auto same = [&](const Word& word) { return word.letter == entry.letter; };
        const auto first = block_.words.begin() + static_cast<std::ptrdiff_t>(arguments_);
        if (!repeatable && std::any_of(first, block_.words.end(), same))
            return core::fail(
                ErrorCode::syntax,
                fmt::format("'{}': a block may have only one {} word; this is the second",
                            lexer_.line.substr(entry.span.column - 1, entry.span.length),
                            entry.letter),
                entry.span);
        block_.words.push_back(entry);
        if (entry.letter == 'G' && dialect_.has_fanuc_flow && calls_macro(entry.value))
            arguments_ = block_.words.size();
        return {};
    }

    core::Result<void> stray(char c) {
        if (lexer_.is_at_number()) {
            const size_t begin = lexer_.at;
            if (!lexer_.number()) ++lexer_.at;
            return core::fail(
                ErrorCode::syntax,
                fmt::format("'{}' has no letter before it", lexer_.written_from(begin)),
                lexer_.span_from(begin));
        }
        if (c == '@' || c == '^' || c == ',')
            return core::fail(
                ErrorCode::unsupported,
                fmt::format("'{}' is not allowed in the dialect {}", c, dialect_.name),
                lexer_.span(lexer_.at, lexer_.at + 1));
        return lexer_.unexpected_character();
    }

    Lexer lexer_;
    const Dialect& dialect_;
    Block& block_;
    size_t arguments_ = 0; // index of the first argument of a macro call
};

} // namespace

core::Result<void> parse_iso(std::string_view text, uint32_t line, const Dialect& dialect,
                             Block& block) {
    if (read_plain_words(text, line, dialect, block)) return {};
    block.words.clear();
    return LineParser(text, line, dialect, block).parse();
}

namespace {

/// The value of the parameter at this `#` as text: as written if it is not a parameter, ######
/// if it has no value.
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

/// The text of `(DEBUG, ...)` and `(PRINT, ...)`: values of parameters are inserted with six
/// decimals, until `%d` (none), `%f` (four) or `%.3f` sets another number of decimals.
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
