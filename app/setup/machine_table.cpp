#include "app/setup/machine_table.h"

#include <fmt/format.h>

#include "app/setup/machines/machine_preset.h"
#include "app/setup/table_reader.h"
#include "app/setup/toml_file.h"

namespace app {
namespace {

/// The range of a size in the unit of the file, for a message.
std::string shown_range(const TableReader& table, const MachineSize& size) {
    if (size.unit != MachineUnit::mm) return range_text(size);
    return fmt::format("between {} and {}", table.shown(size.least), table.shown(size.greatest));
}

/// The sizes that the table states.
PresetValues read_sizes(TableReader& table, const MachinePreset& preset) {
    PresetValues values;
    for (const MachineSize& size : preset.sizes) {
        const std::string key(size.key);
        const auto value =
            table.number(key.c_str(), is_angle(size.unit) ? Measure::angle : Measure::length);
        if (!value) continue;
        if (!fits(size, *value)) table.refuse(key.c_str(), "must be " + shown_range(table, size));
        values.emplace(key, *value);
    }
    return values;
}

} // namespace

std::optional<PresetMachine> read_machine_preset(TableReader& table) {
    const auto name = table.string("preset");
    if (!name) return std::nullopt;
    const auto refuse = [&](const std::string& why) {
        table.refuse("preset", fmt::format("= \"{}\": {}", *name, why));
        return std::nullopt;
    };
    if (table.has("file")) {
        table.refuse("preset", "cannot be combined with file");
        return std::nullopt;
    }
    const MachinePreset* const preset = find_machine_preset(*name);
    if (!preset) return refuse(unknown_machine_text(*name));
    const PresetValues values = read_sizes(table, *preset);
    auto made = machine_text(*preset, values);
    if (!made) return refuse(made.error().message);
    auto parsed = parsed_toml(made->toml);
    if (!parsed) return refuse(parsed.error().message);
    return PresetMachine{*std::move(parsed), std::move(made->others), std::move(made->notes)};
}

} // namespace app
