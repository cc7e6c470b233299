#include <algorithm>
#include <cmath>

#include "app/setup/presets/preset_lists.h"
#include "app/setup/presets/preset_solid.h"

namespace app {
namespace {

/// How many holes or slots `pitch` apart have room, with half a pitch to either end.
int count_along(double length, double pitch) {
    return std::max(1, static_cast<int>(std::floor(length / pitch)));
}

/// The middle of one of several holes or slots, which lie around 0.
double middle_of(int index, int count, double pitch) { return (index - (count - 1) / 2.0) * pitch; }

core::Result<core::Mesh> fixture_plate(const PresetSizes& size) {
    constexpr int most_holes = 240;
    const double length = size["length"], width = size["width"], pitch = size["hole_pitch"];
    const double hole = size["hole_diameter"];
    PresetSolid solid(2);
    solid.add(rectangle({-length / 2, -width / 2}, {length / 2, width / 2}), -size["thickness"],
              0.0);
    if (hole == 0.0) return solid.mesh();
    const int along = count_along(length, pitch), across = count_along(width, pitch);
    if (along > most_holes || across > most_holes || along * across > most_holes)
        return unfit_sizes("hole_pitch gives more than 240 holes: make it larger, or set "
                           "hole_diameter to 0");
    if (!(hole < std::min({pitch, length, width})))
        return unfit_sizes("hole_diameter must be less than hole_pitch, length and width");
    for (int x = 0; x < along; ++x)
        for (int y = 0; y < across; ++y)
            solid.cut(
                within_circle({middle_of(x, along, pitch), middle_of(y, across, pitch)}, hole / 2),
                -size["thickness"], 0.0);
    return solid.mesh();
}

core::Result<core::Mesh> slot_table(const PresetSizes& size) {
    const double half_width = size["width"] / 2, half_length = size["length"] / 2;
    const double throat = size["slot_width"] / 2, head = size["head_width"] / 2;
    const double depth = size["slot_depth"], head_depth = size["head_depth"];
    const int slots = size.count("slots");
    if (!(depth < size["thickness"])) return unfit_sizes("slot_depth must be less than thickness");
    if (!(head_depth < depth)) return unfit_sizes("head_depth must be less than slot_depth");
    if (!(throat < head)) return unfit_sizes("slot_width must be less than head_width");
    if (!(2 * head < size["slot_pitch"] || slots < 2))
        return unfit_sizes("head_width must be less than slot_pitch");
    if (!((slots - 1) * size["slot_pitch"] / 2 + head < half_width || slots == 0))
        return unfit_sizes("the slots are wider than the table: slots, slot_pitch, head_width and "
                           "width do not agree");
    // The plan is YZ.
    PresetSolid solid(0);
    solid.add(rectangle({-half_width, -size["thickness"]}, {half_width, 0.0}), -half_length,
              half_length);
    for (int slot = 0; slot < slots; ++slot) {
        const double y = middle_of(slot, slots, size["slot_pitch"]);
        solid.cut(rectangle({y - throat, -depth}, {y + throat, 0.0}), -half_length, half_length);
        solid.cut(rectangle({y - head, -depth}, {y + head, head_depth - depth}), -half_length,
                  half_length);
    }
    return solid.mesh();
}

core::Result<core::Mesh> tombstone(const PresetSizes& size) {
    const double base_x = size["base_length"] / 2, base_y = size["base_width"] / 2;
    const double x = size["column_length"] / 2, y = size["column_width"] / 2;
    PresetSolid solid(2);
    solid.add(rectangle({-base_x, -base_y}, {base_x, base_y}), 0.0, size["base_height"]);
    solid.add(rectangle({-x, -y}, {x, y}), 0.0, size["base_height"] + size["column_height"]);
    return solid.mesh();
}

struct SlotSizes {
    std::string_view name, title;
    double width, head_width, head_depth, depth, pitch;
};

/// The least sizes that BS 2485 allows, so that the table contains each table of this size.
constexpr SlotSizes slot_sizes[] = {
    {"t-slot-table-12", "Table with T-slots of 12 mm, for M10", 12, 19, 8, 20, 50},
    {"t-slot-table-14", "Table with T-slots of 14 mm, for M12", 14, 23, 9, 23, 63},
    {"t-slot-table-18", "Table with T-slots of 18 mm, for M16", 18, 30, 12, 30, 80},
};

Preset table_preset(const SlotSizes& slot) {
    return {slot.name,
            PresetKind::plate,
            slot.title,
            "Slots: the least sizes of BS 2485, and one of its pitches, from Engineers Edge, "
            "\"T-Slot Profile Design per BS 2485\". Table and number of slots are typical.",
            "In the middle of the top face. X along the slots, Z up.",
            {
                {"length", 600, 10, 10000, "length, along X"},
                {"width", 250, 10, 5000, "width, along Y"},
                {"thickness", 60, 2, 1000, "thickness"},
                {"slots", 3, 0, 50, "number of slots", PresetMeasure::count},
                {"slot_pitch", slot.pitch, 5, 1000, "distance from slot to slot"},
                {"slot_width", slot.width, 1, 100, "width of the throat"},
                {"slot_depth", slot.depth, 1, 500, "depth of the whole slot"},
                {"head_width", slot.head_width, 2, 200, "width of the wide part below the throat"},
                {"head_depth", slot.head_depth, 0.5, 200, "height of that part"},
            },
            slot_table};
}

Preset plate_preset() {
    return {"fixture-plate",
            PresetKind::plate,
            "Fixture plate with a grid of through holes",
            "All sizes are typical: measure yours.",
            "In the middle of the top face. X along its length, Z up.",
            {
                {"length", 300, 10, 5000, "length, along X"},
                {"width", 200, 10, 5000, "width, along Y"},
                {"thickness", 25, 1, 500, "thickness"},
                {"hole_pitch", 50, 5, 1000,
                 "distance from hole to hole; at least half of it remains to each edge"},
                {"hole_diameter", 12, 0, 500, "diameter of the holes; 0 for none"},
            },
            fixture_plate};
}

Preset tombstone_preset() {
    return {"tombstone",
            PresetKind::plate,
            "Tombstone: a column on a base",
            "All sizes are typical: measure yours. Its holes are left out.",
            "In the middle of the underside. Z up.",
            {
                {"base_length", 400, 10, 3000, "length of the base, along X"},
                {"base_width", 400, 10, 3000, "width of the base, along Y"},
                {"base_height", 40, 1, 1000, "height of the base"},
                {"column_length", 200, 5, 3000, "size of the column along X"},
                {"column_width", 200, 5, 3000, "size of the column along Y"},
                {"column_height", 400, 5, 3000, "height of the column above the base"},
            },
            tombstone};
}

} // namespace

std::vector<Preset> plate_presets() {
    std::vector<Preset> all{plate_preset(), tombstone_preset()};
    for (const SlotSizes& slot : slot_sizes) all.push_back(table_preset(slot));
    return all;
}

} // namespace app
