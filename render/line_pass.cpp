#include "render/line_pass.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include <epoxy/gl.h>

#include "render/shaders.h"

namespace render {
namespace {

using Texel = std::array<uint32_t, 4>;

/// The format of the line shader.
Texel texel_of(const PathPoint& p) {
    return {std::bit_cast<uint32_t>(p.position.x), std::bit_cast<uint32_t>(p.position.y),
            std::bit_cast<uint32_t>(p.position.z),
            p.block << 4U | static_cast<uint32_t>(p.state) << 2U | (p.rapid ? 2U : 0U)
                | (p.begins ? 1U : 0U)};
}

} // namespace

void GpuLines::fill(std::span<const PathPoint> points) {
    chunks_.clear();
    size_ = points.size();
    if (!no_attributes_) no_attributes_ = GlVertexArray::make();
    std::vector<Texel> texels;
    for (size_t first = 0; first + 1 < points.size(); first += chunk) {
        const size_t last = std::min(first + chunk + 1, points.size());
        texels.clear();
        for (size_t i = first; i < last; ++i) texels.push_back(texel_of(points[i]));
        Chunk made{GlBuffer::make(), GlTexture::make()};
        glBindBuffer(GL_TEXTURE_BUFFER, made.buffer.id());
        glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(texels.size() * sizeof(Texel)),
                     texels.data(), GL_STATIC_DRAW);
        glBindTexture(GL_TEXTURE_BUFFER, made.texture.id());
        glTexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32UI, made.buffer.id());
        chunks_.push_back(std::move(made));
    }
}

void GpuLines::draw(size_t first, size_t last) const {
    if (chunks_.empty()) return;
    glBindVertexArray(no_attributes_.id());
    glActiveTexture(GL_TEXTURE0);
    // Piece i goes from point i to point i + 1.
    const size_t from = first > 0 ? first - 1 : 0, to = std::min(last, size_) - 1;
    for (size_t c = 0; c < chunks_.size(); ++c) {
        const size_t begin = std::max(from, c * chunk), end = std::min(to, (c + 1) * chunk);
        if (begin >= end) continue;
        glBindTexture(GL_TEXTURE_BUFFER, chunks_[c].texture.id());
        glDrawArrays(GL_TRIANGLES, static_cast<GLint>(6 * (begin - c * chunk)),
                     static_cast<GLsizei>(6 * (end - begin)));
    }
}

namespace {

/// Maximum number of points that one piece may replace. It bounds the search, which examines all of
/// them again.
constexpr size_t most = 48;

bool go_together(const PathPoint& a, const PathPoint& b) {
    return !b.begins && a.state == b.state && a.rapid == b.rapid;
}

double distance_to(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b) {
    const glm::vec3 by = b - a;
    const float size = glm::dot(by, by);
    const float fraction = size > 0.0F ? std::clamp(glm::dot(p - a, by) / size, 0.0F, 1.0F) : 0.0F;
    return glm::distance(p, a + fraction * by);
}

/// Whether the piece from one point to another is close enough to all points between.
bool approximates(const std::vector<PathPoint>& points, size_t from, size_t to, double tolerance) {
    for (size_t i = from + 1; i < to; ++i)
        if (distance_to(points[i].position, points[from].position, points[to].position) > tolerance)
            return false;
    return true;
}

} // namespace

std::vector<PathPoint> simplified(const std::vector<PathPoint>& points, double tolerance) {
    std::vector<PathPoint> kept;
    if (points.empty()) return kept;
    kept.push_back(points[0]);
    for (size_t at = 0; at + 1 < points.size();) {
        size_t to = at + 1;
        while (to + 1 < points.size() && to - at < most && !points[at + 1].begins
               && go_together(points[to], points[to + 1])
               && approximates(points, at, to + 1, tolerance))
            ++to;
        kept.push_back(points[to]);
        at = to;
    }
    return kept;
}

