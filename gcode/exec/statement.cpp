#include "gcode/exec/statement.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/base/math.h"
#include "gcode/language/environment.h"
#include "gcode/language/lexer.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// Whether a code, which is not a motion, is in the modal group of the motions.
bool joins_motions(const Code& code, const Dialect& dialect) {
    return code.is_cycle() || (code.group == ModalGroup::cycle && dialect.has_axis_commands);
}

/// A code of the block that cannot be combined with this one. G80 can be combined with any motion,
/// except where it is one itself.
const CodeWord* rival_of(const Statement& statement, const Code& code, const Dialect& dialect) {
    if (code.group == ModalGroup::other) return nullptr;
    if (const CodeWord* same = statement.of(code.group)) return same;
    if (!dialect.cycles_are_motions) return nullptr;
    const CodeWord* cycle = statement.of(ModalGroup::cycle);
    if (code.group == ModalGroup::motion && cycle && joins_motions(*cycle->code, dialect))
        return cycle;
    return joins_motions(code, dialect) ? statement.of(ModalGroup::motion) : nullptr;
}

/// Whether this word calls a subprogram, jumps or returns on some control that reads ISO words.
bool goes_elsewhere(const Word& word) {
    return std::ranges::any_of(all_dialects(), [&](const Dialect& entry) {
        if (entry.language != Language::words) return false;
        const Code* code = find_code(word.letter, word.value, entry.id);
        return code && code->group == ModalGroup::subprogram;
    });
}

/// Accepts an unknown M code, unless it may change the order of execution or is not valid on any
/// control.
core::Result<void> add_unknown_m_code(Statement& statement, const Word& word,
                                      const Dialect& dialect, const Environment& environment) {
    const bool is_number = word.value >= 0.0 && word.value <= std::numeric_limits<int>::max();
    if (is_number && environment.known_m_codes.count(static_cast<int>(word.value))) return {};
    if (!is_number || std::abs(word.value - core::round(word.value)) > 1e-6)
        return core::fail(
            ErrorCode::unsupported,
            fmt::format("{}: an M code must be a whole number, not negative; correct or remove it",
                        written(word)),
            word.span);
    if (goes_elsewhere(word))
        return core::fail(
            ErrorCode::unsupported,
            fmt::format("{}: on other controls this code jumps or calls, but the dialect {} does "
                        "not have it; remove it, or select the dialect of the program",
                        written(word), dialect.name),
            word.span);
    statement.unknown_m_codes.push_back(&word);
    return {};
}

/// Hint at the equivalent code on this control.
std::string_view meant_instead(const Word& word) {
    if (word.value == 70.0) return "; if it means inches, use G20; lathe cycles are not supported";
    if (word.value == 71.0)
        return "; if it means millimetres, use G21; lathe cycles are not supported";
    if (word.value == 72.0) return "; lathe cycles are not supported";
    if (word.value == 90.1 || word.value == 91.1)
        return "; LinuxCNC and Mach3 have it: use --dialect linuxcnc";
    return {};
}

/// Puts a G code in the place of an earlier one of its group.
void overrule(Statement& statement, const Code* code, const Word& word) {
    for (CodeWord& entry : std::span(statement.code_words.data(), statement.code_count)) {
        if (entry.code->group != code->group) continue;
        statement.overruled.push_back(entry.word);
        entry = {code, &word};
    }
}

core::Result<void> add_code(Statement& statement, const Word& word, const Dialect& dialect,
                            const Environment& environment) {
    const Code* code = find_code(word.letter, word.value, dialect.id);
    if (!code && word.letter == 'M')
        return add_unknown_m_code(statement, word, dialect, environment);
    if (!code)
        return core::fail(ErrorCode::unsupported,
                          fmt::format("{}: the dialect {} has no such code{}", written(word),
                                      dialect.name, meant_instead(word)),
                          word.span);
    if (!code->refusal.empty())
        return core::fail(ErrorCode::unsupported,
                          fmt::format("{}: {}", written(word), code->refusal), word.span);
    const CodeWord* other = rival_of(statement, *code, dialect);
    const bool repeated = other && other->code == code && !dialect.repeated_codes_are_errors;
    if (other && !repeated && word.letter == 'G' && dialect.last_of_group_counts
        && code->group != ModalGroup::action && other->code->group == code->group) {
        overrule(statement, code, word);
        return {};
    }
    if (other && !repeated)
        return core::fail(
            ErrorCode::syntax,
            fmt::format("{} and {} are in the same modal group: a block may have only one of them",
                        written(*other->word), written(word)),
            word.span);
    if (repeated) return {};
    if (statement.code_count == Statement::most_codes)
        return core::fail(ErrorCode::syntax,
                          fmt::format("{}: too many codes in this block", written(word)),
                          word.span);
    statement.code_words[statement.code_count++] = {code, &word};
    statement.groups |= uint64_t{1} << static_cast<unsigned>(code->group);
    return {};
}

