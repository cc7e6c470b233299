#include "render/renderer.h"

#include <algorithm>
#include <array>

#include <epoxy/gl.h>
#include <fmt/format.h>

#include "render/body_pass.h"
#include "render/ground.h"
#include "render/ground_pass.h"
#include "render/line_pass.h"
#include "render/shaders.h"

namespace render {
namespace {

void make_storage(const GlRenderbuffer& buffer, GLenum format, const Viewport& size, int samples) {
    glBindRenderbuffer(GL_RENDERBUFFER, buffer.id());
    if (samples > 1)
        glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, size.width, size.height);
    else
        glRenderbufferStorage(GL_RENDERBUFFER, format, size.width, size.height);
}

void attach(GLenum attachment, const GlRenderbuffer& buffer) {
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer.id());
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
                          "the graphics driver has no memory for a picture of that size");
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

namespace {

/// The initial state of all passes, independent of earlier state.
void set_state() {
    glActiveTexture(GL_TEXTURE0);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_STENCIL_TEST);
    glDisable(GL_BLEND);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_TRUE);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glFrontFace(GL_CCW);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    glClearColor(0.0F, 0.0F, 0.0F, 1.0F);
}

} // namespace

namespace {

constexpr double head_length = 2.6; // of the cone of an arrow, per radius

/// The box of everything that the near and far planes must enclose, marks of constant size
/// included.
core::Aabb content_of(const Scene& scene, const Camera& camera, const Viewport& viewport,
                      double scale) {
    constexpr double mark_pixels = 120.0;
    core::Aabb box = bounds(scene);
    const auto add_mark = [&](const Vec3& at) {
        const double reach = mark_pixels * std::max(pixel_size(camera, viewport, at), 0.0);
        box.extend(core::Aabb{at, at}.grown(reach));
    };
    for (const Triad& triad : scene.triads) add_mark(triad.origin);
    if (scene.witness) add_mark(scene.witness->a);
    if (scene.ground) box.extend(ground_bounds(*scene.ground, camera, viewport, scale));
    return box;
}

} // namespace

struct Renderer::Parts {
    ShaderProgram background;
    BodyPass bodies;
    LinePass lines;
    GroundPass ground;
    AmbientOcclusionPass hollows;
    GlVertexArray no_attributes;

    void draw_background(ColorScheme theme) const;
    void draw_witness(const ViewFrame& frame);
    void draw_depth(const ViewFrame& frame, const Witness& witness, Color ink);
    void draw_triad(const ViewFrame& frame, const Triad& triad);
    void draw_measured(const ViewFrame& frame);
};

void Renderer::Parts::draw_background(ColorScheme theme) const {
    background.use();
    background.set_rgb("top", color(theme, Role::view_top));
    background.set_rgb("bottom", color(theme, Role::view_bottom));
    glBindVertexArray(no_attributes.id());
    glDepthMask(GL_FALSE);
    glDisable(GL_DEPTH_TEST);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
}

void Renderer::Parts::draw_witness(const ViewFrame& frame) {
    if (!frame.scene.witness) return;
    const Witness& witness = *frame.scene.witness;
    if (witness.is_contact)
        return bodies.draw_mark(frame, witness.a, 3.0 * frame.options.scale,
                                color(frame.options.theme, Role::dim));
    const Color ink = state_color(frame.options.theme, witness.state);
    if (witness.is_depth) return draw_depth(frame, witness, ink);
    lines.draw_over(frame, {witness.a, witness.b}, ink, 3.0);
    for (const Vec3& end : {witness.a, witness.b})
        bodies.draw_mark(frame, end, 4.8 * frame.options.scale, ink);
}

/// A dimension line through the overlap, with an arrow head at both ends.
void Renderer::Parts::draw_depth(const ViewFrame& frame, const Witness& witness, Color ink) {
    const Vec3 way = witness.b - witness.a;
    const double length = glm::length(way);
    if (!(length > 0.0)) return bodies.draw_mark(frame, witness.a, 4.8 * frame.options.scale, ink);
    lines.draw_over(frame, {witness.a, witness.b}, ink, 3.0);
    const double most = length / (2.2 * head_length)
                        / pixel_size(frame.camera, frame.viewport, 0.5 * (witness.a + witness.b));
    const double pixels = std::min(5.0 * frame.options.scale, most);
    for (const bool first : {true, false}) {
        const Vec3 outwards = (first ? -1.0 : 1.0) / length * way;
        const Vec3& end = first ? witness.a : witness.b;
        const double size = pixels * pixel_size(frame.camera, frame.viewport, end);
        bodies.draw_arrow_head(frame, end - head_length * size * outwards, outwards, pixels, ink);
    }
}

