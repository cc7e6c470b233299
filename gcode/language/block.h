#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "gcode/language/expression.h"

namespace gcode {

/// Effect of a Siemens keyword.
enum class SiemensAction : uint8_t {
    note,    // understood; no effect on positions
    warning, // understood, but reported; no effect on positions
    refusal,
    // words with a value: CR=5
    address,
    noted_address,   // the value has no effect on positions
    refused_address, // not supported
    // motions and modes
    arc_by_point,  // CIP
    tangent_arc,   // CT
    machine_place, // SUPA
    diameters,     // DIAMON
    radii,         // DIAMOF
    transformation_off,
    transformation, // TRAORI
    // frames
    shift,
    add_shift,
    turn,
    add_turn,
    scale,
    add_scale,
    mirror,
    add_mirror,
    // calls in brackets
    message,
    swivel,     // CYCLE800
    drill,      // CYCLE81 to CYCLE89, CYCLE840
    hole_row,   // HOLES1
    hole_circle // HOLES2
};

/// A row of the table of keywords.
struct SiemensKeyword {
    std::string_view name;
    SiemensAction action;
    std::string_view text{}; // of a warning or refusal; the letter of an address

    constexpr bool operator<(const SiemensKeyword& other) const { return name < other.name; }
};

struct SiemensKeywordUse {
    const SiemensKeyword* keyword;
    core::SourceSpan span;
};

/// A value in brackets or after a keyword: an expression, a string or nothing.
struct SiemensArgument {
    enum class Kind : uint8_t { nothing, value, text };

    Kind kind = Kind::nothing;
    Expression expression{};
    double plain = 0.0;      // the value, if it is a plain number
    std::string_view text{}; // between the quotation marks
    core::SourceSpan span{};
};

/// Where a jump searches for its target.
enum class JumpWay : uint8_t { forward, backward, either, quietly, to_start };

/// `GOTOF END`, `IF R1 > 5 GOTOB N100`.
struct SiemensJump {
    SiemensArgument condition; // nothing: unconditional
    JumpWay way = JumpWay::either;
    std::string target; // in capitals
    core::SourceSpan span{};
};

enum class SiemensType : uint8_t { real, whole, truth, text };

/// A variable of DEF, or a parameter of PROC.
struct SiemensDeclaration {
    SiemensType type = SiemensType::real;
    std::string name; // lower case
    SiemensArgument initial;
    bool by_reference = false;
    core::SourceSpan span{};
};

/// What a Siemens block contains besides words and assignments.
struct SiemensBlock {
    std::string label{}; // `NAME:`, in capitals
    std::vector<SiemensKeywordUse> keywords{};
    std::vector<SiemensJump> jumps{};
    std::vector<SiemensDeclaration> declarations{}; // of DEF and PROC
    std::string name{};                             // of the program that is called or defined
    core::SourceSpan name_span{};
    std::vector<SiemensArgument> arguments{}; // of a call, a cycle, MSG; UNTIL and similar have one
    SiemensArgument repeats{};                // P of a call
    SiemensArgument tool_name{};              // T="..."
    bool is_modal_call = false;               // MCALL
    bool saves_modes = false;                 // SAVE of PROC

    void clear();
};

/// How an axis word is measured: by the modal distance mode, or by its own prefix, as in `IX5`.
enum class Addressing : uint8_t { modal, absolute, incremental };

/// A letter and its value as written, in the units of the program.
struct Word {
    char letter =
        '\0'; // upper case; '@' and '^' for polar coordinates, 'r' and 'c' for `,R` and `,C`
    double value = 0.0;
    core::SourceSpan span{};
    bool has_point = false; // X5. rather than X5; also set for computed values
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
    procedure,   // PROC
    declaration, // DEF
    give_back,   // RET
};

/// Whether a kind is a flow statement of native Siemens other than a jump.
constexpr bool is_siemens_statement(FlowKind kind) {
    return kind >= FlowKind::for_loop && kind <= FlowKind::give_back;
}

/// The flow statement of a line. It is alone on its line except for a block number and comments;
/// IF..THEN is followed by assignments.
struct Flow {
    FlowKind kind = FlowKind::none;
    core::SourceSpan span{};
    uint32_t label_name = 0; // index into the pool's names; a number is stored as its digits
    bool has_label = false;
    Expression label;             // o#1 call, o[...] call
    Expression condition;         // of if, while, repeat; the target of GOTO; the value of return
    double plain_condition = 0.0; // the condition, if it is a plain number
    bool has_condition = false;
    std::vector<Expression> arguments{};
};

/// The action of a line that is given by a keyword rather than a G code.
enum class CommandKind : uint8_t {
    none,
    straight,         // L
    straight_polar,   // LP
    pole,             // CC
    arc,              // C, around the pole
    arc_polar,        // CP
    arc_of_radius,    // CR
    tangent_arc,      // CT
    tangent_polar,    // CTP
    rounding,         // RND
    chamfer,          // CHF
    tool_call,        // TOOL CALL
    tool_definition,  // TOOL DEF
    cycle_definition, // CYCL DEF
    cycle_call,       // CYCL CALL, CYCL CALL POS
    read_system,      // FN 18
    program_error,    // FN 14
    note,             // read, but has no effect here
    modes,            // a line with M words only
    siemens,          // keywords, cycles, MCALL
};

/// A statement that begins with a keyword. Its values are stored as words of the block: a radius as
/// R, polar coordinates as P and H, others depending on the kind.
struct Command {
    CommandKind kind = CommandKind::none;
    core::SourceSpan span{};
    int number = 0, part = 0;     // CYCL DEF 7.1: 7 and 1
    int turn = 0;                 // DR+: 1, DR-: -1
    bool rapid = false;           // FMAX
    bool calls_cycle = false;     // M99, or CYCL CALL
    bool calls_from_here = false; // M89: after every motion
};

/// One line of an NC program after parsing. Views refer to the program's text.
struct Block {
    uint32_t line = 0;
    std::string_view text{};
    std::vector<Word> words{};
    std::vector<Comment> comments{};
    std::vector<Assignment> assignments{};
    Flow flow{};
    Command command{};
    ExpressionPool pool{};
    SiemensBlock siemens{};             // Siemens only
    std::optional<int> block_delete{};  // 1 for `/`, 1 to 9 for `/1` to `/9`
    bool tape_mark = false;             // a line that begins with %
    bool is_program_name = false;       // a line that begins with <NAME>
    std::optional<size_t> kept_words{}; // number of words before a `/` within the block

    bool has_message = false; // a comment that the control acts on

    /// Whether the line contains nothing to execute.
    bool is_empty() const {
        return words.empty() && assignments.empty() && flow.kind == FlowKind::none
               && command.kind == CommandKind::none && !has_message;
    }
    void clear();
};

} // namespace gcode