std::vector<PathRange> visible_ranges(const ToolPath& path, const Mat4& clip_from_scene) {
    std::vector<PathRange> ranges;
    for (size_t g = 0; g < path.groups.size(); ++g) {
        if (!may_be_seen(path.groups[g], clip_from_scene)) continue;
        const size_t end = std::min((g + 1) * ToolPath::group, path.boxes.size());
        for (size_t b = g * ToolPath::group; b < end; ++b) {
            if (!may_be_seen(path.boxes[b], clip_from_scene)) continue;
            const size_t first = b * ToolPath::stretch;
            const size_t last = std::min(first + ToolPath::stretch, path.points.size());
            if (!ranges.empty() && ranges.back().last == first)
                ranges.back().last = last;
            else
                ranges.push_back({first, last});
        }
    }
    return ranges;
}

double nearest_pixel(const ToolPath& path, const Camera& camera, const Viewport& viewport) {
    if (camera.projection == Projection::orthographic || path.bounds.empty())
        return pixel_size(camera, viewport, camera.target);
    const Vec3 nearest = glm::clamp(eye(camera), path.bounds.min, path.bounds.max);
    const double away = glm::distance(nearest, eye(camera));
    return pixel_size(camera, viewport, eye(camera) - away * axes(camera).backward);
}

namespace {

bool is_urgent(const PathPoint& p) {
    return p.state == ClearanceState::near || p.state == ClearanceState::violation;
}

/// Only the pieces with near misses or violations.
std::vector<PathPoint> urgent_pieces(const ToolPath& path) {
    std::vector<PathPoint> pieces;
    bool goes_on = false;
    for (size_t i = 1; i < path.points.size(); ++i) {
        const bool wanted = is_urgent(path.points[i]) && !path.points[i].begins;
        if (wanted && !goes_on) {
            pieces.push_back(path.points[i - 1]);
            pieces.back().begins = true;
        }
        if (wanted) pieces.push_back(path.points[i]);
        goes_on = wanted;
    }
    return pieces;
}

/// Paths with fewer points are never simplified.
constexpr size_t short_path = 5000;

constexpr double path_fraction = 6e-4, block_fraction = 9e-4;

} // namespace

core::Result<LinePass> LinePass::make() {
    LinePass pass;
    FEELER_TRY(pass.lines_, ShaderProgram::make(shaders::line_vertex, shaders::line_fragment));
    return pass;
}

void LinePass::bring(const SharedPath& path) {
    if (path == shown_) return;
    shown_ = path;
    levels_.clear();
    levels_.push_back({0.0, path, {}});
    if (path->points.size() > short_path)
        for (const double tolerance : {0.01, 0.04, 0.16, 0.64})
            levels_.push_back({tolerance,
                               std::make_shared<const ToolPath>(tool_path(
                                   simplified(levels_.back().path->points, 0.75 * tolerance))),
                               {}});
    for (Level& level : levels_) level.lines.fill(level.path->points);
    urgent_.fill(urgent_pieces(*path));
}

/// The level with the fewest points that looks the same.
const LinePass::Level& LinePass::level_for(const ViewFrame& frame) const {
    const double pixel = nearest_pixel(*shown_, frame.camera, frame.viewport);
    size_t best = 0;
    for (size_t i = 1; i < levels_.size(); ++i)
        if (levels_[i].tolerance <= 0.4 * pixel) best = i;
    return levels_[best];
}

void LinePass::draw_visible(const ViewFrame& frame, const Level& level) const {
    for (const PathRange& range :
         visible_ranges(*level.path, frame.clip_from_view * frame.view_from_scene))
        level.lines.draw(range.first, range.last);
}

