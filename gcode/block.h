#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "gcode/expression.h"

namespace gcode {

/// A letter and its value as written, in the units of the program.
struct Word {
    char letter = '\0'; // upper case; '@' and '^' of polar places, 'r' and 'c' of `,R` and `,C`
    double value = 0.0;
    core::SourceSpan span{};
    bool has_point = false;  // X5. rather than X5, or a computed value
    Expression expression{}; // gives the value when it is there

    bool operator==(const Word& other) const {
        return letter == other.letter && value == other.value && has_point == other.has_point;
    }
};

struct Comment {
    std::string_view text; // without its brackets or semicolon
    core::SourceSpan span;
};

/// `#5 = ...` or `#<name> = ...`
struct Assignment {
    Expression number; // of a numbered parameter
    uint32_t name = 0; // of a named one: index into the pool
    bool is_named = false;
    Expression value;
    double plain = 0.0; // the value when it is a plain number
    core::SourceSpan span{};
};

/// What a line does to the order in which blocks are run.
enum class FlowKind : uint8_t {
    none,
    // O words
    sub,
    end_sub,
    call,
    return_value,
    if_branch,
    else_if,
    otherwise,
    end_if,
    while_loop,
    end_while,
    do_loop,
    repeat,
    end_repeat,
    break_loop,
    continue_loop,
    program_number, // O1234 alone
    // Fanuc
    go_to,
    if_go_to,
    if_then,
    while_do,
    end_do,
};

/// The flow statement of a line. It stands alone on its line but for a block number and comments;
/// behind IF..THEN stand assignments.
struct Flow {
    FlowKind kind = FlowKind::none;
    core::SourceSpan span{};
    uint32_t label_name = 0; // index into the pool's names; a number as its digits
    bool has_label = false;
    Expression label;             // o#1 call, o[...] call
    Expression condition;         // of if, while, repeat; the target of GOTO; the value of return
    double plain_condition = 0.0; // when it is a plain number
    bool has_condition = false;
    std::vector<Expression> arguments{};
};

/// One line of an NC program after parsing. Views refer to the program's text.
struct Block {
    uint32_t line = 0;
    std::string_view text{};
    std::vector<Word> words{};
    std::vector<Comment> comments{};
    std::vector<Assignment> assignments{};
    Flow flow{};
    ExpressionPool pool{};
    std::optional<int> block_delete{}; // `/` is 1, `/1` to `/9` their number
    bool tape_mark = false;            // a line that begins with %

    bool has_message = false; // a comment that the control acts on

    /// Whether the line says anything that is run.
    bool is_empty() const {
        return words.empty() && assignments.empty() && flow.kind == FlowKind::none && !has_message;
    }
    void clear();
};

} // namespace gcode
