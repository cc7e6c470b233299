#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "app/base/text.h"
#include "app/setup/control/offset_store.h"
#include "core/base/text.h"
#include "gcode/language/canonical.h"
#include "gcode/language/dialect.h"
#include "gcode/language/lexer.h"

namespace app {
namespace {

using gcode::LengthUnit;

constexpr int highest_tool_offset = 999;

/// A word with its number.
struct OffsetWord {
    char letter;
    gcode::Number number;
    core::SourceSpan where;
};

/// The words of a line up to what is no word with a number.
struct OffsetWords {
    std::vector<OffsetWord> words;
    std::optional<core::Error> end; // why the rest was not read
};

OffsetWords words_with_numbers(const std::string& text, uint32_t line) {
    gcode::Lexer lexer{.line = text, .line_number = line, .comments_nest = false};
    OffsetWords found;
    for (char next = lexer.peek(); next != '\0' && next != ';'; next = lexer.peek()) {
        const size_t begin = lexer.at;
        if (next == '(') {
            (void)lexer.bracket_comment();
            continue;
        }
        ++lexer.at;
        if (next == '%' || next == '/') continue;
        const char letter = next == ':' ? 'O' : gcode::upper(next);
        auto number = lexer.number();
        if (!gcode::is_letter(letter) || !number) {
            found.end = core::fail(core::ErrorCode::syntax,
                                   fmt::format("'{}' is no word with a number: offsets in a file "
                                               "must be numbers",
                                               clipped(trimmed(lexer.line.substr(begin)), 20)),
                                   lexer.span(begin, begin + 1))
                            .value();
            return found;
        }
        found.words.push_back({letter, *number, lexer.span_from(begin)});
    }
    return found;
}

bool is_code(const OffsetWord& word, double number) {
    return word.letter == 'G' && word.number.value == number;
}

/// One G10 with its words, by letter.
struct OffsetEntry {
    const OffsetWord* code = nullptr;
    std::array<const OffsetWord*, 26> words{};

    const OffsetWord* word(char letter) const { return words[static_cast<size_t>(letter - 'A')]; }
};

/// The modes that decide what G10 writes.
struct OffsetModes {
    LengthUnit unit{};
    bool unit_is_said = false;
    bool adds = false;  // G91
    bool skips = false; // from G10 L3, L50 or L52 to G11
};

class OffsetBlocks {
public:
    explicit OffsetBlocks(const OffsetStore& store) : store_(store) {
        modes_.unit = store.reading.unit;
        modes_.unit_is_said = store.reading.unit_is_stated;
    }

    core::Result<void> take_line(const std::string& text, uint32_t line);
    void finish();

private:
    core::Result<void> take_entry(const OffsetEntry& entry);
    core::Result<void> take_work_offset(const OffsetEntry& entry, bool is_extended);
    core::Result<void> take_origin(const OffsetEntry& entry, ControlOrigin& origin,
                                   const std::string& name);
    core::Result<void> take_tool_offset(const OffsetEntry& entry, int kind);
    core::Result<void> take_single_offset(const OffsetEntry& entry);
    core::Result<void> take_tool_entry(const OffsetEntry& entry);
    void take_modes(const OffsetWord& word);
    core::Result<int> whole(const OffsetEntry& entry, char letter, int low, int high) const;
    core::Result<const OffsetWord*> needed(const OffsetEntry& entry, char letter) const;
    core::Result<void> put(std::optional<ControlValue>& place, ControlValue value,
                           const OffsetWord& word, const std::string& name) const;
    double written(const OffsetWord& word, bool is_angle) const;
    ControlValue length_of(const OffsetWord& word, double factor = 1.0);
    void leave_out(const OffsetWord& code, const std::string& what);

