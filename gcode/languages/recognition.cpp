#include <algorithm>
#include <array>
#include <string>
#include <vector>

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

/// A line of a program as evidence: its code in capitals, with blanks in place of comments, and the
/// comments in parentheses.
struct EvidenceLine {
    std::string code;
    std::vector<std::string> comments{};
};

/// Whether a `(` after this code belongs to it, as in Siemens' `MSG(` and `R1=(2+3)`. Otherwise it
/// begins a comment, as after `N10`, `T1 M6` and at the start of a line.
bool opens_expression(std::string_view code) {
    const size_t last = code.find_last_not_of(" \t");
    if (last == std::string_view::npos) return false;
    const bool has_gap = last + 1 < code.size();
    if (!is_name_part(code[last])) return std::string_view("=,+-*/<>([").find(code[last]) < 10;
    size_t first = last;
    while (first > 0 && is_name_part(code[first - 1])) --first;
    const std::string_view name = code.substr(first, last + 1 - first);
    for (const std::string_view word : {"MSG", "IF", "WHILE", "UNTIL", "AND", "OR", "NOT"})
        if (name == word) return true;
    for (const std::string_view word : {"GOTO", "END", "DO"})
        if (name.starts_with(word)) return false;
    const auto both_letters = [](char a, char b) {
        return (is_letter(a) || a == '_') && (is_letter(b) || b == '_');
    };
    return !has_gap && std::adjacent_find(name.begin(), name.end(), both_letters) != name.end();
}

/// The index of the `)` that closes a comment, or of the last character of the line.
size_t end_of_comment(std::string_view code, size_t at) {
    int depth = 0;
    for (; at + 1 < code.size(); ++at) {
        depth += (code[at] == '(') - (code[at] == ')');
        if (depth == 0) break;
    }
    return at;
}

EvidenceLine evidence_of(std::string_view text) {
    EvidenceLine line{.code = core::upper_case(text)};
    std::string& code = line.code;
    bool is_quoted = false;
    int depth = 0; // of the brackets of expressions
    for (size_t at = 0; at < code.size(); ++at) {
        is_quoted = is_quoted != (code[at] == '"');
        if (is_quoted) continue;
        if (code[at] == ';') {
            code.resize(at);
        } else if (code[at] == ')') {
            --depth;
        } else if (code[at] == '(' && (depth > 0 || opens_expression(code.substr(0, at)))) {
            ++depth;
        } else if (code[at] == '(') {
            const size_t end = end_of_comment(code, at);
            line.comments.push_back(code.substr(at, end + 1 - at));
            std::fill(code.begin() + static_cast<std::ptrdiff_t>(at),
                      code.begin() + static_cast<std::ptrdiff_t>(end + 1), ' ');
        }
    }
    return line;
}

/// The code without the block number and blanks before it.
std::string_view after_block_number(std::string_view code) {
    const auto skip = [&](std::string_view what) {
        code.remove_prefix(std::min(code.find_first_not_of(what), code.size()));
    };
    skip(" \t/");
    if (code.size() > 1 && code.front() == 'N' && is_digit(code[1])) {
        code.remove_prefix(1);
        skip("0123456789");
    }
    skip(" \t");
    return code;
}

/// Features found only in the Siemens language: keywords after the block number, headers, values
/// after `=`.
Clue siemens_clue(std::string_view text, const EvidenceLine& evidence, size_t line) {
    const size_t first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) return std::nullopt;
    if (core::upper_case(text.substr(first)).starts_with(";$PATH="))
        return found(DialectId::siemens, line, "has a ;$PATH=");
    if (text.substr(first).starts_with("%_N_"))
        return found(DialectId::siemens, line, "has a header %_N_");
    if (evidence.code.find('#') != std::string::npos) return std::nullopt;
    const std::string_view words = after_block_number(evidence.code);
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

/// Whether a text contains `word` and then a digit or one of `more`, not as part of a longer name.
/// `letters` has no blanks.
bool has_numbered(std::string_view letters, std::string_view word, std::string_view more = {}) {
    for (size_t at = letters.find(word); at != std::string_view::npos;
         at = letters.find(word, at + 1)) {
        const size_t after = at + word.size();
        const bool begins = at == 0 || !is_letter(letters[at - 1]);
        if (begins && after < letters.size()
            && (is_digit(letters[after]) || more.find(letters[after]) != std::string_view::npos))
            return true;
    }
    return false;
}

