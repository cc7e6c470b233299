#include <cmath>

#include "app/setup/presets/preset_lists.h"
#include "app/setup/presets/preset_solid.h"

namespace app {
namespace {

/// Jaws at these directions, as cosine and sine: exact, so that opposite jaws agree.
std::vector<PlanPoint> jaw_directions(int jaws) {
    const double half = 0.5, other = std::sqrt(0.75);
    if (jaws == 3) return {{1, 0}, {-half, other}, {-half, -other}};
    return {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
}

/// Where a jaw reaches from and to, measured from the axis: outwards from the part that it holds,
/// or inwards, at most to the axis.
PlanPoint reach_of_jaw(const PresetSizes& size) {
    const double held = size["diameter"] / 2, length = size["jaw_length"];
    if (size.count("inside") == 0) return {held, held + length};
    return {std::fmax(held - length, 0.0), held};
}

core::Result<core::Mesh> chuck(const PresetSizes& size, int jaws) {
    const double radius = size["body_diameter"] / 2, bore = size["bore_diameter"] / 2;
    const double half = size["jaw_width"] / 2;
    const auto [from, to] = reach_of_jaw(size);
    if (!(bore < radius)) return unfit_sizes("bore_diameter must be less than body_diameter");
    if (!(from < radius))
        return unfit_sizes("the jaws are outside of the body: diameter is too large for "
                           "body_diameter");
    if (!(to > bore))
        return unfit_sizes("the jaws do not reach the body around bore_diameter: diameter or "
                           "jaw_length is too small");
    PresetSolid solid(2);
    solid.add(around_circle({0.0, 0.0}, radius), -size["body_height"], 0.0);
    if (bore > 0.0) solid.cut(within_circle({0.0, 0.0}, bore), -size["body_height"], 0.0);
    for (const auto& [c, s] : jaw_directions(jaws))
        solid.add(turned(rectangle({from, -half}, {to, half}), c, s), 0.0, size["jaw_height"]);
    return solid.mesh();
}

core::Result<core::Mesh> chuck_of_3(const PresetSizes& size) { return chuck(size, 3); }
core::Result<core::Mesh> chuck_of_4(const PresetSizes& size) { return chuck(size, 4); }

/// A block with a bore along its axis, and the ring that closes the collet at its back.
core::Result<core::Mesh> collet_block(const PresetSizes& size, const Outline& outline) {
    const double bore = size["bore_diameter"] / 2, ring = size["ring_diameter"] / 2;
    const double back = -size["length"], end = back - size["ring_length"];
    if (!(2 * bore < size["across_flats"]))
        return unfit_sizes("bore_diameter must be less than across_flats");
    if (!(bore < ring)) return unfit_sizes("bore_diameter must be less than ring_diameter");
    PresetSolid solid(2);
    solid.add(outline, back, 0.0);
    solid.add(around_circle({0.0, 0.0}, ring), end, back);
    if (bore > 0.0) solid.cut(within_circle({0.0, 0.0}, bore), end, 0.0);
    return solid.mesh();
}

core::Result<core::Mesh> square_block(const PresetSizes& size) {
    const double half = size["across_flats"] / 2;
    return collet_block(size, rectangle({-half, -half}, {half, half}));
}

core::Result<core::Mesh> hex_block(const PresetSizes& size) {
    return collet_block(size, hexagon({0.0, 0.0}, size["across_flats"]));
}

/// Frame: on the spindle's axis, at its face.
core::Result<core::Mesh> dividing_head(const PresetSizes& size) {
    const double table = -size["centre_height"], half = size["body_width"] / 2;
    const double nose = size["nose_diameter"] / 2, bore = size["bore_diameter"] / 2;
    const double front = -size["nose_length"], back = front - size["body_length"];
    const double plate = size["plate_diameter"] / 2;
    if (!(bore < nose)) return unfit_sizes("bore_diameter must be less than nose_diameter");
    if (!(size["base_height"] + bore < size["centre_height"]))
        return unfit_sizes("base_height must be less than centre_height, less half the bore");
    if (!(bore < half && bore < size["body_above"]))
        return unfit_sizes("the bore must lie in the body: bore_diameter is too large for "
                           "body_width or body_above");
    if (!(plate < size["centre_height"]))
        return unfit_sizes("plate_diameter must be less than twice centre_height");
    // The plan is YZ.
    PresetSolid solid(0);
    solid.add(rectangle({-half, table}, {half, size["body_above"]}), back, front);
    const double base = size["base_width"] / 2;
    solid.add(rectangle({-base, table}, {base, table + size["base_height"]}), back, front);
    const double middle = (front + back) / 2;
    const double reach = std::fmin(plate, size["body_length"] / 2);
    solid.add(rectangle({half, -plate}, {half + size["plate_reach"], plate}), middle - reach,
              middle + reach);
    solid.add(around_circle({0.0, 0.0}, nose), front, 0.0);
    if (bore > 0.0) solid.cut(within_circle({0.0, 0.0}, bore), back, 0.0);
    return solid.mesh();
}

struct ChuckSizes {
    std::string_view name, title, source;
    double body_diameter, body_height, bore, jaw_height, held;
};

constexpr std::string_view toolmex_source =
    "Body diameter and height, hole and jaw height: D, H, E and H1 of Toolmex 3-866-0600P, -0800P "
    "and -1200P on the pages of their dealer tri-advantech. The jaws are plain blocks of typical "
    "sizes.";
constexpr std::string_view typical_source =
    "All sizes are typical: measure yours. The jaws are plain blocks.";

std::vector<PresetParameter> chuck_parameters(const ChuckSizes& s) {
    return {
        {"diameter", s.held, 1, 2000, "diameter of the part where the jaws hold it"},
        {"inside", 0, 0, 1, "0: the jaws hold from outside; 1: they hold the wall of a bore",
         PresetMeasure::count},
        {"body_diameter", s.body_diameter, 20, 2000, "diameter of the body"},
        {"body_height", s.body_height, 2, 1000, "height of the body, from its back to its face"},
        {"bore_diameter", s.bore, 0, 1500, "diameter of the hole through the body; 0 for none"},
        {"jaw_height", s.jaw_height, 1, 500, "height of the jaws above the face"},
        {"jaw_length", 45, 1, 500, "length of a jaw, away from the part"},
        {"jaw_width", 22, 1, 200, "width of a jaw"},
    };
}

Preset chuck_preset(const ChuckSizes& sizes, Preset::Generator generate) {
    return {sizes.name,
            PresetKind::chuck,
            sizes.title,
            sizes.source,
            "On its axis, at the face on which the jaws stand. Z along the axis, away from the "
            "body; the first jaw towards +X.",
            chuck_parameters(sizes),
            generate};
}

Preset collet_preset(std::string_view name, std::string_view title, double across,
                     Preset::Generator generate) {
    return {name,
            PresetKind::chuck,
            title,
            "All sizes are typical of blocks for 5C collets: measure yours.",
            "On its axis, at the face from which the part extends. Z along the axis, away from the "
            "block; two flats along X.",
            {
                {"across_flats", across, 5, 300, "width across the flats"},
                {"length", 76, 5, 500, "length of the block"},
                {"bore_diameter", 28, 0, 250, "diameter of the hole along the axis; 0 for none"},
                {"ring_diameter", 60, 5, 400, "diameter of the ring or lever cap at the back"},
                {"ring_length", 15, 0, 200, "length of that ring; 0 for none"},
            },
            generate};
}

Preset dividing_preset() {
    return {"dividing-head",
            PresetKind::chuck,
            "Dividing head with a horizontal spindle",
            "All sizes are typical: measure yours. The index plate and its crank are a block.",
            "On the spindle's axis, at its face. X along the axis, away from the head, Z up; the "
            "table at Z minus centre_height.",
            {
                {"centre_height", 100, 10, 600, "height of the spindle's axis above the table"},
                {"nose_diameter", 60, 5, 500, "diameter of the spindle's nose"},
                {"nose_length", 25, 0.5, 500, "length of the nose in front of the body"},
                {"bore_diameter", 18, 0, 400, "diameter of the spindle's hole; 0 for none"},
                {"body_length", 160, 10, 1000, "length of the body, along X"},
                {"body_width", 120, 10, 800, "width of the body, along Y"},
                {"body_above", 65, 2, 600, "height of the body above the axis"},
                {"base_width", 180, 10, 1200, "width of the base with its ledges"},
                {"base_height", 20, 1, 300, "height of these ledges above the table"},
                {"plate_diameter", 110, 2, 500, "diameter of the index plate, on the side of +Y"},
                {"plate_reach", 75, 0, 500, "reach of plate and crank beside the body; 0 for none"},
            },
            dividing_head};
}

} // namespace

std::vector<Preset> chuck_presets() {
    return {
        chuck_preset(
            {"3-jaw-chuck-6", "6 inch chuck with 3 jaws", toolmex_source, 160, 88.5, 42, 44, 50},
            chuck_of_3),
        chuck_preset(
            {"3-jaw-chuck-8", "8 inch chuck with 3 jaws", toolmex_source, 200, 99, 55, 45, 70},
            chuck_of_3),
        chuck_preset({"3-jaw-chuck-12", "12 inch chuck with 3 jaws", toolmex_source, 315, 118.5,
                      103, 57, 120},
                     chuck_of_3),
        chuck_preset(
            {"4-jaw-chuck-6", "6 inch chuck with 4 jaws", typical_source, 160, 75, 40, 42, 50},
            chuck_of_4),
        chuck_preset(
            {"4-jaw-chuck-8", "8 inch chuck with 4 jaws", typical_source, 200, 85, 55, 45, 70},
            chuck_of_4),
        collet_preset("collet-block-hex", "Hexagonal collet block", 44.45, hex_block),
        collet_preset("collet-block-square", "Square collet block", 44.45, square_block),
        dividing_preset(),
    };
}

} // namespace app
