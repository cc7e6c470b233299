#include "render/view_frame.h"

#include <epoxy/gl.h>

namespace render {

core::Result<ShaderProgram> ShaderProgram::make(const char* vertex, const char* fragment) {
    ShaderProgram made;
    FEELER_TRY(made.program_, link_program(vertex, fragment));
    return made;
}

int ShaderProgram::at(const char* name) const { return glGetUniformLocation(program_.id(), name); }

void ShaderProgram::use() const { glUseProgram(program_.id()); }
void ShaderProgram::set(const char* name, float value) const { glUniform1f(at(name), value); }
void ShaderProgram::set(const char* name, uint32_t value) const { glUniform1ui(at(name), value); }
void ShaderProgram::set_sampler(const char* name, int unit) const { glUniform1i(at(name), unit); }

void ShaderProgram::set(const char* name, const glm::vec2& value) const {
    glUniform2fv(at(name), 1, &value[0]);
}
void ShaderProgram::set(const char* name, const glm::vec3& value) const {
    glUniform3fv(at(name), 1, &value[0]);
}
void ShaderProgram::set(const char* name, const glm::vec4& value) const {
    glUniform4fv(at(name), 1, &value[0]);
}
void ShaderProgram::set(const char* name, const glm::dmat4& value) const {
    const glm::mat4 single(value);
    glUniformMatrix4fv(at(name), 1, GL_FALSE, &single[0][0]);
}
void ShaderProgram::set_rgb(const char* name, Color color) const {
    glUniform3fv(at(name), 1, fractions(color).data());
}
void ShaderProgram::set(const char* name, Color color) const {
    glUniform4fv(at(name), 1, fractions(color).data());
}

glm::vec2 nearer(const Camera& camera, double fraction) {
    if (camera.projection == Projection::perspective)
        return {static_cast<float>(1.0 - fraction), 0.0F};
    return {1.0F, static_cast<float>(fraction * camera.distance)};
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
