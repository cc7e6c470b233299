#include "app/view/model/section.h"

#include <algorithm>
#include <cmath>

#include "app/view/model/scene_of.h"
#include "app/view/model/view_model.h"
#include "render/ground.h"
#include "render/picking.h"

namespace app::viewer {
namespace {

/// Of the extent of the stock across the plane: what always remains.
constexpr double least_rest = 0.02;
/// Where a section begins, at least this far from both sides.
constexpr double first_rest = 0.2;

/// The box that must not disappear: that of the stock, if there is one.
core::Aabb box_to_keep(const ViewModel& model) {
    core::Aabb box;
    if (model.block_state)
        for (const auto& brick : model.block_state->stock) box.extend(brick->mesh.bounds);
    if (!box.empty()) return box;
    if (!model.block_state && model.program && model.program->scene)
        if (const render::SharedMesh& raw = model.program->scene->meshes.raw_stock; raw)
            return raw->bounds;
    return render::work_bounds(scene_of(model));
}

/// The interval of a box along a direction, from the origin.
SectionRange extent_along(const core::Aabb& box, const core::Vec3& direction) {
    const double middle = glm::dot(direction, box.center());
    const double reach = glm::dot(glm::abs(direction), 0.5 * box.size());
    return {middle - reach, middle + reach};
}

/// Moves the plane so that at least a fraction of the box remains, and at most that much is whole.
void keep_within(render::SectionPlane& plane, const core::Aabb& box, double least, double most) {
    if (box.empty()) return;
    const SectionRange extent = extent_along(box, plane.normal);
    const double size = extent.most - extent.least;
    plane.offset =
        std::clamp(plane.offset, extent.least + least * size, extent.least + most * size);
}

core::Vec3 axis_vector(SectionAxis axis) {
    core::Vec3 direction(0.0);
    direction[static_cast<int>(axis)] = 1.0;
    return direction;
}

/// A point of interest: the closest pair, else the middle of the stock.
core::Vec3 middle_of_interest(const ViewModel& model, const core::Aabb& box) {
    if (model.has_rows())
        if (const auto witness = witness_in(model.row(), model.shown_pair))
            return 0.5 * (witness->on_tool + witness->on_body);
    return box.center();
}

/// Where positions across an axis count from.
core::Vec3 zero_of_axes(const ViewModel& model) {
    const auto zero = program_triad(model);
    return zero ? zero->origin : core::Vec3(0.0);
}

void begin_across(ViewModel& model, SectionAxis axis, const core::Aabb& box) {
    const core::Vec3 through = middle_of_interest(model, box);
    Section section;
    section.axis = axis;
    section.normal = axis_vector(axis);
    section.zero = zero_of_axes(model);
    if (model.section) section.cuts_tool = model.section->cuts_tool;
    const double side = glm::dot(section.normal, render::eye(model.camera) - through);
    section.plane.normal = side < 0.0 ? -section.normal : section.normal;
    section.plane.offset = glm::dot(section.plane.normal, through);
    keep_within(section.plane, box, first_rest, 1.0 - first_rest);
    model.section = section;
}

} // namespace

bool open_section(ViewModel& model) {
    const core::Aabb box = box_to_keep(model);
    if (box.empty()) return false;
    const core::Vec3 to_eye = render::eye(model.camera) - box.center();
    const bool along_x = std::abs(to_eye.x) > std::abs(to_eye.y);
    begin_across(model, along_x ? SectionAxis::x : SectionAxis::y, box);
    return true;
}

void set_section_axis(ViewModel& model, SectionAxis axis) {
    if (!model.section || axis == SectionAxis::any) return;
    model.section->pick = SectionPick::none;
    if (model.section->axis == axis) return;
    if (const core::Aabb box = box_to_keep(model); !box.empty()) begin_across(model, axis, box);
}

void set_section_plane(ViewModel& model, const core::Vec3& normal, const core::Vec3& through) {
    const double length = glm::length(normal);
    if (!model.section || !(length > 0.0) || !core::is_finite(through)) return;
    Section section;
    section.axis = SectionAxis::any;
    section.normal = normal / length;
    section.zero = through;
    section.cuts_tool = model.section->cuts_tool;
    section.plane = {section.normal, glm::dot(section.normal, through)};
    keep_within(section.plane, box_to_keep(model), least_rest, 1.0);
    model.section = section;
}

void flip_section(ViewModel& model) {
    if (!model.section) return;
    render::SectionPlane& plane = model.section->plane;
    plane = {-plane.normal, -plane.offset};
    keep_within(plane, box_to_keep(model), least_rest, 1.0);
}

SectionRange section_range(const ViewModel& model) {
    if (!model.section) return {};
    const Section& section = *model.section;
    const core::Aabb box = box_to_keep(model);
    if (box.empty()) return {section_position(model), section_position(model)};
    const SectionRange extent = extent_along(box, section.normal);
    const double rest = least_rest * (extent.most - extent.least);
    const double zero = glm::dot(section.normal, section.zero);
    return section.is_flipped() ? SectionRange{extent.least - zero, extent.most - rest - zero}
                                : SectionRange{extent.least + rest - zero, extent.most - zero};
}

double section_position(const ViewModel& model) {
    if (!model.section) return 0.0;
    const Section& section = *model.section;
    const double along = section.is_flipped() ? -section.plane.offset : section.plane.offset;
    return along - glm::dot(section.normal, section.zero);
}

void set_section_position(ViewModel& model, double position) {
    if (!model.section || !std::isfinite(position)) return;
    const SectionRange range = section_range(model);
    Section& section = *model.section;
    const double along = std::clamp(position, range.least, std::max(range.least, range.most))
                         + glm::dot(section.normal, section.zero);
    section.plane.offset = section.is_flipped() ? -along : along;
}

double section_step(const ViewModel& model) {
    const SectionRange range = section_range(model);
    return render::step_of_at_least((range.most - range.least) / 200.0, model.settings.inch).fine;
}

void pick_section(ViewModel& model, SectionPick pick) {
    if (!model.section) return;
    model.section->picked.clear();
    model.section->pick = model.section->pick == pick ? SectionPick::none : pick;
}

bool take_section_click(ViewModel& model, const render::SurfaceHit& hit, double now) {
    if (!model.section || model.section->pick == SectionPick::none) return false;
    if (model.section->pick == SectionPick::face) {
        set_section_plane(model, hit.normal, hit.point);
        return true;
    }
    std::vector<core::Vec3>& points = model.section->picked;
    points.push_back(hit.point);
    if (points.size() < 3) return true;
    const core::Vec3 one = points[1] - points[0], other = points[2] - points[0];
    core::Vec3 normal = glm::cross(one, other);
    if (glm::length(normal) <= 1e-6 * glm::length(one) * glm::length(other)) {
        points.pop_back();
        say(model, "The three points are on one line: click another third point", now);
        return true;
    }
    if (glm::dot(normal, render::eye(model.camera) - points[0]) < 0.0) normal = -normal;
    set_section_plane(model, normal, points[0]);
    return true;
}

} // namespace app::viewer