    const OffsetStore& store_;
    OffsetModes modes_;
    bool has_geometry_ = false, is_single_ = false, unit_counted_ = false;
    std::map<std::string, std::pair<uint32_t, size_t>> left_out_; // first line, how often
};

tl::unexpected<core::Error> refused(const OffsetWord& word, std::string message) {
    return core::fail(core::ErrorCode::syntax, std::move(message), word.where);
}

std::string text_of(const OffsetWord& word) {
    return fmt::format("{}{:g}", word.letter, word.number.value);
}

double OffsetBlocks::written(const OffsetWord& word, bool is_angle) const {
    const ControlReading& reading = store_.reading;
    if (word.number.has_point || !reading.counts_smallest_steps) return word.number.value;
    const double step = modes_.unit == LengthUnit::inch ? reading.step_inch : reading.step_mm;
    return word.number.value * (is_angle ? reading.step_deg : step);
}

ControlValue OffsetBlocks::length_of(const OffsetWord& word, double factor) {
    unit_counted_ = unit_counted_ || !modes_.unit_is_said;
    return store_.length(factor * written(word, false), modes_.unit, word.where.line);
}

void OffsetBlocks::take_modes(const OffsetWord& word) {
    if (is_code(word, 20.0) || is_code(word, 21.0)) {
        modes_.unit = is_code(word, 20.0) ? LengthUnit::inch : LengthUnit::mm;
        modes_.unit_is_said = true;
    }
    if (is_code(word, 90.0) || is_code(word, 91.0)) modes_.adds = is_code(word, 91.0);
    if (is_code(word, 11.0)) modes_.skips = false;
}

core::Result<const OffsetWord*> OffsetBlocks::needed(const OffsetEntry& entry, char letter) const {
    if (const OffsetWord* word = entry.word(letter)) return word;
    return refused(*entry.code, fmt::format("this G10 needs {}", letter));
}

core::Result<int> OffsetBlocks::whole(const OffsetEntry& entry, char letter, int low,
                                      int high) const {
    FEELER_TRY(const OffsetWord* word, needed(entry, letter));
    const double number = word->number.value;
    if (number >= low && number <= high && number == std::floor(number))
        return static_cast<int>(number);
    return refused(
        *word, fmt::format("{}: must be a whole number from {} to {}", text_of(*word), low, high));
}

/// With G91 a value is added to the one before, which the file must state.
core::Result<void> OffsetBlocks::put(std::optional<ControlValue>& place, ControlValue value,
                                     const OffsetWord& word, const std::string& name) const {
    if (!modes_.adds) {
        store_.put(place, std::move(value), name);
        return {};
    }
    if (!place)
        return refused(word, fmt::format("{}: G91 adds to a value of {} that no file states; write "
                                         "the offsets with G90",
                                         text_of(word), name));
    value.value += place->value;
    place = std::move(value);
    return {};
}

core::Result<void> OffsetBlocks::take_origin(const OffsetEntry& entry, ControlOrigin& origin,
                                             const std::string& name) {
    for (size_t axis = 0; axis < core::axis_count; ++axis) {
        const char letter = core::axis_letters[axis];
        const OffsetWord* word = entry.word(letter);
        if (!word) continue;
        ControlValue value = gcode::is_rotary(axis)
                                 ? store_.angle(written(*word, true), word->where.line)
                                 : length_of(*word);
        if (auto done =
                put(origin.axes[axis], std::move(value), *word, fmt::format("{} {}", name, letter));
            !done)
            return done;
    }
    if (const OffsetWord* word = entry.word('R'))
        return put(origin.rotation_deg, store_.angle(word->number.value, word->where.line), *word,
                   name + " R");
    return {};
}

core::Result<void> OffsetBlocks::take_work_offset(const OffsetEntry& entry, bool is_extended) {
    if (is_extended && !gcode::dialect(store_.reading.dialect).has_extended_offsets)
        return refused(*entry.code, "G10 L20 depends on where the machine was; write the offsets "
                                    "with G10 L2");
    constexpr auto most = static_cast<int>(gcode::extended_offset_count);
    constexpr auto plain = static_cast<int>(gcode::plain_offset_count);
    FEELER_TRY(const int number,
               whole(entry, 'P', is_extended ? 1 : 0, is_extended ? most : plain));
    if (number == 0) return take_origin(entry, store_.offsets.external, "external offset");
    const auto index = static_cast<size_t>(number - 1 + (is_extended ? plain : 0));
    return take_origin(entry, store_.offsets.work[index], gcode::name_of_offset(index));
}

core::Result<void> OffsetBlocks::take_tool_offset(const OffsetEntry& entry, int kind) {
    FEELER_TRY(const int number, whole(entry, 'P', 1, highest_tool_offset));
    FEELER_TRY(const OffsetWord* value, needed(entry, 'R'));
    ControlToolOffset& tool = store_.offsets.tools[core::OffsetNumber{number}];
    const double size = store_.reading.sizes_are_radii ? 2.0 : 1.0;
    has_geometry_ = has_geometry_ || kind == 10;
    switch (kind) {
    case 10:
        return put(tool.length, length_of(*value), *value, fmt::format("H{}", number));
    case 11:
        return put(tool.wear, length_of(*value), *value, fmt::format("the wear of H{}", number));
    case 12:
        return put(tool.diameter, length_of(*value, size), *value, fmt::format("D{}", number));
    default:
        return put(tool.diameter_wear, length_of(*value, size), *value,
                   fmt::format("the wear of D{}", number));
    }
}

/// Tool offset memory A: one value, which is a length under H and a size under D.
core::Result<void> OffsetBlocks::take_single_offset(const OffsetEntry& entry) {
    FEELER_TRY(const int number, whole(entry, 'P', 1, highest_tool_offset));
    const OffsetWord& value = *entry.word('R');
    is_single_ = has_geometry_ = true;
    return put(store_.offsets.tools[core::OffsetNumber{number}].length, length_of(value), value,
               fmt::format("H{}", number));
}

/// LinuxCNC: G10 L1 writes lines of the tool table.
core::Result<void> OffsetBlocks::take_tool_entry(const OffsetEntry& entry) {
    FEELER_TRY(const int number, whole(entry, 'P', 1, 99999));
    ControlToolOffset& tool = store_.offsets.tools[core::OffsetNumber{number}];
    has_geometry_ = true;
    if (const OffsetWord* z = entry.word('Z'))
        if (auto done = put(tool.length, length_of(*z), *z, fmt::format("H{}", number)); !done)
            return done;
    if (const OffsetWord* r = entry.word('R'))
        return put(tool.diameter, length_of(*r, 2.0), *r, fmt::format("D{}", number));
    return {};
}

void OffsetBlocks::leave_out(const OffsetWord& code, const std::string& what) {
    auto& [line, count] = left_out_[what];
    if (count++ == 0) line = code.where.line;
}

core::Result<void> OffsetBlocks::take_entry(const OffsetEntry& entry) {
    const gcode::Dialect& dialect = gcode::dialect(store_.reading.dialect);
    const OffsetWord* kind = entry.word('L');
    if (!kind && entry.word('P') && entry.word('R')) return take_single_offset(entry);
    if (!kind) return refused(*entry.code, "this G10 needs L, the kind of offset");
    const double number = kind->number.value;
    if (number == 2.0 || number == 20.0) return take_work_offset(entry, number == 20.0);
    if (number == 1.0 && dialect.tool_entries_by_axes) return take_tool_entry(entry);
    const bool is_tool = number == 10.0 || number == 11.0 || number == 12.0 || number == 13.0;
    if (is_tool && !dialect.tool_entries_by_axes)
        return take_tool_offset(entry, static_cast<int>(number));
    if (number == 1.0) return take_tool_offset(entry, 11);
    modes_.skips = number == 3.0 || number == 50.0 || number == 52.0;
    leave_out(*entry.code, "G10 " + text_of(*kind));
    return {};
}

/// The entries of a line; words before the first G10 are not among them.
core::Result<std::vector<OffsetEntry>> entries_of(const std::vector<OffsetWord>& words) {
    std::vector<OffsetEntry> entries;
    for (const OffsetWord& word : words) {
        if (is_code(word, 10.0)) {
            entries.push_back({&word});
        } else if (!entries.empty() && word.letter != 'G') {
            const OffsetWord*& place = entries.back().words[static_cast<size_t>(word.letter - 'A')];
            if (place) return refused(word, fmt::format("{} is there twice", word.letter));
            place = &word;
        }
    }
    return entries;
}

core::Result<void> OffsetBlocks::take_line(const std::string& text, uint32_t line) {
    const OffsetWords found = words_with_numbers(text, line);
    for (const OffsetWord& word : found.words) take_modes(word);
    if (modes_.skips) return {};
    // Lines of programs may hold anything else; one with offsets must be read to its end.
    if (found.end && has_offset_code(code_of(text))) return tl::unexpected(*found.end);
    FEELER_TRY(const std::vector<OffsetEntry> entries, entries_of(found.words));
    for (const OffsetEntry& entry : entries)
        if (auto taken = take_entry(entry); !taken) return taken;
    return {};
}

/// With tool offset memory A the control writes its only values with L11.
void take_wear_as_length(ControlOffsets& offsets) {
    for (auto& [number, tool] : offsets.tools)
        if (!tool.length) tool.length.swap(tool.wear);
}

void OffsetBlocks::finish() {
    const auto is_wear = [](const auto& entry) { return entry.second.wear.has_value(); };
    auto& tools = store_.offsets.tools;
    if (!has_geometry_ && std::any_of(tools.begin(), tools.end(), is_wear)) {
        take_wear_as_length(store_.offsets);
        is_single_ = true;
    }
    if (is_single_)
        store_.note(
            "holds one value for each tool offset (tool offset memory A), which is compared "
            "with lengths under H only");
    for (const auto& [what, place] : left_out_)
        store_.note(fmt::format("{} in line {}{} is not read", what, place.first,
                                place.second > 1
                                    ? fmt::format(" and {} more", counted(place.second - 1, "line"))
                                    : std::string()));
    if (unit_counted_)
        store_.note(fmt::format("has no G20 or G21 and is read in {}: if that is wrong, state "
                                "--machine-unit or unit under [program]",
                                store_.reading.unit == LengthUnit::inch ? "inches" : "mm"));
}

} // namespace

std::string code_of(std::string_view line) {
    std::string code;
    bool is_comment = false;
    for (const char c : line) {
        if (c == ';' && !is_comment) break;
        is_comment = is_comment || c == '(';
        if (!is_comment) code += core::upper(c);
        if (c == ')') is_comment = false;
    }
    return std::string(core::stripped(code));
}

bool has_offset_code(std::string_view code) {
    for (size_t at = code.find("G10"); at != std::string_view::npos;
         at = code.find("G10", at + 1)) {
        const char next = at + 3 < code.size() ? code[at + 3] : ' ';
        if (next != '.' && (next < '0' || next > '9')) return true;
    }
    return false;
}

core::Result<void> read_offset_blocks(const std::vector<std::string>& lines,
                                      const OffsetStore& store) {
    OffsetBlocks blocks(store);
    for (size_t i = 0; i < lines.size(); ++i)
        if (auto taken = blocks.take_line(lines[i], static_cast<uint32_t>(i + 1)); !taken)
            return tl::unexpected(core::in_file(std::move(taken).error(), store.path));
    blocks.finish();
    return {};
}

} // namespace app
