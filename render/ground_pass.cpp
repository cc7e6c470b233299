#include "render/ground_pass.h"

#include <cstddef>

#include <epoxy/gl.h>

#include "render/shaders.h"

namespace render {
namespace {

/// Offset of the ground towards the eye, so that it is in front of the table on which it lies.
constexpr double ground_fraction = 1e-4;

} // namespace

core::Result<GroundPass> GroundPass::make() {
    GroundPass pass;
    FEELER_TRY(pass.shadows_,
               ShaderProgram::make(shaders::shadow_vertex, shaders::shadow_fragment));
    FEELER_TRY(pass.grids_, ShaderProgram::make(shaders::grid_vertex, shaders::grid_fragment));
    pass.no_attributes_ = GlVertexArray::make();
    pass.lines_ = GlVertexArray::make();
    pass.line_ends_ = GlBuffer::make();
    glBindVertexArray(pass.lines_.id());
    glBindBuffer(GL_ARRAY_BUFFER, pass.line_ends_.id());
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, sizeof(GridPoint), nullptr);
    glBindVertexArray(0);
    return pass;
}

void GroundPass::bring(const Scene& scene) {
    ShadowKey key = shadow_key(scene);
    if (shadow_ && key == shown_) return;
    shown_ = std::move(key);
    mask_ = shadow_mask(scene);
    has_shadow_ = !mask_.empty();
    if (!has_shadow_) return;
    shadow_ = GlTexture::make();
    glBindTexture(GL_TEXTURE_2D, shadow_.id());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, mask_.columns, mask_.rows, 0, GL_RED, GL_UNSIGNED_BYTE,
                 mask_.values.data());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    mask_.values.clear();
}

void GroundPass::draw_shadow(const ViewFrame& frame) const {
    const core::Transform& ground = frame.scene.ground->scene_from_ground;
    const Vec3 from = ground.inverse() * eye(frame.camera);
    const bool is_seen = frame.camera.projection == Projection::orthographic
                             ? glm::dot(ground.rotation[2], axes(frame.camera).backward) > 0.0
                             : from.z > 0.0;
    if (!has_shadow_ || !is_seen) return;
    shadows_.use();
    set_view(shadows_, frame, ground);
    // What is cut away casts no shadow.
    set_section(shadows_, frame.scene.section, ground);
    glEnable(GL_CLIP_DISTANCE0);
    shadows_.set("nearer", nearer(frame.camera, ground_fraction));
    shadows_.set("corner", glm::vec2(mask_.origin));
    shadows_.set("size", glm::vec2(mask_.cell * Vec2(mask_.columns, mask_.rows)));
    shadows_.set("ink", color(frame.options.theme, Role::shadow));
    shadows_.set_sampler("mask", 0);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, shadow_.id());
    glBindVertexArray(no_attributes_.id());
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    glDisable(GL_CLIP_DISTANCE0);
}

void GroundPass::draw_grid(const ViewFrame& frame) {
    const Ground& ground = *frame.scene.ground;
    const GridView view = grid_view(ground, frame.camera, frame.viewport, frame.options.scale);
    const std::vector<GridPoint> points = grid_lines(view);
    if (points.empty()) return;
    glBindVertexArray(lines_.id());
    glBindBuffer(GL_ARRAY_BUFFER, line_ends_.id());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(points.size() * sizeof(GridPoint)),
                 points.data(), GL_STREAM_DRAW);
    grids_.use();
    set_view(grids_, frame, ground.scene_from_ground);
    grids_.set("nearer", nearer(frame.camera, 1.5 * ground_fraction));
    grids_.set("middle", glm::vec2(view.middle));
    grids_.set("reach", static_cast<float>(view.reach));
    grids_.set("fine_reach", static_cast<float>(view.fine_reach()));
    grids_.set("ink", color(frame.options.theme, Role::grid));
    glLineWidth(static_cast<float>(frame.options.scale));
    glDrawArrays(GL_LINES, 0, static_cast<GLsizei>(points.size()));
}

void GroundPass::draw(const ViewFrame& frame) {
    if (!frame.scene.ground) return;
    bring(frame.scene);
    glEnable(GL_BLEND);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_FALSE);
    glDisable(GL_CULL_FACE);
    draw_shadow(frame);
    draw_grid(frame);
    glDepthMask(GL_TRUE);
    glBindTexture(GL_TEXTURE_2D, 0);
}

} // namespace render
