#include "render/view_frame.h"

namespace render {

glm::vec2 nearer(const Camera& camera, double share) {
    if (camera.projection == Projection::perspective)
        return {static_cast<float>(1.0 - share), 0.0F};
    return {1.0F, static_cast<float>(share * camera.distance)};
}

void set_view(const ShaderProgram& program, const ViewFrame& frame,
              const core::Transform& scene_from_body) {
    Mat4 pose(scene_from_body.rotation);
    pose[3] = glm::dvec4(scene_from_body.translation, 1.0);
    program.set("view_from_body", frame.view_from_scene * pose);
    program.set("clip_from_view", frame.clip_from_view);
}

bool set_section(const ShaderProgram& program, const std::optional<SectionPlane>& section,
                 const core::Transform& scene_from_body) {
    if (!section) {
        program.set("section", glm::vec4(0.0F, 0.0F, 0.0F, 1.0F));
        return false;
    }
    const Vec3 normal = glm::transpose(scene_from_body.rotation) * section->normal;
    const double offset = section->offset - glm::dot(section->normal, scene_from_body.translation);
    program.set("section", glm::vec4(glm::vec3(normal), static_cast<float>(offset)));
    return true;
}

bool is_cut(const SectionPlane& section, const core::Aabb& box) {
    const double middle = glm::dot(section.normal, box.center()) - section.offset;
    const double reach = glm::dot(glm::abs(section.normal), 0.5 * box.size());
    return std::abs(middle) <= reach;
}

} // namespace render
