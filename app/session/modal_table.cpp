#include "app/session/modal_table.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "app/session/value_text.h"
#include "gcode/dialect.h"

namespace app {
namespace {

using gcode::Dialect;
using State = gcode::InterpreterState;

/// A code with what it means; Klartext has no codes.
InspectedValue code(const Dialect& dialect, std::string text, std::string meaning) {
    if (dialect.language == gcode::Language::klartext) return {std::nullopt, std::move(meaning)};
    return {std::nullopt, std::move(text), std::move(meaning)};
}

std::string code_text(int tenths) {
    return tenths % 10 == 0 ? fmt::format("G{}", tenths / 10)
                            : fmt::format("G{}.{}", tenths / 10, tenths % 10);
}

InspectedValue motion(const State& state, const Dialect& dialect) {
    if (state.modal.cycle) return code(dialect, code_text(state.modal.cycle->code), "cycle");
    if (!state.modal.motion) return {std::nullopt, "none"};
    const int tenths = *state.modal.motion;
    const char* meaning = tenths == 0    ? "rapid"
                          : tenths == 10 ? "feed"
                          : tenths == 20 ? "arc clockwise"
                          : tenths == 30 ? "arc counterclockwise"
                                         : "special";
    return code(dialect, code_text(tenths), meaning);
}

InspectedValue plane(const State& state, const Dialect& dialect) {
    constexpr const char* codes[] = {"G17", "G18", "G19", "G17.1", "G18.1", "G19.1"};
    constexpr const char* names[] = {"XY", "ZX", "YZ", "UV", "WU", "VW"};
    const auto index = static_cast<size_t>(state.modal.plane);
    return code(dialect, codes[index], names[index]);
}

InspectedValue unit(const State& state, const Dialect& dialect) {
    const bool inch = state.modal.unit == gcode::LengthUnit::inch;
    if (dialect.language != gcode::Language::siemens)
        return code(dialect, inch ? "G20" : "G21", inch ? "inch" : "mm");
    const bool feeds_as_well = state.siemens->feeds_in_inches;
    return code(dialect, inch ? (feeds_as_well ? "G700" : "G70") : "G71", inch ? "inch" : "mm");
}

InspectedValue distance(const State& state, const Dialect& dialect) {
    const bool absolute = state.modal.distance == gcode::DistanceMode::absolute;
    return code(dialect, absolute ? "G90" : "G91", absolute ? "absolute" : "incremental");
}

const char* unit_of_feed(const State& state) {
    switch (state.modal.feed_mode) {
    case gcode::FeedMode::per_minute:
        return "mm/min";
    case gcode::FeedMode::per_turn:
        return "mm/rev";
    default:
        return "1/min";
    }
}

InspectedValue feed_mode(const State& state, const Dialect& dialect) {
    constexpr const char* codes[] = {"G94", "G93", "G95"};
    return code(dialect, codes[static_cast<size_t>(state.modal.feed_mode)], unit_of_feed(state));
}

InspectedValue feed(const State& state, const Dialect&) {
    if (!state.modal.feed) return {std::nullopt, "none"};
    return quantity(state.modal.feed, unit_of_feed(state));
}

InspectedValue speed(const State& state, const Dialect&) {
    return quantity(state.modal.speed, state.modal.surface_speed ? "m/min" : "rev/min");
}

InspectedValue spindle(const State& state, const Dialect&) {
    switch (state.modal.spindle) {
    case core::SpindleDirection::stopped:
        return {std::nullopt, "M5", "stopped"};
    case core::SpindleDirection::clockwise:
        return {std::nullopt, "M3", "clockwise"};
    default:
        return {std::nullopt, "M4", "counterclockwise"};
    }
}

InspectedValue coolant(const State& state, const Dialect&) {
    if (state.modal.mist && state.modal.flood) return {std::nullopt, "M7 M8", "mist and flood"};
    if (state.modal.mist) return {std::nullopt, "M7", "mist"};
    if (state.modal.flood) return {std::nullopt, "M8", "flood"};
    return {std::nullopt, "M9", "off"};
}

InspectedValue number_of(char letter, std::optional<int> number) {
    if (!number) return {std::nullopt, "none"};
    return {*number, fmt::format("{}{}", letter, *number)};
}

std::optional<int> plain(const std::optional<core::ToolNumber>& number) {
    return number ? std::optional(core::value_of(*number)) : std::nullopt;
}

InspectedValue tool(const State& state, const Dialect&) {
    return number_of('T', plain(state.modal.tool));
}

InspectedValue selected_tool(const State& state, const Dialect&) {
    return number_of('T', plain(state.modal.selected_tool));
}

/// Along the axis that the length counts along.
InspectedValue length(const State& state, const Dialect& dialect) {
    const bool turns = !dialect.length_needs_g43;
    return quantity(
        state.modal.offsets.tool[turns ? gcode::axes_of(state.modal.plane).normal : size_t{2}],
        "mm");
}

InspectedValue length_number(const State& state, const Dialect& dialect) {
    const auto& number = state.modal.length_number;
    return number_of(dialect.length_needs_g43 ? 'H' : 'T',
                     number ? std::optional(core::value_of(*number)) : std::nullopt);
}

InspectedValue offset(const State& state, const Dialect&) {
    return {std::nullopt, offset_name(state.modal.offsets.active)};
}

InspectedValue path(const State& state, const Dialect& dialect) {
    constexpr const char* codes[] = {"G61", "G61.1", "G64"};
    constexpr const char* names[] = {"exact path", "exact stop", "continuous"};
    const auto index = static_cast<size_t>(state.modal.path);
    const bool siemens = dialect.language == gcode::Language::siemens && index < 2;
    return code(dialect, siemens ? "G60" : codes[index], names[index]);
}

InspectedValue compensation(const State& state, const Dialect& dialect) {
    constexpr const char* codes[] = {"G40", "G41", "G42"};
    constexpr const char* names[] = {"off", "left", "right"};
    const auto index = static_cast<size_t>(state.modal.compensation);
    return code(dialect, codes[index], names[index]);
}

InspectedValue retract(const State& state, const Dialect& dialect) {
    const bool initial = state.modal.retract == gcode::RetractMode::initial_level;
    const char* meaning = initial ? "to the initial level" : "to R";
    if (dialect.language != gcode::Language::words) return {std::nullopt, meaning};
    return code(dialect, initial ? "G98" : "G99", meaning);
}

/// What the program does to its own coordinates, in words.
InspectedValue transform(const State& state, const Dialect&) {
    const gcode::Offsets& offsets = state.modal.offsets;
    const core::Mat3& linear = offsets.frame.linear;
    std::string text;
    const auto add = [&](bool holds, const char* words) {
        if (holds) text += (text.empty() ? "" : ", ") + std::string(words);
    };
    const double volume = glm::determinant(linear);
    add(offsets.tilted_plane || offsets.frame.tilts_tool, "tilted plane");
    add(offsets.follows_tip, "follows the tip");
    add(offsets.has_frame && volume < 0.0, "mirrored");
    add(offsets.has_frame && std::abs(std::abs(volume) - 1.0) > 1e-9, "scaled");
    add(offsets.has_frame && std::abs(linear[0][1]) > 1e-12, "turned");
    if (text.empty()) text = offsets.has_frame ? "shifted" : "none";
    return {std::nullopt, text};
}

constexpr ModalKind numeric = ModalKind::number, word = ModalKind::word;

constexpr ModalEntry entries[] = {
    {"motion", word, "", motion},
    {"plane", word, "G17,G18,G19,G17.1,G18.1,G19.1,XY,ZX,YZ,UV,WU,VW", plane},
    {"unit", word, "G20,G21,G70,G71,G700,mm,inch", unit},
    {"distance", word, "G90,G91,absolute,incremental", distance},
    {"feed_mode", word, "G93,G94,G95,mm/min,mm/rev,1/min", feed_mode},
    {"feed", numeric, "", feed},
    {"speed", numeric, "", speed},
    {"spindle", word, "M3,M4,M5,clockwise,counterclockwise,stopped", spindle},
    {"coolant", word, "M7,M8,M9,M7 M8,mist,flood,off,mist and flood", coolant},
    {"tool", numeric, "", tool},
    {"selected_tool", numeric, "", selected_tool},
    {"length", numeric, "", length},
    {"length_number", numeric, "", length_number},
    {"offset", word, "", offset},
    {"compensation", word, "G40,G41,G42,off,left,right", compensation},
    {"path", word, "G60,G61,G61.1,G64,exact path,exact stop,continuous", path},
    {"retract", word, "G98,G99,to the initial level,to R", retract},
    {"transform", word, "", transform}};

/// The whole number that a text is; empty when it is none.
std::optional<size_t> whole(std::string_view text) {
    size_t number = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
    if (read.ec != std::errc() || read.ptr != text.data() + text.size()) return std::nullopt;
    return number;
}

} // namespace

std::span<const ModalEntry> modal_table() { return entries; }

const ModalEntry* modal_entry(std::string_view name) {
    for (const ModalEntry& entry : entries)
        if (entry.name == name) return &entry;
    return nullptr;
}

std::vector<std::string> words_of(const ModalEntry& entry) {
    std::vector<std::string> words;
    for (size_t begin = 0; begin < entry.words.size();) {
        const size_t end = std::min(entry.words.find(',', begin), entry.words.size());
        words.emplace_back(entry.words.substr(begin, end - begin));
        begin = end + 1;
    }
    return words;
}

std::string offset_name(size_t index) {
    if (index == gcode::no_work_offset) return "G500";
    if (index < 6) return fmt::format("G{}", 54 + index);
    if (index < gcode::plain_offset_count) return fmt::format("G59.{}", index - 5);
    return fmt::format("G54.1P{}", index - gcode::plain_offset_count + 1);
}

std::optional<size_t> offset_named(std::string_view name) {
    for (size_t index = 0; index < gcode::plain_offset_count; ++index)
        if (name == offset_name(index)) return index;
    constexpr std::string_view numbered = "G54.1P";
    if (!name.starts_with(numbered)) return std::nullopt;
    const auto number = whole(name.substr(numbered.size()));
    if (!number || *number < 1 || *number > gcode::extended_offset_count) return std::nullopt;
    return gcode::plain_offset_count + *number - 1;
}

} // namespace app