void LinePass::set_inks(const ViewFrame& frame) const {
    const ColorScheme theme = frame.options.theme;
    const auto scale = static_cast<float>(frame.options.scale);
    lines_.use();
    lines_.set("view_from_scene", frame.view_from_scene);
    lines_.set("clip_from_view", frame.clip_from_view);
    lines_.set("half_size", 0.5F * glm::vec2(frame.viewport.width, frame.viewport.height));
    lines_.set("inks[0]", with_alpha(state_color(theme, ClearanceState::none), 0.8));
    lines_.set("inks[1]", with_alpha(state_color(theme, ClearanceState::clear), 0.95));
    lines_.set("inks[2]", state_color(theme, ClearanceState::near));
    lines_.set("inks[3]", state_color(theme, ClearanceState::violation));
    lines_.set("widths[0]", 0.55F * scale);
    lines_.set("widths[1]", 0.65F * scale);
    lines_.set("widths[2]", 1.2F * scale);
    lines_.set("widths[3]", 1.8F * scale);
    lines_.set("rapid_ink", with_alpha(color(theme, Role::rapid), 0.75));
    lines_.set("ink", Color{0, 0, 0, 0});
    lines_.set("wider", 0.0F);
    lines_.set("later", frame.scene.fade_later_blocks ? 0.55F : 1.0F);
    lines_.set("current", frame.scene.current_block.value_or(std::numeric_limits<uint32_t>::max()));
    lines_.set("nearer", nearer(frame.camera, path_fraction));
    lines_.set_sampler("points", 0);
}

void LinePass::draw_block(const ViewFrame& frame, uint32_t block, double wider) const {
    const auto [first, last] = points_of_block(*shown_, block);
    if (first == last) return;
    const auto scale = static_cast<float>(frame.options.scale);
    lines_.set("nearer", nearer(frame.camera, block_fraction));
    lines_.set("later", 1.0F);
    // A bright core in the colour of its state.
    lines_.set("wider", static_cast<float>(wider) * scale);
    levels_[0].lines.draw(first, last);
    lines_.set("wider", 0.3F * static_cast<float>(wider) * scale);
    lines_.set("ink", color(frame.options.theme, Role::current));
    levels_[0].lines.draw(first, last);
    lines_.set("ink", Color{0, 0, 0, 0});
}

void LinePass::draw_path(const ViewFrame& frame) {
    const Scene& scene = frame.scene;
    if (!scene.path || !scene.path_visible || scene.path->points.size() < 2) return;
    bring(scene.path);
    const Level& level = level_for(frame);
    set_inks(frame);
    glEnable(GL_BLEND);
    glDepthMask(GL_FALSE);
    glDisable(GL_CULL_FACE);
    if (frame.options.path_on_top) {
        glDisable(GL_DEPTH_TEST);
        lines_.set("later", 0.12F);
        lines_.set("current", uint32_t{0});
        draw_visible(frame, level);
        glEnable(GL_DEPTH_TEST);
        set_inks(frame);
    }
    draw_visible(frame, level);
    if (urgent_.size() > 1) urgent_.draw(0, urgent_.size());
    if (scene.current_block) draw_block(frame, *scene.current_block, 2.0);
    if (scene.hovered_block && scene.hovered_block != scene.current_block)
        draw_block(frame, *scene.hovered_block, 1.3);
    glDepthMask(GL_TRUE);
}

void LinePass::draw_over(const ViewFrame& frame, const std::vector<Vec3>& points, Color color,
                         double pixels) {
    if (points.size() < 2) return;
    std::vector<PathPoint> ends;
    ends.reserve(points.size());
    for (const Vec3& p : points) ends.push_back({.position = glm::vec3(p)});
    over_.fill(ends);
    set_inks(frame);
    glDisable(GL_CULL_FACE);
    const bool dark = frame.options.theme == ColorScheme::dark;
    for (const bool seam : {true, false}) {
        lines_.set("ink",
                   seam ? (dark ? Color{12, 15, 19, 200} : Color{255, 255, 255, 220}) : color);
        const double half = 0.5 * pixels + (seam ? 1.4 : 0.0);
        lines_.set("wider", static_cast<float>((half - 0.55) * frame.options.scale));
        over_.draw(0, over_.size());
    }
}

} // namespace render
