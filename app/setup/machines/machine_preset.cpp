#include "app/setup/machines/machine_preset.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/setup/machines/machine_data.h"
#include "app/setup/presets/preset_lists.h"
#include "core/base/text.h"

namespace app {
namespace {

using Unit = MachineUnit;

constexpr double farthest = 100000.0, fastest = 1000000.0; // mm, degrees; per minute, per s2

/// The sizes of a machine, in the order of lists.
class SizeList {
public:
    explicit SizeList(bool is_generic) : is_generic_(is_generic) {}

    /// A size from the source of the preset; empty if it does not have it.
    void add(std::string_view key, Unit unit, std::optional<double> value, double least,
             double greatest, std::string_view meaning) {
        sizes.push_back({key, unit, value, is_generic_ && value, least, greatest, meaning});
    }
    /// A length that is usual for such machines.
    void add_usual(std::string_view key, double value, std::string_view meaning) {
        sizes.push_back({key, Unit::mm, value, true, 0.0, 10000.0, meaning});
    }

    std::vector<MachineSize> sizes{};

private:
    bool is_generic_;
};

struct AxisKeys {
    std::string_view min, max, rapid, acceleration;
    std::string_view min_meaning, max_meaning, rapid_meaning, acceleration_meaning;
};

constexpr AxisKeys x_keys = {"x_min",
                             "x_max",
                             "rapid_x",
                             "acceleration_x",
                             "lower limit of X",
                             "upper limit of X",
                             "rapid speed of X",
                             "acceleration of X"};
constexpr AxisKeys y_keys = {"y_min",
                             "y_max",
                             "rapid_y",
                             "acceleration_y",
                             "lower limit of Y",
                             "upper limit of Y",
                             "rapid speed of Y",
                             "acceleration of Y"};
constexpr AxisKeys z_keys = {"z_min",
                             "z_max",
                             "rapid_z",
                             "acceleration_z",
                             "lower limit of Z",
                             "upper limit of Z",
                             "rapid speed of Z",
                             "acceleration of Z"};
constexpr AxisKeys tilt_keys = {"tilt_min",
                                "tilt_max",
                                "rapid_tilt",
                                "acceleration_tilt",
                                "lower limit of the axis that tilts",
                                "upper limit of the axis that tilts",
                                "rapid speed of the axis that tilts",
                                "acceleration of the axis that tilts"};
constexpr AxisKeys rotary_keys = {"rotary_min",
                                  "rotary_max",
                                  "rapid_rotary",
                                  "acceleration_rotary",
                                  "lower limit of the axis that turns",
                                  "upper limit of the axis that turns",
                                  "rapid speed of the axis that turns",
                                  "acceleration of the axis that turns"};

void add_axis(SizeList& list, const AxisKeys& keys, const AxisData& axis, bool is_rotary) {
    const bool is_limited = axis.min != axis.max;
    const auto limit = [&](double value) {
        return is_limited ? std::optional(value) : std::nullopt;
    };
    const Unit angle = is_rotary ? Unit::deg : Unit::mm;
    list.add(keys.min, angle, limit(axis.min), -farthest, farthest, keys.min_meaning);
    list.add(keys.max, angle, limit(axis.max), -farthest, farthest, keys.max_meaning);
    list.add(keys.rapid, is_rotary ? Unit::deg_per_minute : Unit::mm_per_minute, axis.rapid, 1.0,
             fastest, keys.rapid_meaning);
    list.add(keys.acceleration, is_rotary ? Unit::deg_per_second2 : Unit::mm_per_second2,
             axis.acceleration, 0.1, fastest, keys.acceleration_meaning);
}

/// Sizes of the spindle's nose and of the head above it, by the taper.
struct UsualHead {
    double nose_diameter, nose_length, head_width, head_depth, head_height;
};

UsualHead usual_head(const MachineData& machine) {
    if (machine.kind == MachineKind::router || machine.taper == "ROUTER") return {80, 150, 0, 0, 0};
    if (machine.kind == MachineKind::bench_mill) return {110, 80, 200, 250, 300};
    if (machine.kind == MachineKind::knee_mill) return {100, 80, 300, 300, 400};
    return {130, 100, 320, 400, 500};
}

/// Whether the spindle does not tilt, so that a head above it is simple.
bool has_head(const MachineData& machine) {
    return machine.kind != MachineKind::head_table && machine.kind != MachineKind::head_head
           && usual_head(machine).head_width > 0.0;
}

void add_spindle(SizeList& list, const MachineData& machine) {
    const UsualHead usual = usual_head(machine);
    list.add_usual("nose_diameter", usual.nose_diameter, "diameter of the spindle's nose");
    list.add_usual("nose_length", usual.nose_length,
                   "length of the nose above the gauge line, up to the head");
    if (!has_head(machine)) return;
    list.add_usual("head_width", usual.head_width, "width of the head, and twice its front");
    if (machine.kind != MachineKind::horizontal)
        list.add_usual("head_depth", usual.head_depth, "from the spindle's axis back, in Y");
    list.add_usual("head_height", usual.head_height, "length of the head along the spindle");
}

void add_table(SizeList& list, const MachineData& machine) {
    const auto add = [&](std::string_view key, std::optional<double> value,
                         std::string_view meaning) {
        list.add(key, Unit::mm, value, 0.1, farthest, meaning);
    };
    const bool is_round = machine.rotary.letter == 'C' && machine.kind != MachineKind::head_head;
    if (machine.kind == MachineKind::horizontal)
        add("spindle_to_table", {}, "from the table up to the spindle's axis, with Y at y_min");
    else if (machine.kind != MachineKind::trunnion)
        add("nose_to_table", machine.nose_to_table,
            "from the table up to the gauge line, with Z at z_max");
    if (is_round) {
        add("table_diameter", machine.table_diameter, "diameter of the table that turns");
    } else {
        add("table_length", machine.table_length, "length of the table, along X");
        add("table_width", machine.table_width,
            machine.kind == MachineKind::horizontal ? "width of the table, along Z"
                                                    : "width of the table, along Y");
    }
    list.add_usual("table_thickness", 60, "thickness of the table");
}

void add_place(SizeList& list, std::string_view key, std::string_view meaning) {
    list.add(key, Unit::mm, {}, -farthest, farthest, meaning);
}

void add_rotary(SizeList& list, const MachineData& machine) {
    if (machine.tilt.letter != 0) add_axis(list, tilt_keys, machine.tilt.range, true);
    if (machine.rotary.letter == 0) return;
    add_axis(list, rotary_keys, machine.rotary.range, true);
    if (machine.kind == MachineKind::head_head || machine.kind == MachineKind::head_table)
        list.add("pivot_length", Unit::mm, {}, 0.0, farthest,
                 "from the gauge line up to the axis that tilts");
    if (machine.kind == MachineKind::head_head) return;
    add_place(list, "centre_x", "machine X of the axis that turns");
    if (machine.kind != MachineKind::horizontal)
        add_place(list, "centre_y", "machine Y of the axis that turns");
    if (machine.kind != MachineKind::head_table)
        add_place(list, "centre_z",
                  machine.kind == MachineKind::horizontal ? "machine Z of the axis that turns"
                                                          : "machine Z of the axis that tilts");
    if (machine.kind == MachineKind::trunnion)
        list.add("centre_to_table", Unit::mm, {}, -1000.0, 1000.0,
                 "from the axis that tilts down to the table");
}

MachinePreset preset_of(const MachineData& machine) {
    const bool is_generic = machine.name.starts_with("generic");
    SizeList list(is_generic);
    add_axis(list, x_keys, machine.x, false);
    add_axis(list, y_keys, machine.y, false);
    add_axis(list, z_keys, machine.z, false);
    add_rotary(list, machine);
    add_table(list, machine);
    add_spindle(list, machine);
    return {machine.name, machine.kind,         machine.title,       machine.source,
            machine.zero, machine.taper,        machine.tilt.letter, machine.rotary.letter,
            is_generic,   std::move(list.sizes)};
}

std::vector<MachinePreset> sorted_machines() {
    std::vector<MachinePreset> all;
    for (const MachineData& machine : machine_list()) all.push_back(preset_of(machine));
    std::sort(all.begin(), all.end(), [](const MachinePreset& a, const MachinePreset& b) {
        if (a.kind != b.kind) return a.kind < b.kind;
        if (a.is_generic != b.is_generic) return b.is_generic;
        return is_before_in_list(a.name, b.name);
    });
    return all;
}

} // namespace

std::string_view name_of(MachineKind kind) {
    constexpr std::string_view names[] = {"router",     "bench-mill", "knee-mill",  "vertical",
                                          "horizontal", "trunnion",   "head-table", "head-head"};
    return names[static_cast<size_t>(kind)];
}

std::string_view title_of(MachineKind kind) {
    constexpr std::string_view titles[] = {"Routers",
                                           "Bench mills",
                                           "Knee mills",
                                           "Vertical machining centres",
                                           "Horizontal machining centres",
                                           "Five axes, both turn the work",
                                           "Five axes, one tilts the tool and one turns the work",
                                           "Five axes, both turn the tool"};
    return titles[static_cast<size_t>(kind)];
}

std::string_view name_of(MachineUnit unit) {
    constexpr std::string_view names[] = {"mm", "mm/min", "mm/s2", "deg", "deg/min", "deg/s2"};
    return names[static_cast<size_t>(unit)];
}

bool is_angle(MachineUnit unit) { return unit >= MachineUnit::deg; }

const MachineSize* MachinePreset::size(std::string_view key) const {
    for (const MachineSize& each : sizes)
        if (each.key == key) return &each;
    return nullptr;
}

std::span<const MachinePreset> machine_presets() {
    static const std::vector<MachinePreset> all = sorted_machines();
    return all;
}

const MachinePreset* find_machine_preset(std::string_view name) {
    for (const MachinePreset& machine : machine_presets())
        if (machine.name == name) return &machine;
    return nullptr;
}

std::string unknown_machine_text(std::string_view name) {
    std::vector<std::string> names;
    for (const MachinePreset& machine : machine_presets()) names.emplace_back(machine.name);
    const std::string nearest = core::nearest_name(core::lower_case(name), names);
    const bool is_near = core::edit_distance(core::lower_case(name), nearest) * 2 <= name.size();
    return is_near ? fmt::format("there is no machine \"{}\"; did you mean \"{}\"? \"feeler "
                                 "presets\" lists all",
                                 name, nearest)
                   : fmt::format("there is no machine \"{}\": \"feeler presets\" lists all", name);
}

std::string range_text(const MachineSize& size) {
    return fmt::format("from {} to {} {}", core::number_text(size.least, 3),
                       core::number_text(size.greatest, 3), name_of(size.unit));
}

bool fits(const MachineSize& size, double value) {
    return value >= size.least && value <= size.greatest;
}

core::Result<void> check_machine_value(const MachinePreset& preset, std::string_view key,
                                       double value) {
    const MachineSize* const size = preset.size(key);
    if (!size) {
        std::vector<std::string> keys;
        for (const MachineSize& each : preset.sizes) keys.emplace_back(each.key);
        return unfit_sizes(fmt::format("{} has no size {}; did you mean {}?", preset.name, key,
                                       core::nearest_name(key, keys)));
    }
    if (fits(*size, value)) return {};
    return unfit_sizes(fmt::format("{} must be {}", key, range_text(*size)));
}

} // namespace app