std::string without_blanks(std::string_view text) {
    std::string letters;
    for (const char c : text)
        if (c != ' ' && c != '\t') letters.push_back(c);
    return letters;
}

/// Whether a program name begins the text: O and up to four letters or digits.
bool is_okuma_name(std::string_view text) {
    size_t end = 0;
    while (end < text.size() && is_name_part(text[end])) ++end;
    return end > 1 && end <= 5;
}

/// What only Okuma's control has in a line; empty if nothing.
///
/// Source: Okuma OSP programming manuals: file names, CALL and RTS, common variables, G15 H for the
///         work offset, G56 HA for the length offset.
std::string_view okuma_word(const EvidenceLine& evidence) {
    const std::string_view words = after_block_number(evidence.code);
    if (words.starts_with('$') && words.find(".MIN") != std::string_view::npos)
        return "a file name after $";
    if (words.starts_with("CALL O") && is_okuma_name(words.substr(5))) return "CALL O";
    if (words.starts_with("NOEX ")) return "NOEX";
    if (words.starts_with("MODIN O")) return "MODIN";
    const std::string letters = without_blanks(words);
    if (has_numbered(letters, "G15H")) return "G15 H";
    if (letters.find("G56HA") != std::string::npos) return "G56 HA";
    if (has_numbered(letters, "VC") && letters.find('=') != std::string::npos)
        return "VC variables";
    for (const std::string_view name : {"VZOFX[", "VZOFY[", "VZOFZ[", "VTOFH[", "VTOFD["})
        if (letters.find(name) != std::string::npos) return "VZOF or VTOF variables";
    return {};
}

/// `%NAME G71 *`: the first line of a Heidenhain program in DIN/ISO.
bool begins_din_iso(const EvidenceLine& evidence) {
    const std::string_view words = after_block_number(evidence.code);
    if (!words.starts_with('%') || words.size() < 2 || !is_name_part(words[1])) return false;
    const std::string_view after = words.substr(std::min(words.find(' '), words.size()));
    const bool has_unit = after.find(" G70") != std::string_view::npos
                          || after.find(" G71") != std::string_view::npos;
    return has_unit && after.find('*') != std::string_view::npos;
}

/// Controls that no dialect reads, by name. Their programs may look like those of others.
Clue unsupported_clue(const EvidenceLine& evidence, size_t line) {
    if (const std::string_view word = okuma_word(evidence); !word.empty()) {
        Recognition okuma = found(DialectId::fanuc, line, fmt::format("has {}", word));
        okuma.refusal = fmt::format(
            "line {} has {}: this is a program for an Okuma control (OSP), which is not supported; "
            "codes such as G15 and G56 have other meanings there",
            line, word);
        return okuma;
    }
    if (begins_din_iso(evidence)) {
        Recognition din = found(DialectId::heidenhain, line, "begins a program in DIN/ISO");
        din.refusal = fmt::format("line {} begins a Heidenhain program in DIN/ISO, which is not "
                                  "supported: use its Klartext form (.H)",
                                  line);
        return din;
    }
    return std::nullopt;
}

/// Evidence from the file name: programs for this dialect have one of these endings.
Clue name_clue(const std::string& file, DialectId dialect,
               std::initializer_list<std::string_view> endings) {
    const std::string ending =
        core::upper_case(file.substr(std::min(file.find_last_of('.'), file.size())));
    if (std::find(endings.begin(), endings.end(), ending) == endings.end()) return std::nullopt;
    return Recognition{dialect, fmt::format("the file name ends in {}", ending)};
}

/// Whether there is a `@5` or `^30`. `letters` has no blanks.
bool has_polar_word(std::string_view letters) {
    const size_t mark = letters.find_first_of("@^");
    if (mark == std::string_view::npos || mark + 1 >= letters.size()) return false;
    return is_digit(letters[mark + 1])
           || std::string_view("+-.[#").find(letters[mark + 1]) != std::string_view::npos;
}

/// Whether a comment is an instruction for LinuxCNC: `(AXIS,hide)`, `(DEBUG, #5)`. Others may use
/// these words in plain comments.
bool is_active_comment(std::string_view comment) {
    const std::string letters = without_blanks(comment);
    for (const std::string_view word : {"(AXIS,HIDE", "(AXIS,SHOW", "(AXIS,STOP", "(AXIS,NOTIFY",
                                        "(AXIS,XY_Z", "(AXIS,XZ_Y", "(PROBEOPEN", "(LOGOPEN,"})
        if (letters.starts_with(word)) return true;
    for (const std::string_view word : {"(DEBUG,", "(PRINT,", "(LOG,"})
        if (letters.starts_with(word) && letters.find('#') != std::string::npos) return true;
    return false;
}

