#include "render/canvas.h"

#include <algorithm>

#include <epoxy/gl.h>

namespace render {
namespace {

void make_storage(const GlRenderbuffer& buffer, GLenum format, const Viewport& size, int samples) {
    glBindRenderbuffer(GL_RENDERBUFFER, buffer.id());
    if (samples > 1)
        glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, size.width, size.height);
    else
        glRenderbufferStorage(GL_RENDERBUFFER, format, size.width, size.height);
}

void attach(GLenum place, const GlRenderbuffer& buffer) {
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, place, GL_RENDERBUFFER, buffer.id());
}

bool is_complete() { return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE; }

} // namespace

core::Result<Canvas> Canvas::make(const Viewport& size, int samples) {
    Canvas canvas;
    canvas.size_ = {std::max(1, size.width), std::max(1, size.height)};
    GLint most = 1;
    glGetIntegerv(GL_MAX_SAMPLES, &most);
    canvas.samples_ = std::clamp(samples, 1, std::max(1, most));
    canvas.color_ = GlTexture::make();
    glBindTexture(GL_TEXTURE_2D, canvas.color_.id());
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, canvas.size_.width, canvas.size_.height, 0, GL_RGBA,
                 GL_UNSIGNED_BYTE, nullptr);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glBindTexture(GL_TEXTURE_2D, 0);
    canvas.framebuffer_ = GlFramebuffer::make();
    glBindFramebuffer(GL_FRAMEBUFFER, canvas.framebuffer_.id());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, canvas.color_.id(),
                           0);
    canvas.depth_ = GlRenderbuffer::make();
    make_storage(canvas.depth_, GL_DEPTH24_STENCIL8, canvas.size_, 1);
    attach(GL_DEPTH_STENCIL_ATTACHMENT, canvas.depth_);
    bool complete = is_complete();
    if (canvas.samples_ > 1) {
        canvas.many_ = GlFramebuffer::make();
        glBindFramebuffer(GL_FRAMEBUFFER, canvas.many_.id());
        canvas.many_color_ = GlRenderbuffer::make();
        make_storage(canvas.many_color_, GL_RGBA8, canvas.size_, canvas.samples_);
        attach(GL_COLOR_ATTACHMENT0, canvas.many_color_);
        canvas.many_depth_ = GlRenderbuffer::make();
        make_storage(canvas.many_depth_, GL_DEPTH24_STENCIL8, canvas.size_, canvas.samples_);
        attach(GL_DEPTH_STENCIL_ATTACHMENT, canvas.many_depth_);
        complete = complete && is_complete();
    }
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    if (!complete)
        return core::fail(core::ErrorCode::unsupported,
                          "the graphics driver has no room for a picture of that size");
    return canvas;
}

void Canvas::begin() {
    glBindFramebuffer(GL_FRAMEBUFFER, samples_ > 1 ? many_.id() : framebuffer_.id());
    glViewport(0, 0, size_.width, size_.height);
}

void Canvas::finish() {
    if (samples_ > 1) {
        glBindFramebuffer(GL_READ_FRAMEBUFFER, many_.id());
        glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.id());
        glBlitFramebuffer(0, 0, size_.width, size_.height, 0, 0, size_.width, size_.height,
                          GL_COLOR_BUFFER_BIT, GL_NEAREST);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

Image Canvas::pixels() const {
    Image image{size_.width, size_.height, {}};
    const size_t row = 4 * static_cast<size_t>(size_.width);
    std::vector<uint8_t> upwards(row * static_cast<size_t>(size_.height));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.id());
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, size_.width, size_.height, GL_RGBA, GL_UNSIGNED_BYTE, upwards.data());
    glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    image.rgba.resize(upwards.size());
    for (size_t y = 0; y < static_cast<size_t>(size_.height); ++y)
        std::copy_n(&upwards[y * row], row,
                    &image.rgba[(static_cast<size_t>(size_.height) - 1 - y) * row]);
    return image;
}

} // namespace render
