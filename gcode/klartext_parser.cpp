#include "gcode/klartext_parser.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "gcode/axes.h"
#include "gcode/expression_parser.h"
#include "gcode/klartext_reader.h"
#include "gcode/program_text.h"

namespace gcode {
namespace {

using core::ErrorCode;

struct StatementKeyword {
    std::string_view spelling;
    CommandKind kind;
};

constexpr StatementKeyword motions[] = {
    {"L", CommandKind::straight},     {"LP", CommandKind::straight_polar},
    {"CC", CommandKind::pole},        {"C", CommandKind::arc},
    {"CP", CommandKind::arc_polar},   {"CR", CommandKind::arc_of_radius},
    {"CT", CommandKind::tangent_arc}, {"CTP", CommandKind::tangent_polar},
    {"RND", CommandKind::rounding},   {"CHF", CommandKind::chamfer}};

constexpr std::string_view refused[] = {"APPR",  "DEP",      "LN",   "SPL",    "FC",      "FCT",
                                        "FL",    "FLT",      "FPOL", "SEL",    "PATTERN", "TCH",
                                        "TRANS", "FUNCTION", "SQL",  "PRESET", "CONTOUR"};

core::Result<void> read_motion(KlartextReader& reader, CommandKind kind) {
    Command& command = reader.block.command;
    command.kind = kind;
    const bool takes_length = kind == CommandKind::chamfer;
    while (const char c = reader.next()) {
        if (takes_length && reader.lexer.is_at_number()) {
            if (auto done = reader.word('R', reader.lexer.at); !done) return done;
            continue;
        }
        if (!is_letter(c)) return reader.stray();
        if (auto done = read_contour_word(reader); !done) return done;
    }
    command.span = reader.span_from(reader.begin);
    return {};
}

/// `BEGIN PGM name MM`: the unit is the last word.
core::Result<void> read_begin(KlartextReader& reader) {
    std::string_view rest = reader.lexer.line.substr(reader.lexer.at);
    reader.lexer.at = reader.lexer.line.size();
    while (!rest.empty() && (is_blank(rest.back()) || is_line_end(rest.back())))
        rest.remove_suffix(1);
    const size_t blank = rest.find_last_of(" \t");
    const std::string_view unit =
        blank == std::string_view::npos ? std::string_view() : rest.substr(blank + 1);
    if (unit != "MM" && unit != "INCH" && unit != "mm" && unit != "inch")
        return reader.refuse("'BEGIN PGM' needs the name of the program and MM or INCH behind it",
                             reader.begin);
    reader.add_word('G', unit == "MM" || unit == "mm" ? 21.0 : 20.0, reader.begin);
    reader.block.command.kind = CommandKind::modes;
    return {};
}

/// Tilted planes: what switches them off is read, what tilts is refused.
core::Result<void> read_plane(KlartextReader& reader) {
    if (!reader.accept("RESET"))
        return reader.refuse("PLANE: tilted planes are not supported yet", reader.begin,
                             ErrorCode::unsupported);
    reader.lexer.at = reader.lexer.line.size();
    reader.block.command.kind = CommandKind::note;
    return {};
}

core::Result<void> read_modes(KlartextReader& reader, CommandKind kind) {
    reader.block.command.kind = kind;
    while (const char c = reader.next()) {
        if (!is_letter(c)) return reader.stray();
        if (auto done = read_contour_word(reader); !done) return done;
    }
    return {};
}

core::Result<void> read_keyword(KlartextReader& reader, const std::string& first) {
    reader.accept(first);
    reader.block.command.span = reader.span_from(reader.begin);
    if (first == "BEGIN" && reader.accept("PGM")) return read_begin(reader);
    if (first == "END" && reader.accept("PGM")) {
        reader.lexer.at = reader.lexer.line.size();
        reader.block.flow.kind = FlowKind::end_program;
        reader.block.flow.span = reader.span_from(reader.begin);
        return {};
    }
    if (first == "BLK" && reader.accept("FORM")) { // the stock is the set-up's
        reader.lexer.at = reader.lexer.line.size();
        return {};
    }
    if (first == "STOP") {
        reader.add_word('M', 0.0, reader.begin);
        return read_modes(reader, CommandKind::modes);
    }
    if (first == "TOOL") return read_tool(reader);
    if (first == "CYCL" || first == "CYCLE") return read_cycle(reader);
    if (first == "CALL") return read_call(reader);
    if (first == "PLANE") return read_plane(reader);
    for (const StatementKeyword& keyword : motions)
        if (first == keyword.spelling) return read_motion(reader, keyword.kind);
    const bool known =
        std::find(std::begin(refused), std::end(refused), first) != std::end(refused);
    return reader.refuse(known ? fmt::format("'{}' is not supported yet", first)
                               : fmt::format("'{}' begins no statement of Klartext", first),
                         reader.begin, known ? ErrorCode::unsupported : ErrorCode::syntax);
}

/// Statements whose keyword may run into a number: `LBL1`, `FN18:`, `Q5`, `M3`, `X+10`.
core::Result<void> read_statement(KlartextReader& reader) {
    const std::string first = reader.letters();
    if (first == "LBL") return read_label(reader);
    if (first == "FN") return read_function(reader);
    if (first == "Q" || first == "QR" || first == "QL" || first == "QS")
        return read_assignment(reader);
    if (first == "M") return read_modes(reader, CommandKind::modes);
    const bool axis = axis_letters.find(first[0]) != std::string_view::npos;
    const bool incremental = first.size() == 2 && first[0] == 'I'
                             && axis_letters.find(first[1]) != std::string_view::npos;
    const bool is_c = first == "C"; // an arc, not the axis
    if ((first.size() == 1 && axis && !is_c) || incremental)
        return read_motion(reader, CommandKind::straight);
    return read_keyword(reader, first);
}

/// The block number, the comment and the `/` that may stand before a statement.
core::Result<void> read_block(KlartextReader& reader) {
    Lexer& lexer = reader.lexer;
    if (lexer.accept('/')) reader.block.block_delete = 1;
    lexer.peek();
    const size_t digits = lexer.at;
    while (lexer.at < lexer.line.size() && is_digit(lexer.line[lexer.at])) ++lexer.at;
    const size_t behind = lexer.at;
    if (lexer.accept('/')) reader.block.block_delete = 1;
    const char c = lexer.peek();
    if (c == '*' || c == ';') {
        reader.block.comments.push_back(lexer.line_comment());
        return {};
    }
    if (reader.next() == '\0') return {};
    reader.begin = lexer.at;
    if (!is_letter(reader.next()) || (behind > digits && lexer.at == behind && c != '/')) {
        if (!is_letter(reader.next())) return reader.stray();
        return reader.refuse(fmt::format("'{}' is no block number: a blank belongs behind it",
                                         lexer.line.substr(digits, behind + 1 - digits)),
                             digits);
    }
    if (auto done = read_statement(reader); !done) return done;
    return reader.next() == '\0' ? core::Result<void>{} : core::Result<void>(reader.stray());
}

/// The part of a line that decides whether the next one belongs to it.
bool goes_on(std::string_view line) {
    while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
    return line.ends_with('~');
}

} // namespace

core::Result<void> parse_klartext(std::string_view text, uint32_t line, const Dialect& dialect,
                                  Block& block) {
    KlartextReader reader{.lexer = {.line = text,
                                    .line_number = line,
                                    .blanks_end_numbers = true,
                                    .comma_is_point = true},
                          .dialect = dialect,
                          .block = block};
    return read_block(reader);
}

std::string_view klartext_block(const Program& program, uint32_t line) {
    size_t last = line;
    while (last < program.line_count() && goes_on(program.line(last))) ++last;
    const size_t begin = program.line_starts[line - 1];
    const size_t end = program.line_starts[last - 1] + program.line(last).size();
    return std::string_view(program.text).substr(begin, end - begin);
}

uint32_t lines_of(std::string_view text) {
    uint32_t count = 1;
    for (size_t at = 0; at < text.size(); ++at)
        count += text[at] == '\n' || (text[at] == '\r' && !text.substr(at + 1).starts_with('\n'));
    return count;
}

core::SourceSpan place_in_lines(std::string_view text, core::SourceSpan where) {
    if (where.column == 0) return where;
    const size_t at = std::min<size_t>(where.column - 1, text.size());
    const std::string_view before = text.substr(0, at);
    const size_t line_end = before.find_last_of("\r\n");
    if (line_end == std::string_view::npos) return where;
    where.line += lines_of(before) - 1;
    where.column = static_cast<uint32_t>(at - line_end);
    return where;
}

FlowIndex klartext_index(const Program& program, const Dialect& dialect) {
    FlowIndex index;
    Block block;
    for (uint32_t line = 1; line <= program.line_count();) {
        const std::string_view text = klartext_block(program, line);
        const size_t keyword = text.find_first_not_of("0123456789 \t/");
        if (keyword != std::string_view::npos && upper(text[keyword]) == 'L'
            && upper(text.substr(keyword).size() > 1 ? text[keyword + 1] : ' ') == 'B') {
            block.clear();
            if (parse_klartext(text, line, dialect, block) && block.flow.kind == FlowKind::label)
                index.marks.push_back({.kind = FlowKind::label,
                                       .name = block.pool.names[block.flow.label_name],
                                       .line = line});
        }
        line += lines_of(text);
    }
    return index;
}

} // namespace gcode
