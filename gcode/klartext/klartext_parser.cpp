#include "gcode/klartext/klartext_parser.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "gcode/klartext/klartext_reader.h"
#include "gcode/language/expression_parser.h"
#include "gcode/language/flow_index.h"
#include "gcode/language/modal_state.h"
#include "gcode/text/program_text.h"
#include "gcode/text/source.h"

namespace gcode {
namespace {

using core::ErrorCode;

struct StatementKeyword {
    std::string_view spelling;
    CommandKind kind;
};

constexpr StatementKeyword motions[] = {{"L", CommandKind::straight},
                                        {"LN", CommandKind::straight},
                                        {"LP", CommandKind::straight_polar},
                                        {"CC", CommandKind::pole},
                                        {"C", CommandKind::arc},
                                        {"CP", CommandKind::arc_polar},
                                        {"CR", CommandKind::arc_of_radius},
                                        {"CT", CommandKind::tangent_arc},
                                        {"CTP", CommandKind::tangent_polar},
                                        {"RND", CommandKind::rounding},
                                        {"CHF", CommandKind::chamfer}};

constexpr std::string_view refused[] = {"APPR", "DEP",   "SPL",  "FC",     "FCT",
                                        "FL",   "FLT",   "FPOL", "SEL",    "PATTERN",
                                        "TCH",  "TRANS", "SQL",  "PRESET", "CONTOUR"};

/// Consumes a name with digits, such as P1X.
bool accept_name(KlartextReader& reader, std::string_view name) {
    reader.next();
    const std::string_view rest = reader.lexer.line.substr(reader.lexer.at);
    const bool is_next = !name.empty() && rest.size() >= name.size()
                         && std::equal(name.begin(), name.end(), rest.begin(),
                                       [](char a, char b) { return a == upper(b); });
    const char after = is_next && rest.size() > name.size() ? upper(rest[name.size()]) : ' ';
    if (!is_next || (is_letter(after) && after != 'Q')) return false; // COORD after C
    reader.lexer.at += name.size();
    return true;
}

/// The words of LN: the normal of the surface as l, m and n, the direction of the tool as t, u and
/// v.
core::Result<bool> read_vector(KlartextReader& reader) {
    constexpr std::string_view names[] = {"NX", "NY", "NZ", "TX", "TY", "TZ"};
    const size_t from = reader.lexer.at;
    for (size_t i = 0; i < std::size(names); ++i)
        if (accept_name(reader, names[i])) {
            if (auto done = reader.word("lmntuv"[i], from); !done)
                return tl::unexpected(std::move(done).error());
            return true;
        }
    return false;
}

core::Result<void> read_motion(KlartextReader& reader, CommandKind kind) {
    KlartextLine& command = reader.command;
    command.kind = kind;
    const bool takes_length = kind == CommandKind::chamfer;
    while (const char c = reader.next()) {
        if (takes_length && reader.lexer.is_at_number()) {
            if (auto done = reader.word('R', reader.lexer.at); !done) return done;
            continue;
        }
        if (!is_letter(c)) return reader.stray();
        if (command.has_normal) {
            FEELER_TRY(const bool is_vector, read_vector(reader));
            if (is_vector) continue;
        }
        if (auto done = read_contour_word(reader); !done) return done;
    }
    command.span = reader.span_from(reader.begin);
    return {};
}

/// `BEGIN PGM name MM`: the unit is the last word.
core::Result<void> read_begin(KlartextReader& reader) {
    if (!reader.accept("PGM"))
        return reader.refuse("'BEGIN' must be followed by PGM", reader.begin);
    std::string_view rest = reader.lexer.line.substr(reader.lexer.at);
    reader.lexer.at = reader.lexer.line.size();
    while (!rest.empty() && (is_blank(rest.back()) || is_line_end(rest.back())))
        rest.remove_suffix(1);
    const size_t blank = rest.find_last_of(" \t");
    const std::string_view unit =
        blank == std::string_view::npos ? std::string_view() : rest.substr(blank + 1);
    if (unit != "MM" && unit != "INCH" && unit != "mm" && unit != "inch")
        return reader.refuse("'BEGIN PGM' must be followed by the program name and MM or INCH",
                             reader.begin);
    reader.add_word('G', unit == "MM" || unit == "mm" ? 21.0 : 20.0, reader.begin);
    reader.command.kind = CommandKind::modes;
    return {};
}

/// A form of PLANE and its values, which are stored as the words I J K, L N O, P Q R.
struct PlaneWords {
    std::string_view spelling;
    PlaneForm form;
    std::array<std::string_view, 9> values;
};

constexpr PlaneWords plane_forms[] = {
    {"RESET", PlaneForm::reset, {}},
    {"SPATIAL", PlaneForm::spatial, {"SPA", "SPB", "SPC"}},
    {"EULER", PlaneForm::euler, {"EULPR", "EULNU", "EULROT"}},
    {"VECTOR", PlaneForm::vector, {"BX", "BY", "BZ", "NX", "NY", "NZ"}},
    {"POINTS", PlaneForm::points, {"P1X", "P1Y", "P1Z", "P2X", "P2Y", "P2Z", "P3X", "P3Y", "P3Z"}},
    {"RELATIV", PlaneForm::relative, {"SPA", "SPB", "SPC"}},
    {"RELATIVE", PlaneForm::relative, {"SPA", "SPB", "SPC"}},
    {"AXIAL", PlaneForm::axial, {"A", "B", "C"}}};

/// SEQ+, SEQ-, and SYM, which is the same.
core::Result<void> read_solution(KlartextReader& reader) {
    const char sign = reader.next();
    if (sign != '+' && sign != '-') return reader.stray();
    ++reader.lexer.at;
    reader.command.solution = sign == '+' ? 1 : -1;
    return {};
}

/// MB MAX, or MB and a length.
core::Result<void> read_retraction(KlartextReader& reader, size_t from) {
    reader.command.retracts = true;
    if (reader.accept("MAX")) return {};
    return reader.word('H', from);
}

/// What follows the values of PLANE.
core::Result<void> read_plane_option(KlartextReader& reader) {
    KlartextLine& command = reader.command;
    const size_t from = reader.lexer.at;
    if (reader.accept("STAY")) return {};
    if (reader.accept("MOVE") || reader.accept("TURN")) {
        command.plane_move =
            upper(reader.lexer.line[from]) == 'M' ? PlaneMove::move : PlaneMove::turn;
        return {};
    }
    if (reader.accept("COORD")) return reader.accept("ROT") ? core::Result<void>{} : reader.stray();
    if (reader.accept("TABLE")) {
        command.turns_table = true;
        return reader.accept("ROT") ? core::Result<void>{} : reader.stray();
    }
    if (reader.accept("SEQ") || reader.accept("SYM")) return read_solution(reader);
    if (reader.accept("DIST")) return reader.word('D', from);
    if (reader.accept("MB")) return read_retraction(reader, from);
    return upper(reader.next()) == 'F' ? read_contour_word(reader) : reader.stray();
}

/// `PLANE SPATIAL SPA+0 SPB+45 SPC+0 MOVE DIST50 F1000 SEQ-`.
core::Result<void> read_plane(KlartextReader& reader) {
    const auto form =
        std::find_if(std::begin(plane_forms), std::end(plane_forms),
                     [&](const PlaneWords& each) { return reader.accept(each.spelling); });
    if (form == std::end(plane_forms))
        return reader.refuse(reader.letters() == "PROJECTED"
                                 ? "PLANE PROJECTED is not supported yet: use PLANE SPATIAL"
                                 : "'PLANE' must be followed by RESET, SPATIAL, EULER, VECTOR, "
                                   "POINTS, RELATIV or AXIAL",
                             reader.begin, ErrorCode::unsupported);
    reader.command.kind = CommandKind::plane;
    reader.command.plane = form->form;
    while (const char c = reader.next()) {
        if (!is_letter(c)) return reader.stray();
        const size_t from = reader.lexer.at;
        const auto value =
            std::find_if(form->values.begin(), form->values.end(),
                         [&](std::string_view name) { return accept_name(reader, name); });
        const auto number = static_cast<size_t>(value - form->values.begin());
        auto done = value == form->values.end() ? read_plane_option(reader)
                                                : reader.word("IJKLNOPQR"[number], from);
        if (!done) return done;
    }
    reader.command.span = reader.span_from(reader.begin);
    return {};
}

/// PATHCTRL AXIS or VECTOR; the first has been read.
bool read_path_control(KlartextReader& reader) {
    reader.command.turns_in_plane = reader.accept("VECTOR");
    return reader.command.turns_in_plane || reader.accept("AXIS");
}

/// AXIS POS or SPAT; the first has been read.
bool read_axis_meaning(KlartextReader& reader) {
    reader.command.by_space_angles = reader.accept("SPAT");
    return reader.command.by_space_angles || reader.accept("POS");
}

/// REFPNT TIP-TIP, which is the default; the first has been read. The other points are the centre
/// of the radius of the tool.
bool read_reference_points(KlartextReader& reader) {
    return reader.accept("TIP") && reader.lexer.accept('-') && reader.accept("TIP");
}

/// The words after FUNCTION TCPM. False if they select what is not modelled: another point than the
/// tip.
bool reads_as_tip_control(KlartextReader& reader) {
    bool is_same = true;
    while (reader.next() != '\0') {
        const bool is_known = reader.accept("F") ? reader.accept("TCP") || reader.accept("CONT")
                              : reader.accept("AXIS") ? read_axis_meaning(reader)
                              : reader.accept("REFPNT")
                                  ? read_reference_points(reader)
                                  : reader.accept("PATHCTRL") && read_path_control(reader);
        if (is_known) continue;
        is_same = false;
        reader.lexer.at += std::max<size_t>(reader.letters().size(), 1);
    }
    return is_same;
}

/// `FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS` and `FUNCTION RESET TCPM`, read as M128 and M129.
core::Result<void> read_function_mode(KlartextReader& reader) {
    const bool resets = reader.accept("RESET");
    if (!reader.accept("TCPM"))
        return reader.refuse("'FUNCTION' is only supported with TCPM and RESET TCPM", reader.begin,
                             ErrorCode::unsupported);
    reader.add_word('M', resets ? 129.0 : 128.0, reader.begin);
    reader.command.turns_otherwise = !reads_as_tip_control(reader);
    reader.lexer.at = reader.lexer.line.size();
    reader.command.kind = CommandKind::modes;
    return {};
}

core::Result<void> read_modes(KlartextReader& reader, CommandKind kind) {
    reader.command.kind = kind;
    while (const char c = reader.next()) {
        if (!is_letter(c)) return reader.stray();
        if (auto done = read_contour_word(reader); !done) return done;
    }
    for (const Word& word : reader.block.words)
        if (axis_letters.find(word.letter) != std::string_view::npos)
            return core::fail(
                ErrorCode::syntax,
                fmt::format("'{}' is not allowed in this block: a move begins with L", word.letter),
                word.span);
    return {};
}

core::Result<void> read_end(KlartextReader& reader) {
    if (!reader.accept("PGM")) return reader.refuse("'END' must be followed by PGM", reader.begin);
    reader.lexer.at = reader.lexer.line.size();
    reader.block.flow.kind = FlowKind::end_program;
    reader.block.flow.span = reader.span_from(reader.begin);
    return {};
}

/// `BLK FORM`: the stock comes from the set-up.
core::Result<void> read_blank_form(KlartextReader& reader) {
    if (!reader.accept("FORM"))
        return reader.refuse("'BLK' must be followed by FORM", reader.begin);
    reader.lexer.at = reader.lexer.line.size();
    return {};
}

core::Result<void> read_stop(KlartextReader& reader) {
    reader.add_word('M', 0.0, reader.begin);
    return read_modes(reader, CommandKind::modes);
}

/// A word that begins a statement other than a motion, and the function that reads what follows.
struct OpeningWord {
    std::string_view spelling;
    core::Result<void> (*read)(KlartextReader&);
};

constexpr OpeningWord opening_words[] = {
    {"BEGIN", read_begin},    {"END", read_end},
    {"BLK", read_blank_form}, {"STOP", read_stop},
    {"TOOL", read_tool},      {"CYCL", read_cycle},
    {"CYCLE", read_cycle},    {"CALL", read_call},
    {"PLANE", read_plane},    {"FUNCTION", read_function_mode}};

core::Result<void> read_keyword(KlartextReader& reader, const std::string& first) {
    reader.accept(first);
    reader.command.span = reader.span_from(reader.begin);
    for (const OpeningWord& word : opening_words)
        if (first == word.spelling) return word.read(reader);
    for (const StatementKeyword& keyword : motions)
        if (first == keyword.spelling) {
            reader.command.has_normal = first == "LN";
            return read_motion(reader, keyword.kind);
        }
    const bool known =
        std::find(std::begin(refused), std::end(refused), first) != std::end(refused);
    return reader.refuse(known ? fmt::format("'{}' is not supported yet", first)
                               : fmt::format("'{}' does not start a Klartext statement", first),
                         reader.begin, known ? ErrorCode::unsupported : ErrorCode::syntax);
}

/// Statements whose keyword may be joined to a number: `LBL1`, `FN18:`, `Q5`, `M3`, `X+10`.
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

/// Reads a block: its number, comment and `/` before the statement, then the statement.
core::Result<void> read_block(KlartextReader& reader) {
    Lexer& lexer = reader.lexer;
    if (lexer.accept('/')) reader.block.block_delete = 1;
    lexer.peek();
    const size_t digits = lexer.at;
    while (lexer.at < lexer.line.size() && is_digit(lexer.line[lexer.at])) ++lexer.at;
    const size_t after = lexer.at;
    if (lexer.accept('/')) reader.block.block_delete = 1;
    const char c = lexer.peek();
    if (c == '*' || c == ';') {
        reader.block.comments.push_back(lexer.line_comment());
        return {};
    }
    if (reader.next() == '\0') return {};
    reader.begin = lexer.at;
    if (!is_letter(reader.next()) || (after > digits && lexer.at == after && c != '/')) {
        if (!is_letter(reader.next())) return reader.stray();
        return reader.refuse(
            fmt::format("'{}' is not a block number: a block number must be followed by a space",
                        lexer.line.substr(digits, after + 1 - digits)),
            digits);
    }
    if (auto done = read_statement(reader); !done) return done;
    return reader.next() == '\0' ? core::Result<void>{} : core::Result<void>(reader.stray());
}

/// Whether a line ends with `~`, so that the next line belongs to the same block.
bool goes_on(std::string_view line) {
    while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
    return line.ends_with('~');
}

} // namespace

core::Result<void> parse_klartext(std::string_view text, uint32_t line, const Dialect& dialect,
                                  Block& block) {
    KlartextLine& command = block.language_line.write<KlartextLine>();
    command = {};
    KlartextReader reader{.lexer = {.line = text,
                                    .line_number = line,
                                    .blanks_end_numbers = true,
                                    .comma_is_point = true},
                          .dialect = dialect,
                          .block = block,
                          .command = command};
    auto read = read_block(reader);
    block.has_command = command.kind != CommandKind::none;
    return read;
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

core::SourceSpan position_in_lines(std::string_view text, core::SourceSpan where) {
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

namespace {

constexpr int first_new_cycle = 200; // cycles from here on have Q parameters
constexpr int feed_of_plunge = 206;

constexpr int cycles[] = {1,   7,   8,   9,   10,  11,  13,  19,  32,  200, 201,
                          202, 203, 205, 206, 207, 208, 209, 220, 221, 240, 247};

void set_label(KlartextReader& reader, std::string name) {
    Flow& flow = reader.block.flow;
    flow.label_name = static_cast<uint32_t>(reader.block.pool.names.size());
    flow.has_label = true;
    reader.block.pool.names.push_back(std::move(name));
}

} // namespace

std::vector<std::string> klartext_words() {
    std::vector<std::string> words;
    for (const OpeningWord& word : opening_words) words.emplace_back(word.spelling);
    for (const StatementKeyword& keyword : motions) words.emplace_back(keyword.spelling);
    for (const std::string_view word : refused) words.emplace_back(word);
    for (const int cycle : cycles) words.push_back(fmt::format("CYCL DEF {}", cycle));
    return words;
}

/// A number, or a name with its quotation marks.
core::Result<void> read_label_name(KlartextReader& reader) {
    Lexer& lexer = reader.lexer;
    const char c = reader.next();
    const size_t from = lexer.at;
    if (is_digit(c)) {
        FEELER_TRY(const Number number, lexer.number());
        set_label(reader, label_of(number.value));
        return {};
    }
    if (upper(c) == 'Q') {
        FEELER_TRY(reader.block.flow.label, reader.operand());
        return {};
    }
    const size_t end = c == '"' ? lexer.line.find('"', from + 1) : std::string_view::npos;
    if (end == std::string_view::npos)
        return reader.refuse("'LBL' must be followed by a number or a name in quotation marks",
                             reader.begin);
    lexer.at = end + 1;
    set_label(reader, lexer.written_from(from));
    return {};
}

core::Result<int> read_whole(KlartextReader& reader, std::string_view after) {
    reader.next();
    const size_t from = reader.lexer.at;
    int value = 0;
    while (reader.lexer.at < reader.lexer.line.size()
           && is_digit(reader.lexer.line[reader.lexer.at]) && value < 100000)
        value = value * 10 + (reader.lexer.line[reader.lexer.at++] - '0');
    if (reader.lexer.at == from)
        return reader.refuse(fmt::format("'{}' must be followed by a number", after), reader.begin);
    return value;
}

core::Result<void> read_label(KlartextReader& reader) {
    reader.accept("LBL");
    reader.accept("SET");
    if (auto named = read_label_name(reader); !named) return named;
    reader.block.flow.kind = FlowKind::label;
    reader.block.flow.span = reader.span_from(reader.begin);
    return {};
}

namespace {

core::Result<void> read_repeats(KlartextReader& reader) {
    if (!reader.accept("REP")) return {};
    FEELER_TRY(reader.block.flow.condition, reader.operand());
    reader.block.flow.has_condition = true;
    if (!reader.lexer.accept('/')) return {}; // remaining repetitions, shown by the control
    if (auto left = reader.operand(); !left) return tl::unexpected(std::move(left).error());
    return {};
}

/// Reads the path of a program, such as `TNC:\dir\name.h`, as written.
core::Result<void> read_program_name(KlartextReader& reader) {
    reader.next();
    const std::string_view rest = reader.lexer.line.substr(reader.lexer.at);
    std::string_view path = rest.substr(0, rest.find_first_of(";~\r\n"));
    while (!path.empty() && is_blank(path.back())) path.remove_suffix(1);
    if (path.size() > 1 && path.front() == '"' && path.back() == '"')
        path = path.substr(1, path.size() - 2);
    if (path.empty())
        return reader.refuse("'CALL PGM' must be followed by the name of a program", reader.begin);
    reader.lexer.at += std::min(rest.find_first_of(";~\r\n"), rest.size());
    set_label(reader, std::string(path));
    return {};
}

} // namespace

core::Result<void> read_call(KlartextReader& reader) {
    Flow& flow = reader.block.flow;
    // `CALL LBL1`: the keyword may be joined to the number.
    if (reader.accept("LBL")) {
        if (auto named = read_label_name(reader); !named) return named;
        if (auto repeats = read_repeats(reader); !repeats) return repeats;
        flow.kind = FlowKind::call_label;
    } else if (reader.accept("PGM")) {
        if (auto named = read_program_name(reader); !named) return named;
        flow.kind = FlowKind::call_program;
    } else {
        return reader.refuse("'CALL' must be followed by LBL or PGM", reader.begin);
    }
    flow.span = reader.span_from(reader.begin);
    return {};
}

namespace {

core::Result<void> read_tool_call_word(KlartextReader& reader) {
    const std::string letters = reader.letters();
    const size_t from = reader.lexer.at;
    if (letters == "X" || letters == "Y" || letters == "Z") {
        ++reader.lexer.at;
        reader.add_word('G', letters == "Z" ? 17.0 : letters == "Y" ? 18.0 : 19.0, from);
        return {};
    }
    if (reader.accept_prefix("DL")) return reader.word('L', from);
    if (letters == "DR" && reader.lexer.line.substr(from + 2).starts_with('2')) { // of the corner
        reader.lexer.at += 3;
        if (reader.lexer.accept(':') || !reader.lexer.is_at_number()) return {};
        const std::string_view rest = reader.lexer.line.substr(reader.lexer.at);
        const std::string_view value = rest.substr(0, rest.find_first_of(" \t;~"));
        reader.command.has_corner_delta = value.find_first_of("123456789Q") != value.npos;
        FEELER_TRY(const Expression ignored, reader.operand());
        (void)ignored;
        return {};
    }
    if (reader.accept_prefix("DR")) return reader.word('D', from);
    if (letters == "S" || letters == "SQ") {
        ++reader.lexer.at;
        return reader.word('S', from);
    }
    if (letters[0] == 'F' || letters[0] == 'M') return read_contour_word(reader);
    return reader.stray();
}

core::Result<void> read_tool_name(KlartextReader& reader) {
    Lexer& lexer = reader.lexer;
    const size_t from = ++lexer.at;
    const size_t end = lexer.line.find('"', from);
    if (end == std::string_view::npos)
        return reader.refuse("the name of the tool has no closing quotation mark", reader.begin);
    reader.command.tool_name = lexer.line.substr(from, end - from);
    lexer.at = end + 1;
    return {};
}

core::Result<void> read_tool_number(KlartextReader& reader) {
    const char c = reader.next();
    if (c == '"') return read_tool_name(reader);
    if (!is_digit(c) && upper(c) != 'Q') return {};
    return reader.word('T', reader.lexer.at);
}

} // namespace

core::Result<void> read_tool(KlartextReader& reader) {
    KlartextLine& command = reader.command;
    const bool calls = reader.accept("CALL");
    if (!calls && !reader.accept("DEF"))
        return reader.refuse("'TOOL' must be followed by CALL or DEF", reader.begin);
    command.kind = calls ? CommandKind::tool_call : CommandKind::tool_definition;
    if (auto done = read_tool_number(reader); !done) return done;
    while (const char c = reader.next()) {
        if (!is_letter(c)) return reader.stray();
        const size_t from = reader.lexer.at;
        if (calls) {
            if (auto done = read_tool_call_word(reader); !done) return done;
        } else if (reader.accept_prefix("L") || reader.accept_prefix("R")) {
            if (auto done = reader.word(upper(c), from); !done) return done;
        } else {
            return reader.stray();
        }
    }
    command.span = reader.span_from(reader.begin);
    return {};
}

namespace {

/// `Q200=2`; the text before it is the name of the cycle.
core::Result<void> read_cycle_parameters(KlartextReader& reader) {
    while (reader.next()) {
        Lexer& lexer = reader.lexer;
        const bool is_q = upper(lexer.line[lexer.at]) == 'Q' && lexer.at + 1 < lexer.line.size()
                          && is_digit(lexer.line[lexer.at + 1]);
        if (!is_q) { // a word of the name
            while (lexer.at < lexer.line.size() && !is_blank(lexer.line[lexer.at])
                   && std::string_view(";~\r\n").find(lexer.line[lexer.at])
                          == std::string_view::npos)
                ++lexer.at;
            continue;
        }
        FEELER_TRY(const int target, read_target(reader));
        const auto letters = reader.letters();
        if (letters == "FAUTO" && target == feed_of_plunge) {
            reader.lexer.at += letters.size();
            reader.command.feed_of_call = true;
            continue;
        }
        if (letters == "FAUTO" || letters == "FMAX")
            return reader.refuse(
                fmt::format("'{}' as the feed of a cycle is not supported yet: give a number",
                            letters),
                lexer.at, ErrorCode::unsupported);
        FEELER_TRY(const Expression value, reader.operand());
        if (auto set = set_result(reader, target, value); !set) return set;
    }
    return {};
}

/// `X+10 IY-5`; for mirror images only the letters.
core::Result<void> read_axes(KlartextReader& reader, bool with_values) {
    while (is_letter(reader.next())) {
        const size_t from = reader.lexer.at;
        const std::string letters = reader.letters();
        const bool incremental = letters.size() > 1 && letters[0] == 'I';
        const char axis = letters[incremental ? 1 : 0];
        if (axis_letters.find(axis) == std::string_view::npos) return reader.stray();
        reader.lexer.at += incremental ? 2 : 1;
        if (!with_values) {
            reader.add_word(axis, 1.0, from);
            continue;
        }
        const Addressing addressing = incremental ? Addressing::incremental : Addressing::absolute;
        if (auto done = reader.word(axis, from, addressing); !done) return done;
    }
    return {};
}

/// Whether the next character is part of the name before a value, as in V.ZEIT.
bool is_in_name(KlartextReader& reader) {
    const char c = reader.next();
    if (c != '.') return is_letter(c) && upper(c) != 'Q';
    const size_t after = reader.lexer.at + 1;
    return after < reader.lexer.line.size() && !is_digit(reader.lexer.line[after]);
}

core::Result<void> read_cycle_part(KlartextReader& reader, int cycle) {
    const size_t from = (reader.next(), reader.lexer.at);
    if (cycle == 7 && reader.next() == '#')
        return reader.refuse("'#': datums of a datum table are not supported yet: give the shift "
                             "of each axis",
                             from, ErrorCode::unsupported);
    if (cycle == 7 || cycle == 19) return read_axes(reader, true);
    if (cycle == 8) return read_axes(reader, false);
    if (cycle == 32 && reader.command.part == 1 && reader.accept_prefix("T"))
        return reader.word('P', from);
    if (cycle == 13 || cycle == 32) { // spindle angle, HSC mode
        reader.lexer.at = reader.lexer.line.size();
        return {};
    }
    const std::string letters = reader.letters();
    if (cycle == 10) {
        if (!reader.accept("ROT") && !reader.accept("IROT"))
            return reader.refuse("'CYCL DEF 10.1' needs ROT and an angle", reader.begin);
        return reader.word('R', from,
                           letters == "IROT" ? Addressing::incremental : Addressing::absolute);
    }
    while (is_in_name(reader)) ++reader.lexer.at;
    return reader.word('P', from); // DIST2, DEPTH-20, PLNGNG5, DWELL0, V.ZEIT 0, F200
}

core::Result<void> read_cycle_call(KlartextReader& reader) {
    KlartextLine& command = reader.command;
    command.kind = CommandKind::cycle_call;
    command.calls_cycle = true;
    if (reader.accept("PAT"))
        return reader.refuse("'CYCL CALL PAT' is not supported yet", reader.begin,
                             ErrorCode::unsupported);
    command.calls_at_point = reader.accept("POS");
    while (const char c = reader.next()) {
        if (!is_letter(c)) return reader.stray();
        if (auto done = read_contour_word(reader); !done) return done;
    }
    return {};
}

} // namespace

core::Result<void> read_cycle(KlartextReader& reader) {
    KlartextLine& command = reader.command;
    if (reader.accept("CALL")) return read_cycle_call(reader);
    if (!reader.accept("DEF"))
        return reader.refuse("'CYCL' must be followed by DEF or CALL", reader.begin);
    FEELER_TRY(command.number, read_whole(reader, "CYCL DEF"));
    if (std::find(std::begin(cycles), std::end(cycles), command.number) == std::end(cycles))
        return reader.refuse(
            fmt::format("'CYCL DEF {}': this cycle is not supported yet", command.number),
            reader.begin, ErrorCode::unsupported);
    command.kind = CommandKind::cycle_definition;
    command.span = reader.span_from(reader.begin);
    if (command.number >= first_new_cycle) return read_cycle_parameters(reader);
    if (reader.lexer.accept('.')) {
        FEELER_TRY(command.part, read_whole(reader, "CYCL DEF"));
    }
    if (command.part > 0) return read_cycle_part(reader, command.number);
    reader.lexer.at = reader.lexer.line.size(); // the cycle's name
    return {};
}

} // namespace gcode