/// Whether a comment names a post-processor for LinuxCNC: `(Post Processor: linuxcnc_post)`.
bool names_linuxcnc_post(std::string_view comment) {
    const std::string letters = without_blanks(comment);
    return letters.find("POSTPROCESSOR:LINUXCNC") != std::string::npos
           || letters.find("LINUXCNC_POST") != std::string::npos;
}

/// Features of LinuxCNC that the parser of this version does not accept.
Clue linuxcnc_clue(const EvidenceLine& evidence, size_t line) {
    const std::string letters = without_blanks(evidence.code);
    if (letters.find("#<") != std::string::npos || letters.starts_with("O<"))
        return found(DialectId::linuxcnc, line, "has a named parameter or O word");
    if (std::any_of(evidence.comments.begin(), evidence.comments.end(), is_active_comment))
        return found(DialectId::linuxcnc, line, "has an active comment");
    if (has_polar_word(letters))
        return found(DialectId::linuxcnc, line, "has a polar word (@ or ^)");
    const size_t after_number = letters.find_first_not_of("0123456789", 1);
    if (!letters.starts_with('O') || after_number == std::string::npos) return std::nullopt;
    const std::string_view rest = std::string_view(letters).substr(after_number);
    for (const std::string_view word : {"SUB", "CALL", "IF", "WHILE", "DO", "REPEAT"})
        if (rest.starts_with(word) && (rest.size() == word.size() || !is_letter(rest[word.size()])))
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
    Clue linuxcnc{};        // counts only if no code decides
    bool has_tape_mark = false;
    bool changes_tools = false;
    bool has_expressions = false;
    bool has_refused_words = false; // Grbl would not run their lines
};

void remember(size_t& first, bool seen, uint32_t line) {
    if (seen && first == 0) first = line;
}

/// Whether a block has G64 with a tolerance, which only LinuxCNC takes.
bool states_tolerance(const Block& block) {
    bool blends = false, tolerance = false, is_of_other = false;
    for (const Word& word : block.words) {
        tolerance |= word.letter == 'P' || word.letter == 'Q';
        if (word.letter != 'G' || word.expression) continue;
        blends |= word.value == 64.0;
        const Code* code = find_code('G', word.value, DialectId::fanuc);
        is_of_other |= word.value != 64.0 && code && (code->uses('P') || code->uses('Q'));
    }
    return blends && tolerance && !is_of_other;
}

