#include "gcode/siemens_reader.h"

#include <fmt/format.h>

#include "gcode/expression_parser.h"
#include "gcode/siemens_names.h"

namespace gcode {

bool SiemensReader::accept_name(std::string_view name) {
    next();
    if (siemens_name_at(lexer) != name) return false;
    lexer.at += name.size();
    return true;
}

bool SiemensReader::is_at_equals() {
    if (next() != '=') return false;
    return lexer.at + 1 >= lexer.line.size() || lexer.line[lexer.at + 1] != '=';
}

core::Result<void> SiemensReader::expect(char wanted, std::string_view behind) {
    if (lexer.accept(wanted)) return {};
    return core::fail(core::ErrorCode::syntax,
                      fmt::format("a '{}' is missing behind '{}'", wanted, behind),
                      lexer.span(lexer.at, lexer.at + 1));
}

core::Result<SiemensArgument> SiemensReader::argument() {
    SiemensArgument result;
    const char c = next();
    const size_t begin = lexer.at;
    if (c == '"') {
        const size_t end = lexer.line.find('"', begin + 1);
        if (end == std::string_view::npos)
            return refuse(
                fmt::format("the text {} has no end: a '\"' is missing", lexer.line.substr(begin)),
                begin);
        lexer.at = end + 1;
        result.kind = SiemensArgument::Kind::text;
        result.text = lexer.line.substr(begin + 1, end - begin - 1);
    } else {
        Number plain;
        FEELER_TRY(result.expression, parse_sum(lexer, dialect.expressions, block.pool, plain));
        result.kind = SiemensArgument::Kind::value;
        result.plain = plain.value;
    }
    result.span = lexer.span_from(begin);
    return result;
}

core::Result<void> SiemensReader::arguments(std::vector<SiemensArgument>& values) {
    const size_t begin = lexer.at++;
    if (lexer.accept(')')) return {};
    while (true) {
        const char c = next();
        if (c == ',' || c == ')') {
            values.push_back({.span = lexer.span(lexer.at, lexer.at + 1)});
        } else {
            FEELER_TRY(const SiemensArgument value, argument());
            values.push_back(value);
        }
        // `"R1 is "<<R1`: the parts of a text.
        while (next() == '<' && lexer.line.substr(lexer.at).starts_with("<<")) {
            lexer.at += 2;
            FEELER_TRY(const SiemensArgument part, argument());
            values.push_back(part);
        }
        if (lexer.accept(')')) return {};
        if (!lexer.accept(','))
            return refuse(fmt::format("'{}' is not closed: a ',' or ')' is missing",
                                      lexer.line.substr(begin)),
                          begin);
    }
}

} // namespace gcode
