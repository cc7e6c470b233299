#include "gcode/iso/flow_parser.h"

#include <cmath>

#include <fmt/format.h>

#include "gcode/language/expression_parser.h"
#include "gcode/language/flow_index.h"

namespace gcode {
namespace {

using core::ErrorCode;

struct FlowKeyword {
    std::string_view spelling;
    FlowKind kind;
};

// Of two with the same beginning, the longer one comes first.
constexpr FlowKeyword o_keywords[] = {{"SUB", FlowKind::sub},
                                      {"ENDSUB", FlowKind::end_sub},
                                      {"CALL", FlowKind::call},
                                      {"RETURN", FlowKind::return_value},
                                      {"IF", FlowKind::if_branch},
                                      {"ELSEIF", FlowKind::else_if},
                                      {"ELSE", FlowKind::otherwise},
                                      {"ENDIF", FlowKind::end_if},
                                      {"WHILE", FlowKind::while_loop},
                                      {"ENDWHILE", FlowKind::end_while},
                                      {"DO", FlowKind::do_loop},
                                      {"REPEAT", FlowKind::repeat},
                                      {"ENDREPEAT", FlowKind::end_repeat},
                                      {"BREAK", FlowKind::break_loop},
                                      {"CONTINUE", FlowKind::continue_loop}};

class FlowParser {
public:
    FlowParser(Lexer& lexer, const Dialect& dialect, Block& block, bool only_head)
        : lexer_(lexer), dialect_(dialect), block_(block), only_head_(only_head) {}

    core::Result<bool> parse() {
        const char letter = upper(lexer_.peek());
        begin_ = lexer_.at;
        if (letter == 'O' && dialect_.has_o_words) return o_word();
        if (!dialect_.has_fanuc_flow) return false;
        if (letter == 'I' && lexer_.accept_word("IF")) return fanuc_if();
        if (letter == 'G' && lexer_.accept_word("GOTO")) return go_to(FlowKind::go_to);
        if (letter == 'W' && lexer_.accept_word("WHILE")) return fanuc_while();
        if (letter == 'D' && lexer_.accept_word("DO")) return loop_number(FlowKind::while_do);
        if (letter == 'E' && lexer_.accept_word("END")) return loop_number(FlowKind::end_do);
        return false;
    }

private:
    Flow& flow() { return block_.flow; }

    void set_label(std::string name) {
        flow().label_name = static_cast<uint32_t>(block_.pool.names.size());
        flow().has_label = true;
        block_.pool.names.push_back(std::move(name));
    }

    core::Result<bool> refuse(std::string message) {
        return core::fail(ErrorCode::syntax, std::move(message), lexer_.span_from(begin_));
    }

    core::Result<bool> finish(FlowKind kind) {
        flow().kind = kind;
        flow().span = lexer_.span_from(begin_);
        return true;
    }

    /// A bracketed condition, or a plain number where the grammar allows one.
    core::Result<void> condition() {
        FEELER_TRY(flow().condition, parse_bracketed(lexer_, dialect_.expressions, block_.pool));
        flow().has_condition = true;
        return {};
    }

    // --- O words ---

    core::Result<void> label() {
        ++lexer_.at; // the O
        const char next = lexer_.peek();
        if (next == '<') {
            FEELER_TRY(std::string name, parse_name(lexer_));
            set_label(std::move(name));
            return {};
        }
        Number plain;
        FEELER_TRY(flow().label, parse_value(lexer_, dialect_.expressions, block_.pool, plain));
        if (flow().label) return {};
        is_broken_ = plain.value != std::floor(plain.value);
        set_label(label_of(plain.value));
        return {};
    }

