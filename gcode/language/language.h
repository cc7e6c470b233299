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
struct Execution;
struct FlowIndex;
struct FlowStep;
struct InterpreterState;
struct ModalState;
struct Program;
struct Statement;

/// What the interpreter calls of a language. Each language fills in one such row; a function that
/// may be null says so.
struct LanguageFunctions {
    /// Reads a line into an empty block. Errors: as parse_line.
    core::Result<void> (*parse)(std::string_view text, uint32_t line, const Dialect& dialect,
                                Block& block);

    /// Finds the labels, block numbers and flow statements of a program.
    FlowIndex (*index)(const Program& program, const Dialect& dialect);

    /// Carries out a block without a flow statement; `before` are the modes before the block.
    core::Result<void> (*execute)(Execution& execution, const ModalState& before);

    /// Carries out a flow statement.
    core::Result<void> (*run_flow)(const FlowStep& step);

    /// Reads a line of plain words fast, as read_plain_words; null: all lines are parsed.
    bool (*read_plain)(std::string_view text, uint32_t line, const Dialect& dialect,
                       Block& block) = nullptr;

    /// What the language stores between blocks; null: nothing but the modes.
    std::shared_ptr<LanguageState> (*begin)() = nullptr;

    /// Whether a block without a flow statement may call or return; null: never.
    bool (*changes_level)(const Statement& statement, const InterpreterState& state) = nullptr;

    /// The value of a system variable, empty when the name is unknown; null: there are none.
    std::optional<Value> (*variable)(const InterpreterState& state,
                                     std::string_view name) = nullptr;

    // Languages whose blocks may have several lines; null: a line is a block.

    /// The text of the block that begins at a line.
    std::string_view (*block_at)(const Program& program, uint32_t line) = nullptr;
    /// How many lines the text of a block has.
    uint32_t (*lines_of)(std::string_view block) = nullptr;
    /// Line and column in the file of a column of the block.
    core::SourceSpan (*position_in_file)(std::string_view block, core::SourceSpan where) = nullptr;
};

/// The functions of a language. gcode/languages holds the table.
const LanguageFunctions& functions_of(Language language);

/// Reads one line of a program.
///
/// Effect: `block` is overwritten; its vectors keep their capacity.
/// Errors: syntax with line, column and the text at fault: a letter without a number, a second X
///         word, a comment without an end, a malformed expression.
core::Result<void> parse_line(std::string_view text, uint32_t line, const Dialect& dialect,
                              Block& block);

/// Indexes all lines of a program, or those before the first that cannot be loaded. Lines that
/// cannot be parsed are left out: they are errors only when they are run.
FlowIndex index_of(const Program& program, const Dialect& dialect);

} // namespace gcode
