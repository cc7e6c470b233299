#include "app/setup/presets/preset_lists.h"
#include "app/setup/presets/preset_solid.h"

namespace app {
namespace {

/// The sizes that go with a thread, mm.
struct ThreadSizes {
    std::string_view clamp_name, step_clamp_name, stud_name;
    double diameter, nut_across, washer_diameter, washer_thickness;
    double strap_length, strap_width, strap_thickness, stud_position;
};

/// Nuts: ISO 4032. Straps and washers: typical.
constexpr ThreadSizes threads[] = {
    {"strap-clamp-m8", "step-clamp-m8", "stud-m8", 8, 13, 17, 3, 60, 25, 12, 25},
    {"strap-clamp-m10", "step-clamp-m10", "stud-m10", 10, 16, 21, 4, 80, 30, 15, 32},
    {"strap-clamp-m12", "step-clamp-m12", "stud-m12", 12, 18, 24, 4, 100, 35, 18, 40},
    {"strap-clamp-m16", "step-clamp-m16", "stud-m16", 16, 24, 32, 5, 125, 45, 22, 50},
};

constexpr std::string_view thread_source =
    "Nut across flats: ISO 4032. Nut height: 1.5 times the thread. All other sizes are typical: "
    "measure yours. The threads are plain cylinders.";

/// Adds a washer, a nut and the end of a stud on top of a surface at `height`; the stud goes down
/// to `foot`.
void add_stud(PresetSolid& solid, const PresetSizes& size, double x, double height, double foot) {
    const PlanPoint centre{x, 0.0};
    const double washer = height + size["washer_thickness"], nut = washer + size["nut_height"];
    solid.add(around_circle(centre, size["washer_diameter"] / 2), height, washer);
    solid.add(hexagon(centre, size["nut_across"]), washer, nut);
    solid.add(around_circle(centre, size["stud_diameter"] / 2), foot, nut + size["stud_above"]);
}

/// Why the parts of a stud do not go together; empty if they do.
std::string stud_mistake(const PresetSizes& size) {
    if (!(size["stud_diameter"] < size["nut_across"]))
        return "stud_diameter must be less than nut_across";
    if (!(size["stud_diameter"] < size["washer_diameter"]))
        return "stud_diameter must be less than washer_diameter";
    return {};
}

std::vector<PresetParameter> stud_parameters(const ThreadSizes& thread) {
    return {
        {"stud_diameter", thread.diameter, 2, 60, "diameter of the stud"},
        {"stud_above", 10, 0, 500, "length of the stud above the nut"},
        {"nut_across", thread.nut_across, 3, 100, "width of the nut across its flats"},
        {"nut_height", 1.5 * thread.diameter, 1, 100, "height of the nut"},
        {"washer_diameter", thread.washer_diameter, 3, 150, "outer diameter of the washer"},
        {"washer_thickness", thread.washer_thickness, 0.5, 30, "thickness of the washer"},
    };
}

/// Strap, stud, and what carries the heel, up to `riser` beyond the strap's end.
core::Result<PresetSolid> strap_on_stud(const PresetSizes& size) {
    if (const std::string mistake = stud_mistake(size); !mistake.empty())
        return unfit_sizes(mistake);
    const double length = size["strap_length"], half = size["strap_width"] / 2;
    const double radius = size["stud_diameter"] / 2, at = size["stud_position"];
    if (!(at > radius && at + radius < length - size["heel_length"]))
        return unfit_sizes("stud_position must leave the stud between the nose and the heel, "
                           "which is the last heel_length of strap_length");
    if (!(radius < half)) return unfit_sizes("stud_diameter must be less than strap_width");
    PresetSolid solid(2);
    solid.add(rectangle({0.0, -half}, {length, half}), 0.0, size["strap_thickness"]);
    add_stud(solid, size, at, size["strap_thickness"], -size["height"]);
    return solid;
}

core::Result<core::Mesh> strap_clamp(const PresetSizes& size) {
    FEELER_TRY(PresetSolid solid, strap_on_stud(size));
    const double heel = size["strap_length"] - size["heel_length"];
    const double half = size["block_width"] / 2;
    solid.add(rectangle({heel, -half}, {heel + size["block_length"], half}), -size["height"], 0.0);
    return solid.mesh();
}

/// The heel stands on a step; the steps behind it rise.
core::Result<core::Mesh> step_clamp(const PresetSizes& size) {
    FEELER_TRY(PresetSolid solid, strap_on_stud(size));
    const double end = size["strap_length"], half = size["block_width"] / 2;
    solid.add(rectangle({end - size["heel_length"], -half}, {end, half}), -size["height"], 0.0);
    for (int step = 0; step < size.count("steps_above"); ++step)
        solid.add(rectangle({end + step * size["step_length"], -half},
                            {end + (step + 1) * size["step_length"], half}),
                  -size["height"], (step + 1) * size["step_height"]);
    return solid.mesh();
}

core::Result<core::Mesh> stud(const PresetSizes& size) {
    if (const std::string mistake = stud_mistake(size); !mistake.empty())
        return unfit_sizes(mistake);
    PresetSolid solid(2);
    add_stud(solid, size, 0.0, 0.0, -size["stud_below"]);
    return solid.mesh();
}

core::Result<core::Mesh> toe_clamp(const PresetSizes& size) {
    const double nose = size["nose_length"], half = size["width"] / 2, foot = -size["height"];
    const double top = foot + size["body_height"], end = nose + size["body_length"];
    if (!(top > 0.0))
        return unfit_sizes("height must be less than body_height: the nose leaves the body");
    const double radius = size["screw_diameter"] / 2;
    if (!(2 * radius < size["width"] && 2 * radius < size["body_length"]))
        return unfit_sizes("screw_diameter must be less than width and body_length");
    PresetSolid solid(2);
    solid.add(rectangle({0.0, -half}, {nose, half}), 0.0, size["nose_height"]);
    solid.add(rectangle({nose, -half}, {end, half}), foot, top);
    solid.add(around_circle({(nose + end) / 2, 0.0}, radius), foot, top + size["screw_height"]);
    return solid.mesh();
}

constexpr std::string_view clamp_origin =
    "Under the tip of the nose, in the middle of the width, where it rests on the part. X from the "
    "nose to the heel, Z up; the table at Z minus height.";

std::vector<PresetParameter> strap_parameters(const ThreadSizes& thread) {
    std::vector<PresetParameter> parameters = {
        {"height", 25, 1, 1000, "height of the clamped surface above the table"},
        {"strap_length", thread.strap_length, 10, 1000, "length of the strap"},
        {"strap_width", thread.strap_width, 4, 300, "width of the strap"},
        {"strap_thickness", thread.strap_thickness, 2, 150, "thickness of the strap"},
        {"stud_position", thread.stud_position, 2, 900, "axis of the stud, from the nose's tip"},
    };
    for (const PresetParameter& each : stud_parameters(thread)) parameters.push_back(each);
    parameters.push_back(
        {"heel_length", thread.strap_width / 2, 2, 500, "length of the heel that is supported"});
    parameters.push_back(
        {"block_width", thread.strap_width, 4, 300, "width of the block under the heel"});
    return parameters;
}

Preset strap_preset(const ThreadSizes& thread) {
    Preset preset{thread.clamp_name,
                  PresetKind::clamp,
                  "Strap clamp with stud, nut and a plain block under its heel",
                  thread_source,
                  clamp_origin,
                  strap_parameters(thread),
                  strap_clamp};
    preset.parameters.push_back({"block_length", thread.strap_width, 2, 500,
                                 "length of that block, from where the heel begins"});
    return preset;
}

Preset step_preset(const ThreadSizes& thread) {
    Preset preset{thread.step_clamp_name,
                  PresetKind::clamp,
                  "Strap clamp with stud and nut, its heel on a step block",
                  thread_source,
                  clamp_origin,
                  strap_parameters(thread),
                  step_clamp};
    preset.parameters.push_back(
        {"steps_above", 2, 0, 20, "steps behind the heel, which rise", PresetMeasure::count});
    preset.parameters.push_back({"step_length", 10, 0.5, 100, "length of each of them"});
    preset.parameters.push_back({"step_height", 8, 0.5, 100, "height of each of them"});
    return preset;
}

Preset stud_preset(const ThreadSizes& thread) {
    Preset preset{thread.stud_name,
                  PresetKind::clamp,
                  "Stud with washer and nut",
                  thread_source,
                  "On its axis, on the surface under the washer. Z up.",
                  stud_parameters(thread),
                  stud};
    preset.parameters.push_back({"stud_below", 50, 0, 1000, "length of the stud below the washer"});
    return preset;
}

Preset toe_preset() {
    return {"toe-clamp",
            PresetKind::clamp,
            "Toe clamp, which presses against the side of a low part",
            "All sizes are typical: measure yours.",
            "At the face of the nose, in the middle of its width, at its lower edge. X from the "
            "part to the back of the clamp, Z up; the table at Z minus height.",
            {
                {"height", 4, 0, 300, "height of the nose's lower edge above the table"},
                {"nose_length", 10, 1, 200, "length of the nose in front of the body"},
                {"nose_height", 8, 0.5, 200, "height of the face of the nose"},
                {"width", 30, 4, 300, "width of nose and body"},
                {"body_length", 40, 4, 400, "length of the body"},
                {"body_height", 18, 2, 300, "height of the body above the table"},
                {"screw_diameter", 18, 2, 100, "diameter of the screw's head"},
                {"screw_height", 6, 0, 100, "height of the screw's head above the body"},
            },
            toe_clamp};
}

} // namespace

std::vector<Preset> clamp_presets() {
    std::vector<Preset> all{toe_preset()};
    for (const ThreadSizes& thread : threads)
        for (const Preset& preset :
             {strap_preset(thread), step_preset(thread), stud_preset(thread)})
            all.push_back(preset);
    return all;
}

} // namespace app
