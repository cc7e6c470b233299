#pragma once

#include <glm/glm.hpp>

#include "render/gl_objects.h"
#include "render/palette.h"

namespace render {

/// A program and how its values are set. Names are those in its text; a name that it does not have
/// is passed over, as compilers drop what is not used.
class ShaderProgram {
public:
    static core::Result<ShaderProgram> make(const char* vertex, const char* fragment);

    void use() const;
    void set(const char* name, float value) const;
    void set(const char* name, uint32_t value) const;
    void set_sampler(const char* name, int unit) const;
    void set(const char* name, const glm::vec2& value) const;
    void set(const char* name, const glm::vec3& value) const;
    void set(const char* name, const glm::vec4& value) const;
    void set(const char* name, const glm::dmat4& value) const;
    void set_rgb(const char* name, Color color) const;
    void set(const char* name, Color color) const;

private:
    int at(const char* name) const;

    GlProgram program_;
};

} // namespace render
