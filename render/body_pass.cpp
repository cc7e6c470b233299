#include "render/body_pass.h"

#include <algorithm>
#include <cstddef>

#include <epoxy/gl.h>

#include "render/body_mesh.h"
#include "render/shaders.h"

namespace render {
namespace {

/// How much of the colour of its side the stock has: its raw and cut faces must stay apart.
constexpr double stock_share = 0.4;

/// Number of pictures after which an unused mesh is freed. Long enough for a turn of the view,
/// during which bricks of the stock come and go.
constexpr uint64_t patience = 90;

template <typename T>
void fill(GLenum target, const GlBuffer& buffer, const std::vector<T>& data) {
    glBindBuffer(target, buffer.id());
    glBufferData(target, static_cast<GLsizeiptr>(data.size() * sizeof(T)), data.data(),
                 GL_STATIC_DRAW);
}

void describe(unsigned index, int size, GLenum type, bool fraction, size_t stride, size_t offset) {
    glEnableVertexAttribArray(index);
    glVertexAttribPointer(index, size, type, fraction ? GL_TRUE : GL_FALSE,
                          static_cast<GLsizei>(stride),
                          reinterpret_cast<const void*>(offset)); // NOLINT: as OpenGL wants it
}

GpuMesh uploaded(const SharedMesh& mesh) {
    GpuMesh made;
    made.of = mesh;
    made.index_count = static_cast<int>(3 * mesh->triangles.size());
    made.line_count = static_cast<int>(2 * mesh->edges.size());
    made.faces = GlVertexArray::make();
    made.vertices = GlBuffer::make();
    made.indices = GlBuffer::make();
    glBindVertexArray(made.faces.id());
    fill(GL_ARRAY_BUFFER, made.vertices, mesh->vertices);
    fill(GL_ELEMENT_ARRAY_BUFFER, made.indices, mesh->triangles);
    constexpr size_t stride = sizeof(MeshVertex);
    describe(0, 3, GL_FLOAT, false, stride, offsetof(MeshVertex, position));
    describe(1, 3, GL_BYTE, true, stride, offsetof(MeshVertex, normal));
    describe(2, 1, GL_UNSIGNED_BYTE, false, stride, offsetof(MeshVertex, tint));
    if (made.line_count > 0) {
        made.lines = GlVertexArray::make();
        made.line_ends = GlBuffer::make();
        glBindVertexArray(made.lines.id());
        fill(GL_ARRAY_BUFFER, made.line_ends, mesh->edges);
        describe(0, 3, GL_FLOAT, false, sizeof(glm::vec3), 0);
    }
    glBindVertexArray(0);
    return made;
}

} // namespace

void GpuMesh::draw_faces() const {
    glBindVertexArray(faces.id());
    glDrawElements(GL_TRIANGLES, index_count, GL_UNSIGNED_INT, nullptr);
}

void GpuMesh::draw_lines() const {
    if (line_count == 0) return;
    glBindVertexArray(lines.id());
    glDrawArrays(GL_LINES, 0, line_count);
}

const GpuMesh& GpuMeshes::of(const SharedMesh& mesh) {
    auto found = meshes_.find(mesh.get());
    if (found == meshes_.end()) found = meshes_.emplace(mesh.get(), uploaded(mesh)).first;
    found->second.used = picture_;
    return found->second;
}

void GpuMeshes::end_picture() {
    std::erase_if(meshes_,
                  [&](const auto& entry) { return entry.second.used + patience < picture_; });
    ++picture_;
}

namespace {

/// The upward direction in the view's frame.
glm::vec3 sky_of(const ViewFrame& frame) {
    return glm::vec3(frame.view_from_scene * glm::dvec4(0.0, 0.0, 1.0, 0.0));
}

double shine_of(const Body* body) {
    if (body == nullptr) return 0.10;
    switch (body->role) {
    case BodyRole::flutes:
    case BodyRole::shank:
    case BodyRole::holder:
    case BodyRole::nose:
        return 0.32;
    default:
        return 0.07;
    }
}

/// Counts, for each pixel, how often the line of sight enters the body beyond the plane minus how
/// often it leaves the body. The difference marks where the plane is inside the body.
void begin_counting() {
    glEnable(GL_STENCIL_TEST);
    glClear(GL_STENCIL_BUFFER_BIT);
    glStencilFunc(GL_ALWAYS, 0, 0xFF);
    glStencilOpSeparate(GL_FRONT, GL_KEEP, GL_KEEP, GL_DECR_WRAP);
    glStencilOpSeparate(GL_BACK, GL_KEEP, GL_KEEP, GL_INCR_WRAP);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glDepthMask(GL_FALSE);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glEnable(GL_CLIP_DISTANCE0);
}

void end_counting() {
    glDisable(GL_CLIP_DISTANCE0);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_TRUE);
    glEnable(GL_DEPTH_TEST);
    glStencilFunc(GL_NOTEQUAL, 0, 0xFF);
    glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
}

bool sees_face(const Camera& camera, const SectionPlane& section) {
    if (camera.projection == Projection::orthographic)
        return glm::dot(section.normal, axes(camera).backward) > 0.0;
    return glm::dot(section.normal, eye(camera)) > section.offset;
}

} // namespace

