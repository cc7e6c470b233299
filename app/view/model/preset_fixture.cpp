#include "app/view/model/preset_fixture.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/check/setup_sheet.h"
#include "app/setup/presets/preset.h"
#include "app/setup/presets/vise_fit.h"
#include "app/setup/setup_changes.h"
#include "app/setup/setup_length.h"
#include "app/setup/setup_text.h"
#include "app/setup/stated_setup.h"
#include "app/view/model/view_model.h"
#include "app/view/model/workspace.h"
#include "core/dbm/solid.h"

namespace app::viewer {
namespace {

double grip_of(const Preset& vise, const PresetValues& values, const core::Aabb& stock) {
    const double jaws = PresetSizes(vise.parameters, values)["jaw_height"];
    return std::min(jaws, 0.5 * stock.size().z);
}

/// Where a new body stands: below the stock in its middle, or beside it, on its level.
core::Vec3 place_beside(const Preset& preset, const core::Aabb& stock) {
    const auto mesh = preset_mesh(preset);
    const core::Aabb body = mesh ? mesh->bounds() : core::Aabb{core::Vec3(0.0), core::Vec3(0.0)};
    if (preset.kind == PresetKind::plate) {
        const core::Vec3 shift = 0.5 * (stock.min + stock.max) - 0.5 * (body.min + body.max);
        return {shift.x, shift.y, stock.min.z - body.max.z};
    }
    return {stock.min.x - body.max.x, 0.5 * (stock.min.y + stock.max.y), stock.min.z - body.min.z};
}

/// How many quarter turns about Z a body is turned by, 0 to 3; empty if it is turned otherwise.
std::optional<int> quarter_turns_of(const StatedBody& body) {
    const double turns = body.rotate_deg.z / 90.0;
    const bool is_quarter = body.rotate_deg.x == 0.0 && body.rotate_deg.y == 0.0
                            && std::abs(turns) <= 4.0 && turns == std::floor(turns);
    return is_quarter ? std::optional((static_cast<int>(turns) + 4) % 4) : std::nullopt;
}

} // namespace

void add_preset(ViewModel& model, const Preset& preset) {
    const SetupSheet* sheet = sheet_of(model);
    if (!sheet) return;
    const core::Aabb stock = core::bounds(sheet->stock);
    core::Vec3 at = place_beside(preset, stock);
    std::optional<double> opening;
    int turns = 0;
    std::string refusal;
    if (preset.kind == PresetKind::vise) {
        const double grip = grip_of(preset, {}, stock);
        auto fit = vise_around(preset, {}, stock, grip);
        if (!fit) refusal = fit.error().message + ": it stands beside the stock";
        if (!fit) fit = vise_around(preset, {}, stock, grip, turns = 1);
        if (fit) {
            refusal.clear();
            at = fit->at;
            opening = fit->opening;
        }
    }
    add_fixture(model, std::string(preset.name), [&](gcode::LengthUnit unit) {
        return fmt::format("preset = {}\n{}at = {}\n{}frame = {}\n", toml_text(preset.name),
                           opening ? "opening = " + setup_length(*opening, unit) + "\n" : "",
                           setup_point(at, unit),
                           opening && turns == 1 ? "rotate_deg = [0, 0, 90]\n" : "",
                           toml_text(sheet->frame));
    });
    if (!refusal.empty()) model.workspace.refusal = refusal;
}

std::optional<double> usual_grip(const ViewModel& model, const StatedBody& body) {
    const Preset* const preset = find_preset(body.preset);
    const SetupSheet* const sheet = sheet_of(model);
    const bool can_hold = preset && preset->kind == PresetKind::vise && sheet
                          && body.frame == sheet->frame && quarter_turns_of(body);
    if (!can_hold) return std::nullopt;
    return grip_of(*preset, body.preset_values, core::bounds(sheet->stock));
}

void clamp_stock(ViewModel& model, const StatedBody& body, double depth) {
    if (!usual_grip(model, body) || !is_current(model)) return;
    const auto fit =
        vise_around(*find_preset(body.preset), body.preset_values,
                    core::bounds(sheet_of(model)->stock), depth, *quarter_turns_of(body));
    if (!fit) {
        model.workspace.refusal = fit.error().message;
        return;
    }
    const std::string name = body.name;
    edit_setup(model, "Clamp the stock in " + name,
               [&](const std::string& text) -> core::Result<std::string> {
                   const auto path = path_of_fixture(text, name);
                   if (!path) return text;
                   FEELER_TRY(const std::string placed,
                              with_pose(text, *path, fit->at, body.rotate_deg));
                   return with_preset_value(placed, *path, "opening", fit->opening);
               });
}

} // namespace app::viewer
