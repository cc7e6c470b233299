#include <array>
#include <cmath>

#include <fmt/format.h>

#include "gcode/dialect.h"
#include "gcode/parser.h"

namespace gcode {
namespace {

/// A look at one line: the dialect it gives away, and how.
using Clue = std::optional<Recognition>;

Recognition found(DialectId dialect, size_t line, std::string_view what) {
    return {dialect, fmt::format("line {} {}", line, what)};
}

bool starts_with_word(std::string_view text, std::string_view word) {
    return text.substr(0, word.size()) == word;
}

/// Languages that are no G-code give themselves away before any word can be read.
Clue foreign_clue(std::string_view text, size_t line) {
    const size_t first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) return std::nullopt;
    const std::string_view rest = text.substr(first);
    const size_t after_number = rest.find_first_not_of("0123456789 ");
    const std::string_view words =
        after_number == std::string_view::npos ? "" : rest.substr(after_number);
    for (const std::string_view word : {"BEGIN PGM", "TOOL CALL", "TOOL DEF", "BLK FORM"})
        if (starts_with_word(words, word))
            return found(DialectId::heidenhain, line, fmt::format("says {}", word));
    for (const std::string_view word : {"PROC ", "DEF ", "EXTERN ", "MCALL", "CYCLE8", "%_N_"})
        if (starts_with_word(words, word))
            return found(DialectId::siemens, line, fmt::format("says {}", word));
    return std::nullopt;
}

/// Things only LinuxCNC reads, which the parser of this version refuses.
Clue linuxcnc_clue(std::string_view text, size_t line) {
    if (text.find("#<") != std::string_view::npos || text.find("O<") != std::string_view::npos
        || text.find("o<") != std::string_view::npos)
        return found(DialectId::linuxcnc, line, "has a named parameter or O word");
    if (text.find("(AXIS,") != std::string_view::npos
        || text.find("(DEBUG,") != std::string_view::npos)
        return found(DialectId::linuxcnc, line, "has an active comment");
    return std::nullopt;
}

Clue word_clue(const Block& block) {
    for (const Word& word : block.words) {
        if (word.letter == 'O' && block.words.front().letter == 'O')
            return found(DialectId::fanuc, block.line,
                         fmt::format("is a program number (O{:.12g})", word.value));
        if (word.letter != 'G') continue;
        const double tenth = word.value * 10.0 - 10.0 * std::floor(word.value);
        for (const double code : {61.1, 90.1, 59.1, 59.2, 59.3, 92.2, 92.3, 33.0})
            if (word.value == code)
                return found(DialectId::linuxcnc, block.line,
                             fmt::format("has G{:.12g}", word.value));
        if (word.value == 187.0 || word.value == 103.0)
            return found(DialectId::haas, block.line, fmt::format("has G{:.12g}", word.value));
        if (tenth < 0.5 && (word.value == 69.0 || word.value == 15.0 || word.value == 67.0))
            return found(DialectId::fanuc, block.line, fmt::format("has G{:.12g}", word.value));
    }
    return std::nullopt;
}

/// What the whole program has or lacks, for when no line gives it away.
struct Habits {
    size_t tape_marks = 0;
    size_t first_length_offset = 0; // line of a G43 with H
    size_t first_home_with_motion = 0;
    bool changes_tools = false;
    bool uses_cycles = false;
};

void observe(const Block& block, Habits& habits) {
    habits.tape_marks += block.tape_mark;
    bool has_g28 = false, has_g43 = false, has_h = false, has_motion = false;
    for (const Word& word : block.words) {
        const bool g = word.letter == 'G';
        has_g28 |= g && word.value == 28.0;
        has_g43 |= g && word.value == 43.0;
        has_motion |= g && word.value <= 3.0;
        has_h |= word.letter == 'H';
        habits.changes_tools |= word.letter == 'T' || (word.letter == 'M' && word.value == 6.0);
        habits.uses_cycles |= g && word.value >= 73.0 && word.value <= 89.0 && word.value != 80.0;
    }
    if (has_g43 && has_h && !habits.first_length_offset) habits.first_length_offset = block.line;
    if (has_g28 && has_motion && !habits.first_home_with_motion)
        habits.first_home_with_motion = block.line;
}

Recognition judge(const Habits& habits) {
    if (habits.first_home_with_motion)
        return found(DialectId::fanuc, habits.first_home_with_motion,
                     "has G28 and a motion code in one block");
    if (habits.first_length_offset && habits.tape_marks > 0)
        return found(DialectId::fanuc, habits.first_length_offset,
                     "has G43 with H, and the program stands between % marks");
    if (habits.changes_tools || habits.uses_cycles || habits.tape_marks > 0)
        return {DialectId::linuxcnc, "nothing in it is of one control alone"};
    return {DialectId::grbl, "it has no tools, no cycles and no % marks"};
}

} // namespace

Recognition recognise(const Program& program) {
    Habits habits;
    for (size_t number = 1; number <= program.line_count(); ++number) {
        const std::string_view text = program.line(number);
        if (Clue clue = foreign_clue(text, number)) return *clue;
        if (Clue clue = linuxcnc_clue(text, number)) return *clue;
        const auto block = parse_line(text, static_cast<uint32_t>(number));
        if (!block) continue;
        if (Clue clue = word_clue(*block)) return *clue;
        observe(*block, habits);
    }
    return judge(habits);
}

} // namespace gcode
