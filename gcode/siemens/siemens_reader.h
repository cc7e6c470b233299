#pragma once

#include <string>

#include "gcode/language/dialect.h"
#include "gcode/language/lexer.h"
#include "gcode/siemens/siemens_line.h"

namespace gcode {

/// The name at this position in upper case, not consumed: letters, digits and `_`, for system
/// variables with a leading `$`.
std::string siemens_name_at(const Lexer& lexer);

/// The keyword with a name in upper case; null if there is none.
const SiemensKeyword* siemens_keyword(std::string_view name);

/// A block of native Siemens while it is parsed.
struct SiemensReader {
    Lexer lexer;
    const Dialect& dialect;
    Block& block;
    SiemensLine& siemens; // of the block

    /// The next significant character, not consumed; NUL at the end and before a comment.
    char next() {
        const char c = lexer.peek();
        return c == ';' ? '\0' : c;
    }

    /// Consumes this name if it comes next.
    bool accept_name(std::string_view name);

    /// Whether a single `=` comes next.
    bool is_at_equals();

    core::Result<void> expect(char wanted, std::string_view after);

    /// Reads an expression or a string.
    core::Result<SiemensArgument> argument();

    /// Reads `(...)`: values separated by commas, of which any may be left out.
    core::Result<void> arguments(std::vector<SiemensArgument>& values);

    tl::unexpected<core::Error> refuse(std::string message, size_t from,
                                       core::ErrorCode code = core::ErrorCode::syntax) const {
        return core::fail(code, std::move(message), lexer.span_from(from));
    }
};

/// Reads a statement that must have a block for itself, such as IF, FOR, DEF, PROC, GOTOF, if the
/// name starts one.
core::Result<bool> read_siemens_statement(SiemensReader& reader, const std::string& name,
                                          size_t begin);

/// Reads the rest of a program call after its name: its arguments and the number of repetitions.
core::Result<void> read_siemens_call(SiemensReader& reader, std::string name, size_t begin);

} // namespace gcode
