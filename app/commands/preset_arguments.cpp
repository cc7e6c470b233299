#include "app/commands/preset_arguments.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/base/text.h"
#include "app/setup/holders/holder_preset.h"
#include "app/setup/machines/machine_preset.h"
#include "core/base/text.h"

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

/// A key and its value.
struct Assignment {
    std::string key;
    double value;
};

/// Reads `KEY=VALUE`. `example`: one for the message.
core::Result<Assignment> assignment_in(const std::string& text, const std::string& example) {
    const size_t equals = text.find('=');
    const auto value =
        equals == std::string::npos ? std::nullopt : number_in(trimmed(text.substr(equals + 1)));
    if (value) return Assignment{trimmed(text.substr(0, equals)), *value};
    return core::fail(
        core::ErrorCode::invalid_value,
        fmt::format("\"{}\" is not a size: write KEY=VALUE, with the value in mm, such "
                    "as {}",
                    text, example));
}

core::Result<void> add(const Assignment& size, PresetValues& values) {
    if (values.emplace(size.key, size.value).second) return {};
    return core::fail(core::ErrorCode::invalid_value, size.key + " is given twice");
}

/// A sentence for a name that nothing has.
std::string unknown_name_text(const std::string& name) {
    if (find_machine_preset(name)) return name + " is a machine, which is not a single body";
    const auto begins_so = [&](const HolderTaper& taper) {
        return core::upper_case(name).starts_with(std::string(taper.name) + "-");
    };
    const auto tapers = holder_tapers();
    if (std::any_of(tapers.begin(), tapers.end(), begins_so))
        return holder_named(name).error().message;
    std::vector<std::string> machines;
    for (const MachinePreset& machine : machine_presets()) machines.emplace_back(machine.name);
    const std::string nearest = core::nearest_name(name, machines);
    const bool is_near = core::edit_distance(name, nearest) * 3 <= name.size();
    return is_near ? unknown_machine_text(name) : unknown_preset_text(name);
}

} // namespace

core::Result<ChosenPreset> named_preset(const std::string& name) {
    if (const Preset* preset = find_preset(name)) return ChosenPreset{preset, {}};
    if (auto holder = holder_named(name))
        return ChosenPreset{&holder->holder->preset, std::move(holder->values)};
    return core::fail(core::ErrorCode::invalid_value, unknown_name_text(name));
}

core::Result<PresetValues> preset_values(const Preset& preset,
                                         const std::vector<std::string>& assignments) {
    PresetValues values;
    const PresetParameter& first = preset.parameters[0];
    for (const std::string& text : assignments) {
        FEELER_TRY(const Assignment size,
                   assignment_in(text, fmt::format("{}={}", first.key, first.standard)));
        if (const auto valid = check_preset_value(preset, size.key, size.value); !valid)
            return tl::unexpected(valid.error());
        if (const auto added = add(size, values); !added) return tl::unexpected(added.error());
    }
    return values;
}

core::Result<PresetValues> machine_values(const MachinePreset& machine,
                                          const std::vector<std::string>& assignments) {
    PresetValues values;
    for (const std::string& text : assignments) {
        FEELER_TRY(const Assignment size, assignment_in(text, "x_min=-500"));
        if (const auto valid = check_machine_value(machine, size.key, size.value); !valid)
            return tl::unexpected(valid.error());
        if (const auto added = add(size, values); !added) return tl::unexpected(added.error());
    }
    return values;
}

core::Result<ChosenPreset> preset_argument(const std::string& argument) {
    std::vector<std::string> pieces = pieces_of(argument);
    FEELER_TRY(ChosenPreset chosen, named_preset(pieces[0]));
    pieces.erase(pieces.begin());
    FEELER_TRY(const PresetValues values, preset_values(*chosen.preset, pieces));
    for (const auto& [key, value] : values)
        if (const auto added = add({key, value}, chosen.values); !added)
            return tl::unexpected(added.error());
    return chosen;
}

} // namespace app
