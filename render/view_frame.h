#pragma once

#include "render/camera.h"
#include "render/renderer.h"
#include "render/shader_program.h"

namespace render {

/// What all that is drawn in a picture has in common.
struct ViewFrame {
    const Scene& scene;
    const Camera& camera;
    const DrawOptions& options;
    Viewport viewport;
    Mat4 view_from_scene, clip_from_view;
    unsigned hollows = 0; // texture of how dark corners are; 0: none
};

/// How far lines are drawn in front of the surface they lie on, by so many parts of the distance.
glm::vec2 nearer(const Camera& camera, double share);

/// Sets the matrices of a body with this pose.
void set_view(const ShaderProgram& program, const ViewFrame& frame,
              const core::Transform& scene_from_body = {});

/// Sets the plane that cuts a body away, or none. Returns whether it meets the body's box at all.
bool set_section(const ShaderProgram& program, const std::optional<SectionPlane>& section,
                 const core::Transform& scene_from_body = {});

/// On which side of a section plane a box lies.
bool is_cut(const SectionPlane& section, const core::Aabb& box);

} // namespace render
