#include "app/setup/presets/preset_lists.h"
#include "app/setup/presets/preset_solid.h"

namespace app {
namespace {

/// Frame: fixed jaw's face at Y 0, bed at Z 0, middle of the width at X 0.
core::Result<core::Mesh> vise(const PresetSizes& size) {
    const double opening = size["opening"], bed = -size["bed_height"];
    const double front = -size["front_length"], base_top = bed + size["base_height"];
    if (!(opening < -front))
        return unfit_sizes("opening must be less than front_length: the moving jaw leaves the bed");
    if (!(base_top < 0.0)) return unfit_sizes("base_height must be less than bed_height");
    if (!(size["screw_size"] < -bed)) return unfit_sizes("screw_size must be less than bed_height");
    // The plan is YZ.
    PresetSolid solid(0);
    const auto add = [&](double y_low, double z_low, double y_high, double z_high, double width) {
        solid.add(rectangle({y_low, z_low}, {y_high, z_high}), -width / 2, width / 2);
    };
    add(front, bed, size["rear_length"], base_top, size["base_width"]);
    add(front, bed, size["rear_length"], 0.0, size["bed_width"]);
    const double jaw = size["jaw_height"];
    add(0.0, 0.0, size["fixed_jaw_thickness"], jaw, size["jaw_width"]);
    add(-opening - size["moving_jaw_thickness"], 0.0, -opening, jaw, size["jaw_width"]);
    // The end of the screw, in the middle of the bed's front.
    const double screw = size["screw_size"] / 2;
    add(front - size["screw_length"], bed / 2 - screw, front, bed / 2 + screw, 2 * screw);
    return solid.mesh();
}

struct ViseSizes {
    double opening, greatest_opening, jaw_width, jaw_height, fixed_jaw, moving_jaw;
    double bed_width, bed_height, front, rear, base_width, base_height, screw;
};

std::vector<PresetParameter> vise_parameters(const ViseSizes& s) {
    return {
        {"opening", s.opening, 0.5, s.greatest_opening, "distance between the faces of the jaws"},
        {"jaw_width", s.jaw_width, 10, 600, "width of both jaws, along X"},
        {"jaw_height", s.jaw_height, 2, 300, "height of the jaws above the bed"},
        {"fixed_jaw_thickness", s.fixed_jaw, 2, 300, "fixed jaw, from its face to its back"},
        {"moving_jaw_thickness", s.moving_jaw, 2, 300, "moving jaw, from its face to its back"},
        {"bed_width", s.bed_width, 10, 600, "width of the bed"},
        {"bed_height", s.bed_height, 5, 300, "height of the bed above the table"},
        {"front_length", s.front, 20, 1500, "length of the bed in front of the fixed jaw's face"},
        {"rear_length", s.rear, 2, 500, "length of the body behind the fixed jaw's face"},
        {"base_width", s.base_width, 10, 800, "width of the base, with its ledges for clamps"},
        {"base_height", s.base_height, 2, 290, "height of these ledges above the table"},
        {"screw_length", s.screw, 0, 500, "length of the screw's end in front of the bed"},
        {"screw_size", 26, 2, 150, "width across that end, which is taken to be square"},
    };
}

Preset vise_preset(std::string_view name, std::string_view title, const ViseSizes& sizes) {
    return {name,
            PresetKind::vise,
            title,
            "The jaw width is the size by which the vise is called; all other sizes are typical: "
            "measure yours. Its handle is left out.",
            "On the bed, at the fixed jaw's face, in the middle of the width. X along the jaws, Z "
            "up, the moving jaw towards -Y; the table at Z minus bed_height.",
            vise_parameters(sizes),
            vise};
}

} // namespace

std::vector<Preset> vise_presets() {
    return {
        vise_preset("vise-4", "4 inch vise with a moving jaw",
                    {50, 130, 101.6, 32, 40, 55, 80, 55, 200, 50, 101.6, 22, 25}),
        vise_preset("vise-5", "5 inch vise with a moving jaw",
                    {75, 180, 127, 40, 50, 70, 100, 65, 270, 62, 127, 25, 30}),
        vise_preset("vise-6", "6 inch vise with a moving jaw",
                    {100, 230, 152.4, 45, 60, 85, 120, 73, 330, 75, 152.4, 28, 35}),
    };
}

} // namespace app
