#pragma once

#include <string>

#include "gcode/language/block.h"
#include "gcode/language/dialect.h"
#include "gcode/language/lexer.h"

namespace gcode {

/// The name that stands here, in capitals: letters, digits and `_`, before them a `$` of the
/// control's own variables. It stays to be read.
std::string siemens_name_at(const Lexer& lexer);

/// A block of native Siemens while it is read.
struct SiemensReader {
    Lexer lexer;
    const Dialect& dialect;
    Block& block;

    /// The next character that counts, which stays to be read; NUL at the end and before a comment.
    char next() {
        const char c = lexer.peek();
        return c == ';' ? '\0' : c;
    }

    /// Whether this name comes next, which is read then.
    bool accept_name(std::string_view name);

    /// Whether a single `=` comes next.
    bool is_at_equals();

    core::Result<void> expect(char wanted, std::string_view behind);

    /// Reads an expression or a text.
    core::Result<SiemensArgument> argument();

    /// Reads `(...)`: values between commas, of which any may be left out.
    core::Result<void> arguments(std::vector<SiemensArgument>& values);

    tl::unexpected<core::Error> refuse(std::string message, size_t from,
                                       core::ErrorCode code = core::ErrorCode::syntax) const {
        return core::fail(code, std::move(message), lexer.span_from(from));
    }
};

/// Whether a name begins a statement that has the block for itself: IF, FOR, DEF, PROC, GOTOF ...;
/// read then.
core::Result<bool> read_siemens_statement(SiemensReader& reader, const std::string& name,
                                          size_t begin);

/// Reads the call of a program by its name, which is read: its arguments and how often.
core::Result<void> read_siemens_call(SiemensReader& reader, std::string name, size_t begin);

} // namespace gcode
