#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "app/setup/machines/machine_preset.h"

namespace app {

/// The range of an axis, its rapid speed and its acceleration: mm or degrees, per minute, per s2.
struct AxisData {
    double min = 0.0, max = 0.0;
    std::optional<double> rapid{}, acceleration{};
};

/// A rotary axis; without limits if they are equal.
struct RotaryData {
    char letter = 0; // 0: there is none
    AxisData range{};
};

/// What is known of a machine. mm.
struct MachineData {
    std::string_view name;
    MachineKind kind;
    std::string_view title, taper, source, zero;
    AxisData x, y, z;
    std::optional<double> nose_to_table{}, table_length{}, table_width{};
    RotaryData tilt{}, rotary{};
    std::optional<double> table_diameter{};
};

/// All machines, in any order.
std::vector<MachineData> machine_list();

} // namespace app
