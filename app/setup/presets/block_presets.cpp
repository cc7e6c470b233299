#include "app/setup/presets/preset_lists.h"
#include "app/setup/presets/preset_solid.h"

namespace app {
namespace {

/// Frame: in the middle of the lower face.
core::Result<core::Mesh> block(const PresetSizes& size) {
    const double x = size["length"] / 2, y = size["width"] / 2;
    PresetSolid solid(2);
    solid.add(rectangle({-x, -y}, {x, y}), 0.0, size["height"]);
    return solid.mesh();
}

core::Result<core::Mesh> step_block(const PresetSizes& size) {
    const double half = size["width"] / 2, length = size["step_length"];
    PresetSolid solid(2);
    for (int step = 0; step < size.count("steps"); ++step)
        solid.add(rectangle({step * length, -half}, {(step + 1) * length, half}), 0.0,
                  size["first_height"] + step * size["step_height"]);
    return solid.mesh();
}

constexpr std::string_view block_origin =
    "In the middle of the lower face. X along its length, Z up.";

Preset block_preset(std::string_view name, std::string_view title, std::string_view source,
                    double length, double width, double height) {
    return {name,
            PresetKind::block,
            title,
            source,
            block_origin,
            {
                {"length", length, 0.5, 2000, "length, along X"},
                {"width", width, 0.5, 2000, "width, along Y"},
                {"height", height, 0.5, 2000, "height, along Z"},
            },
            block};
}

constexpr std::string_view inch_block_source =
    "Sizes: 1, 2 and 3 inch, or twice as much, as Wiktionary has them under \"1-2-3 block\". Its "
    "holes are left out.";

} // namespace

std::vector<Preset> block_presets() {
    return {
        block_preset("1-2-3-block", "1-2-3 block", inch_block_source, 76.2, 50.8, 25.4),
        block_preset("2-4-6-block", "2-4-6 block", inch_block_source, 152.4, 101.6, 50.8),
        block_preset("parallel", "Parallel", "All sizes are typical: measure yours.", 150, 6, 30),
        {"step-block",
         PresetKind::block,
         "Step block",
         "All sizes are typical: measure yours.",
         "Under the outer edge of the lowest step, in the middle of the width. X towards the "
         "highest step, Z up.",
         {
             {"steps", 5, 1, 40, "number of steps", PresetMeasure::count},
             {"first_height", 12, 0.5, 500, "height of the lowest step"},
             {"step_height", 8, 0.5, 100, "height from step to step"},
             {"step_length", 12, 0.5, 200, "length of a step"},
             {"width", 30, 1, 500, "width of the block"},
         },
         step_block},
    };
}

} // namespace app