core::Result<BodyPass> BodyPass::make() {
    BodyPass pass;
    FEELER_TRY(pass.faces_, ShaderProgram::make(shaders::mesh_vertex, shaders::mesh_fragment));
    FEELER_TRY(pass.edges_, ShaderProgram::make(shaders::edge_vertex, shaders::edge_fragment));
    FEELER_TRY(pass.caps_, ShaderProgram::make(shaders::cap_vertex, shaders::cap_fragment));
    pass.no_attributes_ = GlVertexArray::make();
    pass.ball_ = std::make_shared<const TriangleMesh>(ball_mesh(1.0, 12));
    pass.cone_ = std::make_shared<const TriangleMesh>(
        mesh_of(core::RevolvedProfile{{{0.0, 1.0, 2.6, 0.0, 0.0}}}));
    return pass;
}

BodyPass::Item BodyPass::item(const ViewFrame& frame, const Body& body, bool is_ghost) const {
    const ColorScheme theme = frame.options.theme;
    Item made{&body, body.stock_from_body,        bounds(body), color(theme, color_role(body.role)),
              {},    is_ghost ? 0.28 : body.alpha};
    if (is_ghost) made.color = mixed(made.color, color(theme, Role::accent), 0.6);
    if (body.side != PairSide::none) made.color = color(theme, color_role(body.side));
    made.second = made.color;
    const auto& section = frame.scene.section;
    made.cut = section && is_cut_by_section(frame.scene, body.role);
    made.closed = body.mesh->closed;
    return made;
}

BodyPass::Item BodyPass::stock_item(const ViewFrame& frame) const {
    const ColorScheme theme = frame.options.theme;
    Item made;
    for (const auto& brick : frame.scene.stock) made.box.extend(brick->mesh.bounds);
    made.color = color(theme, Role::stock_raw);
    made.second = color(theme, Role::stock_cut);
    if (const PairSide side = frame.scene.stock_side; side != PairSide::none)
        for (Color* paint : {&made.color, &made.second})
            *paint = mixed(*paint, color(theme, color_role(side)), stock_share);
    made.cut = frame.scene.section.has_value();
    return made;
}

template <typename Act>
void BodyPass::for_meshes(const ViewFrame& frame, const Item& item, const Act& act, bool whole) {
    if (item.body != nullptr) {
        const SharedMesh& mesh = item.body->mesh;
        const bool is_rough = frame.options.rough && mesh->rough && !item.cut && !whole;
        return act(meshes_.of(is_rough ? mesh->rough : mesh));
    }
    const Mat4 clip_from_scene = frame.clip_from_view * frame.view_from_scene;
    for (const auto& brick : frame.scene.stock)
        if (may_be_seen(brick->mesh.bounds, clip_from_scene))
            act(meshes_.of(SharedMesh(brick, whole ? &brick->mesh : &brick->drawn)));
}

void BodyPass::set_material(const ViewFrame& frame, const Item& item, bool glass) const {
    const bool dark = frame.options.theme == ColorScheme::dark;
    faces_.use();
    set_view(faces_, frame, item.pose);
    faces_.set("sky", sky_of(frame));
    faces_.set("eye_axis", frame.camera.projection == Projection::orthographic
                               ? glm::vec3(0.0F, 0.0F, 1.0F)
                               : glm::vec3(0.0F));
    faces_.set("rim", dark ? Color{206, 218, 236, 70} : Color{64, 78, 98, 90});
    faces_.set("glass", glass ? 1.0F : 0.0F);
    const bool hollows = frame.hollows != 0 && !glass;
    faces_.set("to_hollows", hollows ? 1.0F / glm::vec2(frame.viewport.width, frame.viewport.height)
                                     : glm::vec2(0.0F));
    faces_.set_sampler("hollows", 0);
    if (hollows) glBindTexture(GL_TEXTURE_2D, frame.hollows);
    faces_.set("alpha", static_cast<float>(item.alpha));
    faces_.set("shine", static_cast<float>(shine_of(item.body)));
    faces_.set_rgb("colors[0]", item.color);
    faces_.set_rgb("colors[1]", item.second);
}