void Renderer::Parts::draw_triad(const ViewFrame& frame, const Triad& triad) {
    const double pixel = pixel_size(frame.camera, frame.viewport, triad.origin);
    if (!(pixel > 0.0)) return; // behind the eye
    const ColorScheme theme = frame.options.theme;
    const double length = length_in_pixels(triad) * frame.options.scale;
    const std::array<Role, 3> roles = {Role::axis_x, Role::axis_y, Role::axis_z};
    for (int axis = 0; axis < 3; ++axis) {
        Color ink = color(theme, roles[static_cast<size_t>(axis)]);
        if (triad.is_minor) ink = mixed(ink, color(theme, Role::dim), 0.5);
        const Vec3 end = triad.origin + length * pixel * triad.axes[axis];
        lines.draw_over(frame, {triad.origin, end}, ink, triad.is_minor ? 1.6 : 2.4);
        bodies.draw_arrow_head(frame, end, triad.axes[axis],
                               (triad.is_minor ? 3.2 : 4.4) * frame.options.scale, ink);
    }
    bodies.draw_mark(frame, triad.origin, 3.4 * frame.options.scale, color(theme, Role::text));
}

void Renderer::Parts::draw_measured(const ViewFrame& frame) {
    const Color ink = color(frame.options.theme, Role::accent);
    lines.draw_over(frame, frame.scene.measured, ink, 2.0);
    for (const Vec3& point : frame.scene.measured)
        bodies.draw_mark(frame, point, 4.5 * frame.options.scale, ink);
}

Renderer::Renderer(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

core::Result<Renderer> Renderer::make() {
    if (epoxy_gl_version() < 33)
        return core::fail(core::ErrorCode::unsupported,
                          fmt::format("OpenGL 3.3 is required, this is {}.{}: install a newer "
                                      "graphics driver or Mesa's libgl1-mesa-dri",
                                      epoxy_gl_version() / 10, epoxy_gl_version() % 10));
    auto parts = std::make_unique<Parts>();
    FEELER_TRY(parts->background,
               ShaderProgram::make(shaders::background_vertex, shaders::background_fragment));
    FEELER_TRY(parts->bodies, BodyPass::make());
    FEELER_TRY(parts->lines, LinePass::make());
    FEELER_TRY(parts->ground, GroundPass::make());
    FEELER_TRY(parts->hollows, AmbientOcclusionPass::make());
    parts->no_attributes = GlVertexArray::make();
    return Renderer(std::move(parts));
}

void Renderer::draw(const Scene& scene, const Camera& camera, const DrawOptions& options,
                    Canvas& canvas) {
    const Viewport viewport = canvas.size();
    ViewFrame frame{
        scene,
        camera,
        options,
        viewport,
        view_from_scene(camera),
        clip_from_view(camera, viewport, content_of(scene, camera, viewport, options.scale))};
    set_state();
    if (options.hollows) frame.hollows = parts_->hollows.draw(frame, parts_->bodies);
    canvas.begin();
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
    parts_->draw_background(options.theme);
    parts_->bodies.draw_opaque(frame);
    parts_->ground.draw(frame);
    parts_->lines.draw_path(frame);
    parts_->bodies.draw_glass(frame);
    glDisable(GL_DEPTH_TEST);
    for (const Triad& triad : scene.triads) parts_->draw_triad(frame, triad);
    parts_->draw_measured(frame);
    parts_->draw_witness(frame);
    glEnable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glBindVertexArray(0);
    glUseProgram(0);
    parts_->bodies.end_picture();
    canvas.finish();
}

core::Result<Image> still_picture(Renderer& renderer, const Scene& scene, const Camera& camera,
                                  const DrawOptions& options, const Viewport& size) {
    FEELER_TRY(Canvas canvas, Canvas::make({2 * size.width, 2 * size.height}, 4));
    DrawOptions twice = options;
    twice.scale *= 2.0;
    twice.hollows = true;
    renderer.draw(scene, camera, twice, canvas);
    return halved(canvas.pixels());
}

} // namespace render
