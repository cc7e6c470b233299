#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "app/check/check_run.h"
#include "app/debug/inspected_value.h"
#include "app/debug/prompt/command_table.h"
#include "app/debug/prompt/location.h"
#include "app/debug/prompt/state_text.h"
#include "core/base/text.h"
#include "gcode/language/modal_state.h"

namespace app {
namespace {

using core::ErrorCode;

core::Result<double> value_in(const std::string& text) {
    double value = 0.0;
    const size_t plus = !text.empty() && text[0] == '+' ? 1 : 0;
    const char* end = text.data() + text.size();
    const auto read = std::from_chars(text.data() + plus, end, value, std::chars_format::fixed);
    if (text.size() <= plus || read.ec != std::errc() || read.ptr != end || !std::isfinite(value))
        return core::fail(ErrorCode::invalid_value,
                          text.empty() ? "the value is missing"
                                       : fmt::format("'{}' is not a number", text));
    return value;
}

core::Result<int32_t> number_after(char letter, const std::string& text) {
    const bool lettered = !text.empty() && core::lower_case(text.substr(0, 1))[0] == letter;
    FEELER_TRY(const size_t number, number_in(text.substr(lettered ? 1 : 0)));
    if (number > 99999999)
        return core::fail(ErrorCode::invalid_value, fmt::format("'{}' is too large", text));
    return static_cast<int32_t>(number);
}

/// Parses `tool 3 length 95` or `T3 95`.
core::Result<WhatIf> tool_change(std::vector<std::string> words) {
    if (words[0] == "tool") words.erase(words.begin());
    if (words.size() == 3 && words[1] == "length") words.erase(words.begin() + 1);
    if (words.size() != 2) return core::fail(ErrorCode::syntax, "write set tool 3 length 95");
    FEELER_TRY(const int32_t number, number_after('t', words[0]));
    FEELER_TRY(const double length, value_in(words[1]));
    return WhatIf(app::ToolLengthChange{core::ToolNumber(number), length});
}

core::Result<WhatIf> length_change(const std::vector<std::string>& words) {
    if (words.size() != 2) return core::fail(ErrorCode::syntax, "write set H3 95");
    FEELER_TRY(const int32_t number, number_after('h', words[0]));
    FEELER_TRY(const double length, value_in(words[1]));
    return WhatIf(LengthOffsetOverride{core::OffsetNumber(number), length});
}

/// Parses `G54.x -350`.
core::Result<WhatIf> offset_change(const std::vector<std::string>& words) {
    const std::string name = core::upper_case(words[0]);
    const size_t dot = name.rfind('.');
    const size_t axis =
        dot == std::string::npos || dot + 2 != name.size()
            ? gcode::axis_count
            : std::string_view(gcode::axis_letters.data(), gcode::axis_count).find(name.back());
    const auto index = dot == std::string::npos ? std::nullopt : offset_named(name.substr(0, dot));
    if (words.size() != 2 || !index || axis >= gcode::axis_count)
        return core::fail(ErrorCode::syntax, "write set G54.x -350");
    FEELER_TRY(const double origin, value_in(words[1]));
    return WhatIf(WorkOffsetChange{*index, axis, origin});
}

core::Result<WhatIf> allowance_change(const std::vector<std::string>& words) {
    if (words.size() != 2)
        return core::fail(ErrorCode::syntax, "write set allowance 1, or set allowance default");
    if (words[1] == "default") return WhatIf(AllowanceChange{});
    FEELER_TRY(const double distance, value_in(words[1]));
    return WhatIf(AllowanceChange{distance});
}

/// The name without the quotes around it, if there are any.
std::string unquoted(const std::string& name) {
    const bool is_quoted =
        name.size() >= 2 && (name[0] == '"' || name[0] == '\'') && name.back() == name.front();
    return is_quoted ? name.substr(1, name.size() - 2) : name;
}

/// Parses `fixture clamp-1 by 0,10,0`; the name may contain blanks and be in quotes.
core::Result<WhatIf> fixture_change(const std::string& arguments) {
    const std::string text = split_word(arguments).second;
    const size_t by = text.rfind(" by ");
    MovedFixture moved;
    size_t axis = 0;
    if (by != std::string::npos) {
        std::string numbers = text.substr(by + 4);
        for (char& c : numbers)
            if (c == ',') c = ' ';
        for (const std::string& word : app::words_of(numbers)) {
            FEELER_TRY(const double value, value_in(word));
            if (axis < 3) moved.by[static_cast<int>(axis)] = value;
            ++axis;
        }
        moved.name = split_word(text.substr(0, by)).second.empty()
                         ? split_word(text.substr(0, by)).first
                         : text.substr(0, by);
    }
    moved.name = unquoted(moved.name);
    if (axis != 3)
        return core::fail(ErrorCode::syntax,
                          "write set fixture NAME by X,Y,Z, as in set fixture clamp-1 by 0,10,0");
    return WhatIf(std::move(moved));
}

core::Result<WhatIf> change_in(const std::string& arguments) {
    std::vector<std::string> words = app::words_of(arguments);
    std::erase(words, "="); // set H3 = 95
    std::erase(words, "to");
    if (words.empty())
        return core::fail(ErrorCode::syntax,
                          "set what? tool 3 length 95, H3 95, G54.x -350, allowance 1, or "
                          "fixture clamp-1 by 0,10,0");
    const std::string first = core::lower_case(words[0]);
    if (first == "fixture") return fixture_change(arguments);
    if (first == "allowance") return allowance_change(words);
    if (first == "tool" || first[0] == 't') return tool_change(std::move(words));
    if (first[0] == 'h') return length_change(words);
    if (first[0] == 'g') return offset_change(words);
    return core::fail(
        ErrorCode::syntax,
        fmt::format("'{}' cannot be set; tool, H3, G54.x, allowance and fixture can", words[0]));
}

} // namespace

std::vector<std::string> set_topics() { return {"allowance", "fixture", "tool", "G54.x", "H1"}; }

CommandResult change_something(PromptState& state, const std::string& arguments) {
    FEELER_TRY(const WhatIf change, change_in(arguments));
    if (auto done = state.session.change(change); !done) return tl::unexpected(done.error());
    return fmt::format("from here on, {}\n", text_of(change)) + location_text(state);
}

CommandResult take_back(PromptState& state, const std::string&) {
    const auto& changes = state.session.changes();
    const std::string what = changes.empty() ? std::string() : text_of(changes.back().change);
    if (auto done = state.session.take_back(); !done) return tl::unexpected(done.error());
    return fmt::format("undone: {}\n", what) + location_text(state);
}

namespace {

std::string text_of(const InspectedValue& value) {
    return value.meaning.empty() ? value.text : fmt::format("{} ({})", value.text, value.meaning);
}

} // namespace

CommandResult print_value(PromptState& state, const std::string& arguments) {
    if (!arguments.empty()) {
        FEELER_TRY(const InspectedValue value, value_here(state, arguments));
        return fmt::format("{} = {}\n", arguments, text_of(value));
    }
    std::string text;
    for (const NamedValue& value : axis_values(state.session.control()))
        text += fmt::format("{:<12} {}\n", value.name, text_of(value.value));
    return text;
}

CommandResult display_value(PromptState& state, const std::string& arguments) {
    if (arguments.empty()) return show_displays(state, arguments);
    FEELER_TRY(const InspectedValue value, value_here(state, arguments));
    state.displays.push_back({++state.last_display, arguments});
    return fmt::format("    {}: {} = {}\n", state.last_display, arguments, value.text);
}

CommandResult undisplay_value(PromptState& state, const std::string& arguments) {
    if (arguments.empty()) {
        state.displays.clear();
        return std::string();
    }
    FEELER_TRY(const size_t id, number_in(arguments));
    const size_t gone = std::erase_if(
        state.displays, [&](const Display& display) { return display.id == static_cast<int>(id); });
    if (gone > 0) return std::string();
    return core::fail(core::ErrorCode::invalid_value, fmt::format("there is no display {}", id));
}

CommandResult show_displays(PromptState& state, const std::string&) {
    const std::string text = displays_text(state);
    return text.empty() ? "nothing is displayed; 'display z' shows Z at every stop\n" : text;
}

} // namespace app
