#include "app/session/device_models.h"

#include <algorithm>

#include "hwsim/tool_model.h"

namespace app {
namespace {

using core::Result;
using hwsim::SlotNumber;

constexpr double cylinder_tolerance = 0.02; // mm

/// A body of revolution looks the same however it is turned about its axis; others do not.
bool stands_upright(const core::MovingBody& body, const core::Mat3& orientation) {
    return body.profile ? orientation[2] == core::Vec3(0.0, 0.0, 1.0)
                        : orientation == core::Mat3(1.0);
}

/// The mesh size for a body: the set-up's, or coarser for a large one.
double spacing_for(const core::Aabb& box, double mesh_size, double most_cells = 200.0) {
    const core::Vec3 size = box.size();
    return std::max({mesh_size, size.x / most_cells, size.y / most_cells, size.z / most_cells});
}

/// Of what is held at an angle, which is modelled again for each way it is held.
double tilted_spacing(const core::RevolvedProfile& part, double mesh_size) {
    return spacing_for(bounds(part), mesh_size, 64.0);
}
double cube_side(const core::ExactBody& body, double mesh_size) {
    return spacing_for(bounds(body), mesh_size, 40.0);
}

} // namespace

double DeviceModels::excess(const core::MovingBody& body, const core::Mat3& orientation) const {
    const bool is_upright = stands_upright(body, orientation);
    // A cell's diagonal; half of it that a part is grown by and what a cylinder adds to a post; a
    // cube's diagonal.
    if (body.profile)
        return is_upright ? cylinder_tolerance
                          : 1.7 * tilted_spacing(*body.profile, setup_->mesh_size);
    return is_upright ? 1.7 * spacing_for(bounds(*body.body), setup_->mesh_size)
                      : 1.8 * cube_side(*body.body, setup_->mesh_size);
}

Result<std::vector<hwsim::Record>> DeviceModels::records_of(const core::MovingBody& body,
                                                            double shrink,
                                                            const core::Mat3& orientation) {
    const bool is_upright = stands_upright(body, orientation);
    std::vector<hwsim::Record> posts;
    if (body.profile) {
        const core::RevolvedProfile part =
            shrink > 0.0 ? shrunk_around(*body.profile, shrink) : *body.profile;
        if (part.empty()) return posts;
        if (is_upright) return hwsim::cylinders_round(part, cylinder_tolerance);
        FEELER_TRY(posts, hwsim::posts_round(part, tilted_spacing(*body.profile, setup_->mesh_size),
                                             orientation));
        return hwsim::cylinders_round(posts);
    }
    if (is_upright) {
        FEELER_TRY(posts, hwsim::posts_round(*body.body,
                                             spacing_for(bounds(*body.body), setup_->mesh_size)));
        return hwsim::cylinders_round(posts);
    }
    hwsim::CubeCover& cubes = cubes_[body.carried];
    if (cubes.centres.empty())
        cubes = hwsim::cubes_round(*body.body, cube_side(*body.body, setup_->mesh_size));
    return hwsim::cylinders_round(cubes, orientation);
}

Result<SlotNumber> DeviceModels::of_body(hwsim::Driver& driver, const core::MovingBody& body,
                                         double shrink, const core::Mat3& orientation) {
    const Key key{body.kind, body.carried, shrink};
    const auto known = bodies_.find(key);
    if (known != bodies_.end()) {
        const bool is_same = known->second.orientation == orientation
                             || (stands_upright(body, orientation)
                                 && stands_upright(body, known->second.orientation));
        if (is_same) return known->second.slot;
        hwsim::unload(driver, known->second.slot);
        bodies_.erase(known);
    }
    FEELER_TRY(std::vector<hwsim::Record> records, records_of(body, shrink, orientation));
    FEELER_TRY(const SlotNumber slot,
               hwsim::load_records(driver, hwsim::Side::tool, std::move(records)));
    bodies_[key] = {slot, orientation};
    return slot;
}

Result<SlotNumber> DeviceModels::of_fixture(hwsim::Driver& driver, size_t fixture) {
    if (fixtures_[fixture]) return *fixtures_[fixture];
    const core::ExactBody& body = setup_->fixtures[fixture].body;
    FEELER_TRY(std::vector<hwsim::Record> posts,
               hwsim::posts_round(body, spacing_for(bounds(body), setup_->mesh_size)));
    FEELER_TRY(fixtures_[fixture],
               hwsim::load_records(driver, hwsim::Side::work, std::move(posts)));
    return *fixtures_[fixture];
}

void DeviceModels::use_tool(hwsim::Driver& driver, const core::ToolAssembly* tool) {
    if (tool == tool_) return;
    tool_ = tool;
    for (auto known = bodies_.begin(); known != bodies_.end();) {
        const core::PartKind kind = std::get<core::PartKind>(known->first);
        const bool is_of_tool = kind == core::PartKind::flutes || kind == core::PartKind::shank
                                || kind == core::PartKind::holder;
        if (is_of_tool) hwsim::unload(driver, known->second.slot);
        known = is_of_tool ? bodies_.erase(known) : std::next(known);
    }
}

} // namespace app
