#include "app/commands/preset_arguments.h"

#include <fmt/format.h>

#include "app/base/text.h"

namespace app {
namespace {

/// The pieces of a text between commas.
std::vector<std::string> pieces_of(const std::string& text) {
    std::vector<std::string> pieces;
    size_t begin = 0;
    while (true) {
        const size_t comma = text.find(',', begin);
        pieces.push_back(text.substr(begin, comma - begin));
        if (comma == std::string::npos) return pieces;
        begin = comma + 1;
    }
}

} // namespace

core::Result<const Preset*> named_preset(const std::string& name) {
    if (const Preset* preset = find_preset(name)) return preset;
    return core::fail(core::ErrorCode::invalid_value, unknown_preset_text(name));
}

core::Result<PresetValues> preset_values(const Preset& preset,
                                         const std::vector<std::string>& assignments) {
    PresetValues values;
    for (const std::string& assignment : assignments) {
        const size_t equals = assignment.find('=');
        const std::string key = trimmed(assignment.substr(0, equals));
        const auto value = equals == std::string::npos
                               ? std::nullopt
                               : number_in(trimmed(assignment.substr(equals + 1)));
        if (!value)
            return core::fail(
                core::ErrorCode::invalid_value,
                fmt::format("\"{}\" is not a size: write KEY=VALUE, with the value in "
                            "mm, such as {}={}",
                            assignment, preset.parameters[0].key, preset.parameters[0].standard));
        if (const auto valid = check_preset_value(preset, key, *value); !valid)
            return tl::unexpected(valid.error());
        if (!values.emplace(key, *value).second)
            return core::fail(core::ErrorCode::invalid_value, key + " is given twice");
    }
    return values;
}

core::Result<ChosenPreset> preset_argument(const std::string& argument) {
    std::vector<std::string> pieces = pieces_of(argument);
    FEELER_TRY(const Preset* preset, named_preset(pieces[0]));
    pieces.erase(pieces.begin());
    FEELER_TRY(PresetValues values, preset_values(*preset, pieces));
    return ChosenPreset{preset, std::move(values)};
}

} // namespace app
