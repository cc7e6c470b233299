#include "render/hollow_pass.h"

#include <epoxy/gl.h>

#include "render/shaders.h"

namespace render {
namespace {

/// How far corners darken, as a share of the height of what is seen at the target.
constexpr double reach_share = 0.055;

GlTexture texture(const Viewport& size, GLint format, GLenum channels, GLenum type) {
    GlTexture made = GlTexture::make();
    glBindTexture(GL_TEXTURE_2D, made.id());
    glTexImage2D(GL_TEXTURE_2D, 0, format, size.width, size.height, 0, channels, type, nullptr);
    const GLint filter = channels == GL_RED ? GL_LINEAR : GL_NEAREST;
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return made;
}

GlFramebuffer framebuffer(GLenum place, const GlTexture& texture) {
    GlFramebuffer made = GlFramebuffer::make();
    glBindFramebuffer(GL_FRAMEBUFFER, made.id());
    glFramebufferTexture2D(GL_FRAMEBUFFER, place, GL_TEXTURE_2D, texture.id(), 0);
    if (place == GL_DEPTH_ATTACHMENT) {
        glDrawBuffer(GL_NONE);
        glReadBuffer(GL_NONE);
    }
    return made;
}

bool is_complete(const GlFramebuffer& framebuffer) {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
    return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

} // namespace

core::Result<HollowPass> HollowPass::make() {
    HollowPass pass;
    FEELER_TRY(pass.hollows_,
               ShaderProgram::make(shaders::background_vertex, shaders::hollow_fragment));
    FEELER_TRY(pass.smooth_,
               ShaderProgram::make(shaders::background_vertex, shaders::smooth_fragment));
    pass.no_attributes_ = GlVertexArray::make();
    return pass;
}

bool HollowPass::resize(const Viewport& size) {
    if (size.width == size_.width && size.height == size_.height) return true;
    depths_ = texture(size, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT);
    rough_ = texture(size, GL_R8, GL_RED, GL_UNSIGNED_BYTE);
    result_ = texture(size, GL_R8, GL_RED, GL_UNSIGNED_BYTE);
    to_depths_ = framebuffer(GL_DEPTH_ATTACHMENT, depths_);
    to_rough_ = framebuffer(GL_COLOR_ATTACHMENT0, rough_);
    to_result_ = framebuffer(GL_COLOR_ATTACHMENT0, result_);
    const bool complete =
        is_complete(to_depths_) && is_complete(to_rough_) && is_complete(to_result_);
    size_ = complete ? size : Viewport{0, 0};
    return complete;
}

unsigned HollowPass::draw(const ViewFrame& frame, BodyPass& bodies) {
    const Viewport size{(frame.viewport.width + 1) / 2, (frame.viewport.height + 1) / 2};
    if (!resize(size)) return 0;
    glViewport(0, 0, size.width, size.height);
    glBindFramebuffer(GL_FRAMEBUFFER, to_depths_.id());
    glEnable(GL_DEPTH_TEST);
    glClear(GL_DEPTH_BUFFER_BIT);
    bodies.draw_depths(frame);
    glDisable(GL_DEPTH_TEST);
    glBindVertexArray(no_attributes_.id());
    const double seen = pixel_size(frame.camera, size, frame.camera.target) * size.height;
    hollows_.use();
    hollows_.set_sampler("depths", 0);
    hollows_.set("clip_from_view", frame.clip_from_view);
    hollows_.set("view_from_clip", glm::inverse(frame.clip_from_view));
    hollows_.set("reach", static_cast<float>(reach_share * seen));
    hollows_.set("pixels", static_cast<float>(0.5 * frame.clip_from_view[1][1] * size.height
                                              * reach_share * seen));
    glBindTexture(GL_TEXTURE_2D, depths_.id());
    glBindFramebuffer(GL_FRAMEBUFFER, to_rough_.id());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    smooth_.use();
    smooth_.set_sampler("depths", 0);
    smooth_.set_sampler("hollows", 1);
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_2D, rough_.id());
    glBindFramebuffer(GL_FRAMEBUFFER, to_result_.id());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindTexture(GL_TEXTURE_2D, 0);
    glActiveTexture(GL_TEXTURE0);
    glEnable(GL_DEPTH_TEST);
    return result_.id();
}

} // namespace render
