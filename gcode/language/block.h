#pragma once

#include <any>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "gcode/language/expression.h"

namespace gcode {

/// How an axis word is measured: by the modal distance mode, or by its own prefix, as in `IX5`. The
/// last three are absolute, with the direction in which a rotary axis turns: DC, ACP and ACN of
/// Siemens.
enum class Addressing : uint8_t { modal, absolute, incremental, shortest, positive, negative };

constexpr bool is_absolute(Addressing addressing) {
    return addressing != Addressing::modal && addressing != Addressing::incremental;
}

/// A letter and its value as written, in the units of the program.
struct Word {
    char letter = '\0'; // upper case; '@' and '^' for polar coordinates, 'r' and 'c' for `,R` and
                        // `,C`, 'a' for `,A`, 'i' to 'k' for I1 to K1, 'l' to 'n' for the normal of
                        // a surface, 't' to 'v' for the direction of the tool, 'w' to 'y' for the
                        // angles of its direction
    double value = 0.0;
    core::SourceSpan span{};
    bool has_point = false;  // X5. rather than X5; also set for computed values
    bool is_unknown = false; // its value depends on one that only the machine knows
    Addressing addressing = Addressing::modal;
    Expression expression{}; // if present, overrides the value

    bool operator==(const Word& other) const {
        return letter == other.letter && value == other.value && has_point == other.has_point
               && addressing == other.addressing;
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
    double plain = 0.0; // the value, if it is a plain number
    core::SourceSpan span{};
};

/// Effect of a line on the order of execution.
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
    // Klartext
    label,
    call_label,
    call_program,
    end_program,
    if_go_to_label,
    // Siemens
    jumps,
    for_loop,
    end_for,
    endless_loop,
    end_endless,
    until,
    repeat_part,
    procedure,        // PROC
    declaration,      // DEF
    return_statement, // RET
};

/// Whether a kind is a flow statement of native Siemens other than a jump.
constexpr bool is_siemens_statement(FlowKind kind) {
    switch (kind) {
    case FlowKind::for_loop:
    case FlowKind::end_for:
    case FlowKind::endless_loop:
    case FlowKind::end_endless:
    case FlowKind::until:
    case FlowKind::repeat_part:
    case FlowKind::procedure:
    case FlowKind::declaration:
    case FlowKind::return_statement:
        return true;
    default:
        return false;
    }
}

/// The flow statement of a line. It is alone on its line except for a block number and comments;
/// IF..THEN is followed by assignments.
struct Flow {
    FlowKind kind = FlowKind::none;
    core::SourceSpan span{};
    uint32_t label_name = 0; // index into the pool's names; a number is stored as its digits
    bool has_label = false;
    Expression label;     // o#1 call, o[...] call
    Expression condition; // of if, while, repeat; the target of GOTO; the value of return
    bool has_condition = false;
    std::vector<Expression> arguments{};
};

/// The part of a line that only its language reads, such as a KlartextLine or a SiemensLine.
class LanguageLine {
public:
    /// An empty T if the language of T has not parsed this line.
    template <typename T>
    const T& as() const {
        static const T nothing{};
        const T* line = std::any_cast<T>(&line_);
        return line ? *line : nothing;
    }

    /// As the parser of that language writes it: kept between lines, for its capacity.
    template <typename T>
    T& write() {
        T* line = std::any_cast<T>(&line_);
        return line ? *line : line_.emplace<T>();
    }

private:
    std::any line_;
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
    LanguageLine language_line{};
    std::optional<int> block_delete{};          // the number after the `/`, or that it stands for
    bool tape_mark = false;                     // a line that begins with %
    bool is_program_name = false;               // a line that begins with <NAME>
    bool prints = false;                        // POPEN, PCLOS, DPRNT or BPRNT
    std::optional<size_t> words_before_slash{}; // number of words before a `/` within the block

    bool has_message = false; // a comment that the control acts on
    bool has_command = false; // a keyword that does something, in Klartext and Siemens

    /// Whether the line contains nothing to execute.
    bool is_empty() const {
        return words.empty() && assignments.empty() && flow.kind == FlowKind::none && !has_command
               && !has_message;
    }
    void clear();
};

} // namespace gcode
