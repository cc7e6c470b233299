#include <algorithm>

#include <fmt/format.h>

#include "gcode/axes.h"
#include "gcode/expression_parser.h"
#include "gcode/flow_index.h"
#include "gcode/klartext_reader.h"

namespace gcode {
namespace {

using core::ErrorCode;

constexpr int first_new_cycle = 200; // whose parameters are Q parameters

constexpr int cycles[] = {1,   7,   8,   9,   10,  11,  13,  19,  32,  200, 201,
                          202, 203, 205, 206, 207, 208, 209, 220, 221, 247};

void set_label(KlartextReader& reader, std::string name) {
    Flow& flow = reader.block.flow;
    flow.label_name = static_cast<uint32_t>(reader.block.pool.names.size());
    flow.has_label = true;
    reader.block.pool.names.push_back(std::move(name));
}

} // namespace

/// A number, or a name in quotation marks, which it keeps.
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
        return reader.refuse("'LBL' needs a number behind it, or a name in quotation marks",
                             reader.begin);
    lexer.at = end + 1;
    set_label(reader, lexer.written_from(from));
    return {};
}

core::Result<int> read_whole(KlartextReader& reader, std::string_view behind) {
    reader.next();
    const size_t from = reader.lexer.at;
    int value = 0;
    while (reader.lexer.at < reader.lexer.line.size()
           && is_digit(reader.lexer.line[reader.lexer.at]) && value < 100000)
        value = value * 10 + (reader.lexer.line[reader.lexer.at++] - '0');
    if (reader.lexer.at == from)
        return reader.refuse(fmt::format("'{}' needs a number behind it", behind), reader.begin);
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
    if (!reader.lexer.accept('/')) return {}; // what is left to do, shown by the control
    if (auto left = reader.operand(); !left) return tl::unexpected(std::move(left).error());
    return {};
}

/// Of `TNC:\dir\name.h` the name, as written.
core::Result<void> read_program_name(KlartextReader& reader) {
    reader.next();
    const std::string_view rest = reader.lexer.line.substr(reader.lexer.at);
    std::string_view path = rest.substr(0, rest.find_first_of(";~\r\n"));
    while (!path.empty() && is_blank(path.back())) path.remove_suffix(1);
    if (path.size() > 1 && path.front() == '"' && path.back() == '"')
        path = path.substr(1, path.size() - 2);
    if (path.empty())
        return reader.refuse("'CALL PGM' needs the name of a program behind it", reader.begin);
    reader.lexer.at += std::min(rest.find_first_of(";~\r\n"), rest.size());
    set_label(reader, std::string(path));
    return {};
}

} // namespace

core::Result<void> read_call(KlartextReader& reader) {
    Flow& flow = reader.block.flow;
    // `CALL LBL1`: the keyword may run into the number.
    if (reader.accept("LBL")) {
        if (auto named = read_label_name(reader); !named) return named;
        if (auto repeats = read_repeats(reader); !repeats) return repeats;
        flow.kind = FlowKind::call_label;
    } else if (reader.accept("PGM")) {
        if (auto named = read_program_name(reader); !named) return named;
        flow.kind = FlowKind::call_program;
    } else {
        return reader.refuse("behind 'CALL' belongs LBL or PGM", reader.begin);
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

core::Result<void> read_tool_number(KlartextReader& reader) {
    const char c = reader.next();
    if (c == '"')
        return reader.refuse("'TOOL' by name is not supported yet: give the tool's number",
                             reader.begin, ErrorCode::unsupported);
    if (!is_digit(c) && upper(c) != 'Q') return {};
    return reader.word('T', reader.lexer.at);
}

} // namespace

core::Result<void> read_tool(KlartextReader& reader) {
    Command& command = reader.block.command;
    const bool calls = reader.accept("CALL");
    if (!calls && !reader.accept("DEF"))
        return reader.refuse("behind 'TOOL' belongs CALL or DEF", reader.begin);
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

/// `Q200=2`; what stands before it is the cycle's name.
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
        if (auto letters = reader.letters(); letters == "FAUTO" || letters == "FMAX")
            return reader.refuse(fmt::format("'{}' as a cycle's feed is not supported yet: give a "
                                             "number",
                                             letters),
                                 lexer.at, ErrorCode::unsupported);
        FEELER_TRY(const Expression value, reader.operand());
        if (auto set = set_result(reader, target, value); !set) return set;
    }
    return {};
}

/// `X+10 IY-5`; for mirror images the letters alone.
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

core::Result<void> read_cycle_part(KlartextReader& reader, int cycle) {
    const size_t from = (reader.next(), reader.lexer.at);
    if (cycle == 7 && reader.next() == '#')
        return reader.refuse("'#': datums of a datum table are not supported yet: give the shift "
                             "of each axis",
                             from, ErrorCode::unsupported);
    if (cycle == 7 || cycle == 19) return read_axes(reader, true);
    if (cycle == 8) return read_axes(reader, false);
    if (cycle == 13 || cycle == 32) { // the spindle's angle, tolerances
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
    while (is_letter(reader.next()) && upper(reader.next()) != 'Q') ++reader.lexer.at;
    return reader.word('P', from); // DIST2, DEPTH-20, PLNGNG5, DWELL0, F200
}

core::Result<void> read_cycle_call(KlartextReader& reader) {
    Command& command = reader.block.command;
    command.kind = CommandKind::cycle_call;
    command.calls_cycle = true;
    if (reader.accept("PAT"))
        return reader.refuse("'CYCL CALL PAT' is not supported yet", reader.begin,
                             ErrorCode::unsupported);
    reader.accept("POS");
    while (const char c = reader.next()) {
        if (!is_letter(c)) return reader.stray();
        if (auto done = read_contour_word(reader); !done) return done;
    }
    return {};
}

} // namespace

core::Result<void> read_cycle(KlartextReader& reader) {
    Command& command = reader.block.command;
    if (reader.accept("CALL")) return read_cycle_call(reader);
    if (!reader.accept("DEF"))
        return reader.refuse("behind 'CYCL' belongs DEF or CALL", reader.begin);
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