void BodyPass::draw_faces(const ViewFrame& frame, const Item& item) {
    set_material(frame, item, false);
    set_section(faces_, item.cut ? frame.scene.section : std::nullopt, item.pose);
    (item.cut ? glEnable : glDisable)(GL_CLIP_DISTANCE0);
    (item.cut || !item.closed ? glDisable : glEnable)(GL_CULL_FACE);
    glCullFace(GL_BACK);
    for_meshes(frame, item, [](const GpuMesh& mesh) { mesh.draw_faces(); });
}

void BodyPass::draw_edges(const ViewFrame& frame, const Item& item) {
    const bool marked = item.body != nullptr && item.body->side != PairSide::none;
    Color ink = color(frame.options.theme, Role::edge);
    if (item.body == nullptr) ink.a = static_cast<uint8_t>(ink.a / 2);
    if (marked) ink = color(frame.options.theme, color_role(item.body->side));
    if (item.alpha < 1.0 && !marked) ink.a = static_cast<uint8_t>(ink.a * 0.55);
    edges_.use();
    set_view(edges_, frame, item.pose);
    set_section(edges_, item.cut ? frame.scene.section : std::nullopt, item.pose);
    (item.cut ? glEnable : glDisable)(GL_CLIP_DISTANCE0);
    edges_.set("nearer", nearer(frame.camera, 2e-4));
    edges_.set("ink", ink);
    glLineWidth(static_cast<float>(frame.options.scale * (marked ? 1.6 : 1.0)));
    for_meshes(frame, item, [](const GpuMesh& mesh) { mesh.draw_lines(); });
}

/// The hatched section face of a body.
void BodyPass::draw_cap(const ViewFrame& frame, const Item& item) {
    const SectionPlane& section = *frame.scene.section;
    if (!item.closed || !is_cut(section, item.box) || !sees_face(frame.camera, section)) return;
    begin_counting();
    set_material(frame, item, false);
    set_section(faces_, section, item.pose);
    // Overlapping parts would be counted twice.
    for_meshes(
        frame, item, [](const GpuMesh& mesh) { mesh.draw_faces(); }, true);
    end_counting();
    const double reach = 0.51 * glm::length(item.box.size());
    const Vec3 middle =
        item.box.center()
        - (glm::dot(section.normal, item.box.center()) - section.offset) * section.normal;
    const Vec3 other = std::abs(section.normal.z) > 0.7 ? Vec3(1, 0, 0) : Vec3(0, 0, 1);
    const Vec3 side = glm::normalize(glm::cross(section.normal, other));
    caps_.use();
    caps_.set("clip_from_scene", frame.clip_from_view * frame.view_from_scene);
    caps_.set("middle", glm::vec3(middle));
    caps_.set("sides[0]", glm::vec3(reach * side));
    caps_.set("sides[1]", glm::vec3(reach * glm::cross(section.normal, side)));
    const Color black{0, 0, 0, 255};
    caps_.set_rgb("base", mixed(item.color, black, 0.22));
    caps_.set("hatch", with_alpha(mixed(item.color, black, 0.62), 0.85));
    caps_.set("spacing", static_cast<float>(11.0 * frame.options.scale));
    glBindVertexArray(no_attributes_.id());
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    glDisable(GL_STENCIL_TEST);
}

std::vector<BodyPass::Item> BodyPass::opaque_items(const ViewFrame& frame) const {
    std::vector<Item> items;
    if (frame.scene.stock_visible && !frame.scene.stock.empty()) items.push_back(stock_item(frame));
    for (const bool is_machine : {false, true})
        for (const Body& body : frame.scene.bodies)
            if (body.visible && body.mesh && body.alpha >= 1.0
                && (body.role == BodyRole::machine) == is_machine)
                items.push_back(item(frame, body, false));
    return items;
}

