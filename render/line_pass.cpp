#include "render/line_pass.h"

#include <limits>

#include <epoxy/gl.h>

#include "render/shaders.h"

namespace render {
namespace {

bool is_urgent(const PathPoint& p) {
    return p.state == ClearanceState::near || p.state == ClearanceState::violation;
}

/// The urgent pieces alone.
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

/// Paths of fewer points are always drawn as they are.
constexpr size_t short_path = 5000;

constexpr double path_share = 6e-4, block_share = 9e-4;

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

/// The one with the fewest points that looks the same.
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
    const Theme theme = frame.options.theme;
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
    lines_.set("nearer", nearer(frame.camera, path_share));
    lines_.set_sampler("points", 0);
}

void LinePass::draw_block(const ViewFrame& frame, uint32_t block, double wider) const {
    const auto [first, last] = points_of_block(*shown_, block);
    if (first == last) return;
    const auto scale = static_cast<float>(frame.options.scale);
    lines_.set("nearer", nearer(frame.camera, block_share));
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
    for (const Vec3& p : points) ends.push_back({.place = glm::vec3(p)});
    over_.fill(ends);
    set_inks(frame);
    glDisable(GL_CULL_FACE);
    const bool dark = frame.options.theme == Theme::dark;
    for (const bool seam : {true, false}) {
        lines_.set("ink",
                   seam ? (dark ? Color{12, 15, 19, 200} : Color{255, 255, 255, 220}) : color);
        const double half = 0.5 * pixels + (seam ? 1.4 : 0.0);
        lines_.set("wider", static_cast<float>((half - 0.55) * frame.options.scale));
        over_.draw(0, over_.size());
    }
}

} // namespace render