    core::Result<bool> o_word() {
        if (auto done = label(); !done) {
            lexer_.at = begin_ + 1;
            return core::fail(ErrorCode::syntax,
                              "'O' must be followed by a number or a name such as o<loop>, then a "
                              "keyword such as sub, call, if or while",
                              lexer_.span_from(begin_));
        }
        if (is_broken_)
            return refuse(fmt::format("'{}': the number of an O word must be whole",
                                      lexer_.line.substr(begin_, lexer_.at - begin_)));
        const std::string letters = lexer_.letters();
        for (const FlowKeyword& keyword : o_keywords) {
            const bool fits = only_head_ ? std::string_view(letters).starts_with(keyword.spelling)
                                         : letters == keyword.spelling;
            if (!fits) continue;
            if (only_head_) return finish(keyword.kind);
            lexer_.accept_word(keyword.spelling);
            return o_arguments(keyword.kind);
        }
        if (letters.empty() && lexer_.peek() != '#' && lexer_.peek() != '[')
            return finish(FlowKind::program_number);
        return refuse(fmt::format(
            "'{}' is not a keyword of an O word: these are sub, endsub, call, return, if, elseif, "
            "else, endif, while, endwhile, do, repeat, endrepeat, break and continue",
            letters));
    }

    core::Result<bool> o_arguments(FlowKind kind) {
        const bool asks = kind == FlowKind::if_branch || kind == FlowKind::else_if
                          || kind == FlowKind::while_loop || kind == FlowKind::repeat;
        const bool answers = kind == FlowKind::return_value || kind == FlowKind::end_sub;
        if (kind == FlowKind::call) {
            while (lexer_.peek() == '[' || lexer_.peek() == '(') {
                if (lexer_.peek() == '(') { // comments may stand between the arguments
                    FEELER_TRY(const Comment comment, lexer_.bracket_comment());
                    block_.comments.push_back(comment);
                    continue;
                }
                FEELER_TRY(const Expression argument,
                           parse_bracketed(lexer_, dialect_.expressions, block_.pool));
                flow().arguments.push_back(argument);
            }
            if (flow().arguments.size() > 30) return refuse("a call may have at most 30 arguments");
        } else if (asks || (answers && lexer_.peek() == '[')) {
            if (auto done = condition(); !done) return tl::unexpected(std::move(done).error());
        }
        const char rest = lexer_.peek();
        if (rest != '\0' && rest != '(' && rest != ';')
            return refuse("only a comment may follow the statement of an O word");
        return finish(kind);
    }

    // --- Fanuc ---

    core::Result<bool> go_to(FlowKind kind) {
        Number plain;
        if (lexer_.peek() == '\0') return refuse("GOTO must be followed by a block number");
        Expression target;
        FEELER_TRY(target, parse_value(lexer_, dialect_.expressions, block_.pool, plain));
        if (target)
            flow().label = target;
        else
            set_label(label_of(plain.value));
        return finish(kind);
    }

    core::Result<bool> fanuc_if() {
        if (auto done = condition(); !done) return tl::unexpected(std::move(done).error());
        if (lexer_.accept_word("GOTO")) return go_to(FlowKind::if_go_to);
        if (!lexer_.accept_word("THEN"))
            return refuse("the condition of IF must be followed by GOTO or THEN");
        if (lexer_.accept_word("GOTO")) return go_to(FlowKind::if_go_to);
        return finish(FlowKind::if_then);
    }

    core::Result<bool> fanuc_while() {
        if (auto done = condition(); !done) return tl::unexpected(std::move(done).error());
        if (!lexer_.accept_word("DO"))
            return refuse("the condition of WHILE must be followed by DO");
        return loop_number(FlowKind::while_do);
    }

    core::Result<bool> loop_number(FlowKind kind) {
        FEELER_TRY(const Number number, lexer_.number());
        if (number.value < 1.0 || number.value > 3.0 || number.value != std::floor(number.value))
            return refuse(
                "DO and END must be followed by 1, 2 or 3; the control stops with an alarm");
        set_label(label_of(number.value));
        return finish(kind);
    }

    Lexer& lexer_;
    const Dialect& dialect_;
    Block& block_;
    const bool only_head_;
    bool is_broken_ = false; // the label has a fraction
    size_t begin_ = 0;
};

} // namespace

core::Result<bool> parse_flow(Lexer& lexer, const Dialect& dialect, Block& block) {
    const char letter = upper(lexer.peek());
    if (std::string_view("OIGWDE").find(letter) == std::string_view::npos) return false;
    return FlowParser(lexer, dialect, block, false).parse();
}

core::Result<bool> parse_flow_head(Lexer& lexer, const Dialect& dialect, Block& block) {
    return FlowParser(lexer, dialect, block, true).parse();
}

} // namespace gcode