/// No word of a program has a larger value.
constexpr double largest_value = 1e12;

/// Whether all following words are arguments: after G65, G66 and G66.1.
bool calls_macro(const Statement& statement) {
    const CodeWord* macro = statement.of(ModalGroup::macro);
    return macro && macro->code->number != g_code(67);
}

} // namespace

const CodeWord* Statement::find(ModalGroup group) const {
    for (const CodeWord& entry : codes())
        if (entry.code->group == group) return &entry;
    return nullptr;
}

const CodeWord* Statement::axis_word_owner() const {
    for (const CodeWord& entry : codes()) {
        const Code& code = *entry.code;
        const bool moves = code.group == ModalGroup::motion || code.group == ModalGroup::cycle
                           || is_machine_move(code.number);
        const bool dwells = code.number == g_code(4) && !word('P');
        if ((!moves && code.uses_axes()) || dwells) return &entry;
    }
    return nullptr;
}

core::Result<void> look_up(const Block& block, const Dialect& dialect,
                           const Environment& environment, Statement& statement,
                           bool words_are_arguments) {
    statement.words.fill(nullptr);
    statement.polar_radius = statement.polar_angle = nullptr;
    statement.corner = statement.angle = nullptr;
    statement.code_count = 0;
    statement.groups = 0;
    statement.letters = 0;
    statement.unknown_m_codes.clear();
    statement.overruled.clear();
    statement.arguments.clear();
    for (const Word& word : block.words) {
        if (std::abs(word.value) > largest_value)
            return core::fail(
                ErrorCode::invalid_value,
                fmt::format("{}: this number is too large for a control", written(word)),
                word.span);
        const bool is_argument =
            calls_macro(statement) || (words_are_arguments && word.letter != 'G');
        if (is_argument) {
            statement.arguments.push_back(&word);
        } else if (word.letter == 'G' || word.letter == 'M') {
            if (auto added = add_code(statement, word, dialect, environment); !added) return added;
        } else if (word.letter == '@') {
            statement.polar_radius = &word;
        } else if (word.letter == '^') {
            statement.polar_angle = &word;
        } else if ((word.letter >= 'i' && word.letter <= 'n') || word.letter >= 't') {
            // I1, J1 and K1 of CIP, normals of a surface and directions of the tool, which are
            // looked up where they are used.
            continue;
        } else if (word.letter >= 'A' && word.letter <= 'Z') {
            statement.words[static_cast<size_t>(word.letter - 'A')] = &word;
            statement.letters |= letter_bit(word.letter);
        } else {
            const Word*& slot = word.letter == 'a' ? statement.angle : statement.corner;
            if (slot)
                return core::fail(ErrorCode::syntax,
                                  fmt::format("{} and {} in one block: only one corner is allowed",
                                              written(*slot), written(word)),
                                  word.span);
            slot = &word;
            if (word.letter != 'a') statement.letters |= corner_bit;
        }
    }
    return {};
}

std::string written(const Word& word) {
    const bool comma = word.letter == 'r' || word.letter == 'c' || word.letter == 'a';
    return fmt::format("{}{}{:.12g}", comma ? "," : "", comma ? upper(word.letter) : word.letter,
                       word.value);
}

core::Result<int> whole_number(const Word& word, int lowest, int highest) {
    const double rounded = core::round(word.value);
    if (std::abs(word.value - rounded) > 1e-4 || !(rounded >= lowest && rounded <= highest))
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: {} must be a whole number from {} to {}", written(word),
                                      word.letter, lowest, highest),
                          word.span);
    return static_cast<int>(rounded);
}

} // namespace gcode
