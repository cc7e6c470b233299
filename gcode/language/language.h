#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "core/base/result.h"
#include "gcode/language/expression.h"

namespace gcode {

class LanguageState;
enum class Language : uint8_t;
struct Block;
struct Dialect;
struct Environment;
struct Execution;
struct FlowIndex;
struct FlowStep;
struct InterpreterState;
struct ModalState;
struct Program;
struct Statement;

/// The functions that each language provides. Functions that may be null say so.
struct LanguageFunctions {
    /// Reads a line into an empty block. Errors: as parse_line.
    core::Result<void> (*parse)(std::string_view text, uint32_t line, const Dialect& dialect,
                                Block& block);

    /// Indexes the labels, block numbers and flow statements of a program.
    FlowIndex (*index)(const Program& program, const Dialect& dialect);

    /// Executes a block without a flow statement; `before` are the modes before the block.
    core::Result<void> (*execute)(Execution& execution, const ModalState& before);

    /// Executes a flow statement.
    core::Result<void> (*run_flow)(const FlowStep& step);

    /// Fast reader for lines of plain words, as read_plain_words; null: all lines are parsed.
    bool (*read_plain)(std::string_view text, uint32_t line, const Dialect& dialect,
                       Block& block) = nullptr;

    /// Makes the state that the language keeps between blocks; null: it has only the modes.
    std::shared_ptr<LanguageState> (*begin)(const Environment& environment) = nullptr;

    /// Whether a block without a flow statement may call or return; null: never.
    bool (*changes_level)(const Statement& statement, const InterpreterState& state) = nullptr;

    /// The value of a system variable; empty if the name is unknown. Null: the language has none.
    std::optional<Value> (*variable)(const InterpreterState& state,
                                     std::string_view name) = nullptr;

    // For languages with blocks of several lines; null: each line is a block.

    /// The text of the block that begins at a line.
    std::string_view (*block_at)(const Program& program, uint32_t line) = nullptr;
    /// The number of lines in the text of a block.
    uint32_t (*lines_of)(std::string_view block) = nullptr;
    /// Line and column in the file for a column of the block.
    core::SourceSpan (*position_in_file)(std::string_view block, core::SourceSpan where) = nullptr;
};

/// The functions of a language. gcode/languages holds the table.
const LanguageFunctions& functions_of(Language language);

/// Reads one line of a program.
///
/// Effect: overwrites `block`; its vectors keep their capacity.
/// Errors: syntax with line, column and the faulty text: a letter without a number, a second X
///         word, a comment without an end, a malformed expression.
core::Result<void> parse_line(std::string_view text, uint32_t line, const Dialect& dialect,
                              Block& block);

/// Indexes all lines of a program, or those before the first line that cannot be loaded. Lines that
/// cannot be parsed are left out; they become errors only if they are executed.
FlowIndex index_of(const Program& program, const Dialect& dialect);

} // namespace gcode
