#include "render/shader_program.h"

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
    glUniform3fv(at(name), 1, shares(color).data());
}
void ShaderProgram::set(const char* name, Color color) const {
    glUniform4fv(at(name), 1, shares(color).data());
}

} // namespace render