void observe(const Block& block, Habits& habits) {
    habits.has_tape_mark |= block.tape_mark;
    bool homes = false, length = false, offset_number = false, moves = false, cancels = false;
    bool arcs = false, names_axis = false, switches = false;
    const std::string_view refused = dialect(DialectId::grbl).refused_letters;
    for (const Word& word : block.words) {
        const bool g = word.letter == 'G' && !word.expression;
        homes |= g && (word.value == 28.0 || word.value == 30.0);
        length |= g && word.value == 43.0;
        moves |= g && word.value <= 3.0;
        arcs |= g && (word.value == 2.0 || word.value == 3.0);
        names_axis |= word.letter >= 'X' && word.letter <= 'Z';
        cancels |= g && (word.value == 49.0 || word.value == 80.0);
        habits.has_refused_words |= refused.find(word.letter) != std::string_view::npos;
        offset_number |= word.letter == 'H';
        switches |=
            word.letter == 'M' && !word.expression && (word.value == 428.0 || word.value == 429.0);
        habits.changes_tools |= word.letter == 'T' || (word.letter == 'M' && word.value == 6.0);
        for (size_t i = 0; g && i < candidates.size(); ++i) {
            const bool unknown = !find_code('G', word.value, candidates[i]);
            habits.unknown_count[i] += unknown;
            remember(habits.first_unknown[i], unknown, block.line);
        }
    }
    remember(habits.first_length_offset, length && offset_number, block.line);
    remember(habits.first_crowd, homes && moves, block.line);
    if (!habits.linuxcnc && states_tolerance(block))
        habits.linuxcnc = found(DialectId::linuxcnc, block.line, "has G64 with P or Q");
    if (!habits.linuxcnc && switches)
        habits.linuxcnc = found(DialectId::linuxcnc, block.line,
                                "has M428 or M429, which switch kinematics of LinuxCNC");
    habits.has_refused_words |= (moves && cancels) || (arcs && !names_axis);
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

Recognition judge(const Habits& habits, const std::string& file) {
    if (Clue clue = clue_of_codes(habits)) return *clue;
    if (habits.first_crowd)
        return found(DialectId::fanuc, habits.first_crowd,
                     "has G28 and a motion code in one block");
    if (habits.linuxcnc) return *habits.linuxcnc;
    if (habits.first_length_offset) {
        if (Clue clue = name_clue(file, DialectId::linuxcnc, {".NGC"})) return *clue;
        return found(DialectId::fanuc, habits.first_length_offset, "has G43 with H");
    }
    const bool grbl_knows_all = habits.first_unknown.back() == 0;
    if (habits.changes_tools || habits.has_expressions || habits.has_tape_mark
        || habits.has_refused_words || !grbl_knows_all)
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
    if (block.prints) return found(DialectId::fanuc, block.line, "has DPRNT, POPEN or PCLOS");
    return std::nullopt;
}

/// Whether G70 to G72 of a block are cycles of a lathe, which Fanuc controls have too, rather than
/// Haas's hole patterns.
bool is_lathe_cycle(const Block& block, const Word& code) {
    if (code.letter != 'G' || code.value < 70.0 || code.value > 72.0) return false;
    return std::any_of(block.words.begin(), block.words.end(), [](const Word& word) {
        return std::string_view("PQUW").find(word.letter) != std::string_view::npos;
    });
}

/// Codes that Haas controls have and Fanuc controls do not. On Fanuc, M97 without P is a different
/// code.
Clue haas_clue(const Block& block) {
    const auto is_target = [](const Word& word) { return word.letter == 'P'; };
    const bool has_target = std::any_of(block.words.begin(), block.words.end(), is_target);
    for (const Word& word : block.words) {
        if (word.expression || (word.letter != 'G' && word.letter != 'M')) continue;
        if (word.letter == 'M' && (word.value != 97.0 || !has_target)) continue;
        if (is_lathe_cycle(block, word)) continue;
        if (!find_code(word.letter, word.value, DialectId::haas)
            || find_code(word.letter, word.value, DialectId::fanuc))
            continue;
        return found(DialectId::haas, block.line,
                     fmt::format("has a code that only Haas controls have ({}{:.12g})", word.letter,
                                 word.value));
    }
    return std::nullopt;
}

Clue language_clue(std::string_view text, const EvidenceLine& evidence, size_t line) {
    if (Clue clue = foreign_clue(text, line)) return clue;
    if (Clue clue = siemens_clue(text, evidence, line)) return clue;
    return linuxcnc_clue(evidence, line);
}

} // namespace

Recognition recognise(const Program& program) {
    constexpr size_t enough_lines = 10000; // that are not empty
    if (Clue clue = name_clue(program.file, DialectId::siemens, {".MPF", ".SPF"})) return *clue;
    // Of the languages with letters and numbers, Fanuc's accepts the most, if any text may follow
    // a semicolon.
    Dialect widest = dialect(DialectId::fanuc);
    widest.semicolon_ends_block = false;
    Habits habits;
    Block block;
    Clue family; // Fanuc, unless a code of Haas follows
    size_t lines = 0;
    for (size_t number = 1; lines < enough_lines; ++number) {
        if (!program.has_line(number).value_or(false)) break;
        const std::string_view text = program.line(number);
        const EvidenceLine evidence = evidence_of(text);
        if (Clue clue = unsupported_clue(evidence, number)) return *clue;
        if (!family)
            if (Clue clue = language_clue(text, evidence, number)) return *clue;
        const bool names_post =
            std::any_of(evidence.comments.begin(), evidence.comments.end(), names_linuxcnc_post);
        if (!habits.linuxcnc && names_post)
            habits.linuxcnc =
                found(DialectId::linuxcnc, number, "names a post-processor for LinuxCNC");
        if (!parse_line(text, static_cast<uint32_t>(number), widest, block)) continue;
        lines += !block.is_empty();
        habits.has_expressions |= !block.pool.instructions.empty();
        if (!family) family = family_clue(block);
        if (family) {
            if (Clue clue = haas_clue(block)) return *clue;
            continue;
        }
        observe(block, habits);
    }
    if (!family) return judge(habits, program.file);
    return *family;
}

} // namespace gcode
