#include <fmt/format.h>

#include "app/prompt/command_table.h"
#include "app/prompt/location.h"
#include "app/prompt/place_text.h"

namespace app {
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
    for (const NamedValue& value : axis_values(state.session.place().control))
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