void BodyPass::draw_depths(const ViewFrame& frame) {
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    edges_.use();
    edges_.set("nearer", glm::vec2(1.0F, 0.0F));
    for (const Item& item : opaque_items(frame)) {
        set_view(edges_, frame, item.pose);
        set_section(edges_, item.cut ? frame.scene.section : std::nullopt, item.pose);
        (item.cut ? glEnable : glDisable)(GL_CLIP_DISTANCE0);
        (item.cut || !item.closed ? glDisable : glEnable)(GL_CULL_FACE);
        glCullFace(GL_BACK);
        for_meshes(frame, item, [](const GpuMesh& mesh) { mesh.draw_faces(); });
    }
    glDisable(GL_CLIP_DISTANCE0);
    glDisable(GL_CULL_FACE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void BodyPass::draw_opaque(const ViewFrame& frame) {
    const std::vector<Item> items = opaque_items(frame);
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1.0F, 1.0F);
    for (const Item& item : items) draw_faces(frame, item);
    glDisable(GL_POLYGON_OFFSET_FILL);
    for (const Item& item : items)
        if (item.cut) draw_cap(frame, item);
    glEnable(GL_BLEND);
    glDepthMask(GL_FALSE);
    if (frame.options.edges)
        for (const Item& item : items) draw_edges(frame, item);
    glDisable(GL_CLIP_DISTANCE0);
    glDepthMask(GL_TRUE);
}

void BodyPass::draw_glass(const ViewFrame& frame) {
    std::vector<Item> items;
    for (const Body& body : frame.scene.bodies)
        if (body.visible && body.mesh && body.alpha < 1.0)
            items.push_back(item(frame, body, false));
    for (const Body& body : frame.scene.ghost)
        if (body.visible && body.mesh) items.push_back(item(frame, body, true));
    const Vec3 from = eye(frame.camera);
    std::stable_sort(items.begin(), items.end(), [&](const Item& a, const Item& b) {
        return glm::distance(a.box.center(), from) > glm::distance(b.box.center(), from);
    });
    glEnable(GL_BLEND);
    glEnable(GL_CULL_FACE);
    glDepthMask(GL_FALSE);
    for (const Item& item : items) {
        set_material(frame, item, true);
        set_section(faces_, item.cut ? frame.scene.section : std::nullopt, item.pose);
        (item.cut ? glEnable : glDisable)(GL_CLIP_DISTANCE0);
        for (const GLenum hidden : {GL_FRONT, GL_BACK}) {
            glCullFace(hidden);
            faces_.set("alpha", static_cast<float>(item.alpha * (hidden == GL_FRONT ? 0.45 : 1.0)));
            for_meshes(frame, item, [](const GpuMesh& mesh) { mesh.draw_faces(); });
        }
        if (frame.options.edges) draw_edges(frame, item);
    }
    glDisable(GL_CLIP_DISTANCE0);
    glDepthMask(GL_TRUE);
}

void BodyPass::draw_symbol(const ViewFrame& frame, const SharedMesh& mesh,
                           const Mat4& scene_from_mesh, Color color) {
    Item made;
    made.color = made.second = color;
    set_material(frame, made, false);
    faces_.set("view_from_body", frame.view_from_scene * scene_from_mesh);
    set_section(faces_, std::nullopt);
    glEnable(GL_CULL_FACE);
    glCullFace(GL_BACK);
    meshes_.of(mesh).draw_faces();
}

void BodyPass::draw_mark(const ViewFrame& frame, const Vec3& at, double pixels, Color color) {
    const double radius = pixels * pixel_size(frame.camera, frame.viewport, at);
    if (!(radius > 0.0)) return; // behind the eye
    draw_symbol(frame, ball_,
                Mat4(glm::dvec4(radius, 0, 0, 0), glm::dvec4(0, radius, 0, 0),
                     glm::dvec4(0, 0, radius, 0), glm::dvec4(at, 1.0)),
                color);
}

void BodyPass::draw_arrow_head(const ViewFrame& frame, const Vec3& at, const Vec3& along,
                               double pixels, Color color) {
    const double radius = pixels * pixel_size(frame.camera, frame.viewport, at);
    if (!(radius > 0.0)) return;
    const Vec3 other = std::abs(along.z) > 0.7 ? Vec3(1, 0, 0) : Vec3(0, 0, 1);
    const Vec3 side = glm::normalize(glm::cross(other, along));
    draw_symbol(frame, cone_,
                Mat4(glm::dvec4(radius * side, 0.0),
                     glm::dvec4(radius * glm::cross(along, side), 0.0),
                     glm::dvec4(radius * along, 0.0), glm::dvec4(at, 1.0)),
                color);
}

namespace {

/// Reach of the ambient occlusion, as a fraction of the visible height at the target.
constexpr double reach_fraction = 0.055;

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

GlFramebuffer framebuffer(GLenum attachment, const GlTexture& texture) {
    GlFramebuffer made = GlFramebuffer::make();
    glBindFramebuffer(GL_FRAMEBUFFER, made.id());
    glFramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture.id(), 0);
    if (attachment == GL_DEPTH_ATTACHMENT) {
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

core::Result<AmbientOcclusionPass> AmbientOcclusionPass::make() {
    AmbientOcclusionPass pass;
    FEELER_TRY(pass.hollows_,
               ShaderProgram::make(shaders::background_vertex, shaders::hollow_fragment));
    FEELER_TRY(pass.smooth_,
               ShaderProgram::make(shaders::background_vertex, shaders::smooth_fragment));
    pass.no_attributes_ = GlVertexArray::make();
    return pass;
}

bool AmbientOcclusionPass::resize(const Viewport& size) {
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

unsigned AmbientOcclusionPass::draw(const ViewFrame& frame, BodyPass& bodies) {
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
    hollows_.set("reach", static_cast<float>(reach_fraction * seen));
    hollows_.set("pixels", static_cast<float>(0.5 * frame.clip_from_view[1][1] * size.height
                                              * reach_fraction * seen));
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
