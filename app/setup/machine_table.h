#pragma once

#include <optional>
#include <string>
#include <vector>

#include <toml++/toml.h>

namespace app {

class TableReader;

/// A machine of a preset.
struct PresetMachine {
    toml::table machine;            // as a machine file states it, mm
    std::string others;             // letters of axes that it has and that the file leaves out
    std::vector<std::string> notes; // what is assumed or left out, as clauses
};

/// Reads `preset` of `[machine]` with its sizes. Empty without it, and after an error.
std::optional<PresetMachine> read_machine_preset(TableReader& table);

} // namespace app
