#pragma once

#include <glm/glm.hpp>

#include "render/camera.h"
#include "render/gl_objects.h"
#include "render/palette.h"
#include "render/renderer.h"

namespace render {

/// A program and its uniforms. Unknown names are ignored, as compilers drop unused uniforms.
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

/// Common data of all drawing of one picture.
struct ViewFrame {
    const Scene& scene;
    const Camera& camera;
    const DrawOptions& options;
    Viewport viewport;
    Mat4 view_from_scene, clip_from_view;
    unsigned hollows = 0; // ambient occlusion texture; 0: none
};

/// Offset of lines towards the eye by a fraction of the distance, so that they are in front of the
/// surface on which they are.
glm::vec2 nearer(const Camera& camera, double fraction);

/// Sets the matrices for a body with this pose.
void set_view(const ShaderProgram& program, const ViewFrame& frame,
              const core::Transform& scene_from_body = {});

/// Sets the plane that cuts a body away, or none. Returns whether it meets the body's box at all.
bool set_section(const ShaderProgram& program, const std::optional<SectionPlane>& section,
                 const core::Transform& scene_from_body = {});

/// Whether a section plane meets a box.
bool is_cut(const SectionPlane& section, const core::Aabb& box);

} // namespace render
