#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "core/base/text.h"
#include "gcode/language/codes.h"
#include "gcode/language/language.h"
#include "gcode/language/lexer.h"
#include "gcode/text/source.h"

namespace gcode {
namespace {

/// The dialect that a line indicates, with the evidence; empty if it indicates none.
using Clue = std::optional<Recognition>;

Recognition found(DialectId dialect, size_t line, std::string_view what) {
    return {dialect, fmt::format("line {} {}", line, what)};
}

/// Languages other than G-code, recognised before words are parsed.
Clue foreign_clue(std::string_view text, size_t line) {
    const size_t first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) return std::nullopt;
    const std::string_view rest = text.substr(first);
    const size_t after_number = rest.find_first_not_of("0123456789 ");
    const std::string_view words =
        after_number == std::string_view::npos ? "" : rest.substr(after_number);
    for (const std::string_view word : {"BEGIN PGM", "TOOL CALL", "TOOL DEF", "BLK FORM"})
        if (words.starts_with(word))
            return found(DialectId::heidenhain, line, fmt::format("contains {}", word));
    return std::nullopt;
}

/// Features found only in the Siemens language: keywords after the block number, headers, values
/// after `=`.
Clue siemens_clue(std::string_view text, size_t line) {
    std::string words = core::upper_case(text);
    size_t first = words.find_first_not_of(" \t/");
    if (first == std::string::npos) return std::nullopt;
    if (std::string_view(words).substr(first).starts_with(";$PATH="))
        return found(DialectId::siemens, line, "has a ;$PATH=");
    words = words.substr(first, words.find(';') - first);
    if (words.starts_with("%_N_")) return found(DialectId::siemens, line, "has a header %_N_");
    if (words.empty() || words.find('#') != std::string::npos) return std::nullopt;
    if (words.front() == 'N' && words.size() > 1 && is_digit(words[1]))
        words.erase(0, std::min(words.find_first_not_of("0123456789", 1), words.size()));
    words.erase(0, std::min(words.find_first_not_of(" \t"), words.size()));
    for (const std::string_view word :
         {"PROC ",   "DEF REAL", "DEF INT",  "DEF BOOL", "DEF STRING", "EXTERN ",
          "MCALL",   "CYCLE8",   "MSG(",     "MSG (",    "GOTOF ",     "GOTOB ",
          "SUPA",    "TRAORI",   "TRAFOOF",  "STOPRE",   "WORKPIECE(", "TRANS X",
          "ATRANS ", "G500",     "CYCLE800", "HOLES1(",  "HOLES2("})
        if (words.starts_with(word))
            return found(DialectId::siemens, line, fmt::format("contains {}", word));
    const size_t after_r = words.find_first_not_of("0123456789 ", 1);
    if (words.size() > 2 && words[0] == 'R' && is_digit(words[1]) && after_r < words.size()
        && words[after_r] == '=')
        return found(DialectId::siemens, line, "sets an R parameter");
    for (const std::string_view word :
         {" CR=", "=AC(", "=IC(", "T=\"", " GOTOF ", " GOTOB ", " TURN=", " SUPA ", " AP=", " RP="})
        if (words.find(word) != std::string::npos)
            return found(DialectId::siemens, line,
                         fmt::format("contains {}", word.substr(word.find_first_not_of(' '))));
    return std::nullopt;
}

/// Evidence from the file name: Siemens programs end in .MPF and .SPF.
Clue name_clue(const std::string& file) {
    const std::string ending =
        core::upper_case(file.substr(std::min(file.find_last_of('.'), file.size())));
    if (ending != ".MPF" && ending != ".SPF") return std::nullopt;
    return Recognition{DialectId::siemens, fmt::format("the file name ends in {}", ending)};
}

/// Whether there is a `@5` or `^30` outside comments. `letters` has no blanks.
bool has_polar_word(std::string_view letters) {
    const size_t code_end = std::min(letters.find('('), letters.find(';'));
    const std::string_view code = letters.substr(0, code_end);
    const size_t mark = code.find_first_of("@^");
    if (mark == std::string_view::npos || mark + 1 >= code.size()) return false;
    return is_digit(code[mark + 1]) || std::string_view("+-.[#").find(code[mark + 1]) < 5;
}

/// Features of LinuxCNC that the parser of this version does not accept.
Clue linuxcnc_clue(std::string_view text, size_t line) {
    std::string letters;
    for (const char c : text)
        if (c != ' ' && c != '\t') letters.push_back(upper(c));
    if (letters.find("#<") != std::string::npos || letters.starts_with("O<"))
        return found(DialectId::linuxcnc, line, "has a named parameter or O word");
    if (letters.find("(AXIS,") != std::string::npos || letters.find("(DEBUG,") != std::string::npos)
        return found(DialectId::linuxcnc, line, "has an active comment");
    if (has_polar_word(letters))
        return found(DialectId::linuxcnc, line, "has a polar word (@ or ^)");
    const size_t after_number = letters.find_first_not_of("0123456789", 1);
    if (!letters.starts_with('O') || after_number == std::string::npos) return std::nullopt;
    const std::string_view rest = std::string_view(letters).substr(after_number);
    for (const std::string_view word : {"SUB", "CALL", "IF", "WHILE", "DO", "REPEAT"})
        if (rest.starts_with(word))
            return found(DialectId::linuxcnc, line, fmt::format("has an O word ({})", word));
    return std::nullopt;
}

// The dialects that differ in their G codes. One that has the codes of another cannot be recognised
// by them; it needs a clue of its own.
constexpr std::array candidates = {DialectId::linuxcnc, DialectId::fanuc, DialectId::haas,
                                   DialectId::grbl};

/// Features of the whole program.
struct Habits {
    std::array<size_t, candidates.size()> first_unknown{}; // line of a G code not in that dialect
    std::array<size_t, candidates.size()> unknown_count{}; // of G codes
    size_t first_length_offset = 0;                        // G43 with H
    size_t first_crowd = 0; // G28 or a cycle with a motion code in one block
    bool has_tape_mark = false;
    bool changes_tools = false;
    bool has_expressions = false;
};

void remember(size_t& first, bool seen, uint32_t line) {
    if (seen && first == 0) first = line;
}

void observe(const Block& block, Habits& habits) {
    habits.has_tape_mark |= block.tape_mark;
    bool homes = false, length = false, offset_number = false, moves = false;
    for (const Word& word : block.words) {
        const bool g = word.letter == 'G' && !word.expression;
        homes |= g && (word.value == 28.0 || word.value == 30.0);
        length |= g && word.value == 43.0;
        moves |= g && word.value <= 3.0;
        offset_number |= word.letter == 'H';
        habits.changes_tools |= word.letter == 'T' || (word.letter == 'M' && word.value == 6.0);
        for (size_t i = 0; g && i < candidates.size(); ++i) {
            const bool unknown = !find_code('G', word.value, candidates[i]);
            habits.unknown_count[i] += unknown;
            remember(habits.first_unknown[i], unknown, block.line);
        }
    }
    remember(habits.first_length_offset, length && offset_number, block.line);
    remember(habits.first_crowd, homes && moves, block.line);
}

/// For a program of an unsupported control: the dialect that has most of its codes.
Recognition clue_of_foreign_codes(const Habits& habits) {
    const bool fanuc = habits.unknown_count[1] < habits.unknown_count[0];
    const size_t index = fanuc ? 1 : 0;
    return found(
        candidates[index], habits.first_unknown[index],
        fmt::format("has a code of a control that is not supported, and {} has most of the others",
                    dialect(candidates[index]).name));
}

/// A G code that only some dialects have excludes the others.
Clue clue_of_codes(const Habits& habits) {
    const auto [linuxcnc, fanuc, haas, grbl] = habits.first_unknown;
    if (linuxcnc && fanuc && haas && grbl) return clue_of_foreign_codes(habits);
    if (linuxcnc && fanuc && !haas)
        return found(DialectId::haas, fanuc, "has a code that only Haas controls have");
    if (linuxcnc && !fanuc)
        return found(DialectId::fanuc, linuxcnc, "has a code that LinuxCNC does not have");
    if (!linuxcnc && fanuc && grbl)
        return found(DialectId::linuxcnc, fanuc, "has a code that only LinuxCNC has");
    return std::nullopt;
}

Recognition judge(const Habits& habits) {
    if (Clue clue = clue_of_codes(habits)) return *clue;
    if (habits.first_crowd)
        return found(DialectId::fanuc, habits.first_crowd,
                     "has G28 and a motion code in one block");
    if (habits.first_length_offset)
        return found(DialectId::fanuc, habits.first_length_offset, "has G43 with H");
    const bool grbl_knows_all = habits.first_unknown.back() == 0;
    if (habits.changes_tools || habits.has_expressions || habits.has_tape_mark || !grbl_knows_all)
        return {DialectId::linuxcnc, "nothing in the program is specific to one control"};
    return {DialectId::grbl,
            "the program has no tools, no expressions, no % marks and only codes of Grbl"};
}

/// Features of the Fanuc family: number or name of a program, jumps and loops.
Clue family_clue(const Block& block) {
    if (!block.words.empty() && block.words.front().letter == 'O')
        return found(DialectId::fanuc, block.line,
                     fmt::format("is a program number (O{:.12g})", block.words.front().value));
    if (block.is_program_name)
        return found(DialectId::fanuc, block.line, "is the name of a program in < and >");
    if (block.flow.kind != FlowKind::none)
        return found(DialectId::fanuc, block.line, "has IF, WHILE or GOTO");
    return std::nullopt;
}

/// Codes that Haas controls have and Fanuc controls do not. On Fanuc, M97 without P is a different
/// code.
Clue haas_clue(const Block& block) {
    const auto is_target = [](const Word& word) { return word.letter == 'P'; };
    const bool has_target = std::any_of(block.words.begin(), block.words.end(), is_target);
    for (const Word& word : block.words) {
        if (word.expression || (word.letter != 'G' && word.letter != 'M')) continue;
        if (word.letter == 'M' && (word.value != 97.0 || !has_target)) continue;
        if (!find_code(word.letter, word.value, DialectId::haas)
            || find_code(word.letter, word.value, DialectId::fanuc))
            continue;
        return found(DialectId::haas, block.line,
                     fmt::format("has a code that only Haas controls have ({}{:.12g})", word.letter,
                                 word.value));
    }
    return std::nullopt;
}

Clue language_clue(std::string_view text, size_t line) {
    if (Clue clue = foreign_clue(text, line)) return clue;
    if (Clue clue = siemens_clue(text, line)) return clue;
    return linuxcnc_clue(text, line);
}

} // namespace

Recognition recognise(const Program& program) {
    constexpr size_t enough_lines = 10000; // that are not empty
    if (Clue clue = name_clue(program.file)) return *clue;
    Habits habits;
    Block block;
    Clue family; // Fanuc, unless a code of Haas follows
    size_t lines = 0;
    for (size_t number = 1; lines < enough_lines; ++number) {
        if (!program.has_line(number).value_or(false)) break;
        const std::string_view text = program.line(number);
        if (!family)
            if (Clue clue = language_clue(text, number)) return *clue;
        // Of the languages with letters and numbers, Fanuc's accepts the most.
        if (!parse_line(text, static_cast<uint32_t>(number), dialect(DialectId::fanuc), block))
            continue;
        lines += !block.is_empty();
        habits.has_expressions |= !block.pool.instructions.empty();
        if (!family) family = family_clue(block);
        if (family) {
            if (Clue clue = haas_clue(block)) return *clue;
            continue;
        }
        observe(block, habits);
    }
    if (!family) return judge(habits);
    return *family;
}

} // namespace gcode
