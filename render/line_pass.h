#pragma once

#include <span>
#include <vector>

#include "render/camera.h"
#include "render/gl_objects.h"
#include "render/tool_path.h"
#include "render/view_frame.h"

namespace render {

/// Pieces of a path on the graphics card, in textures of as many points as every card takes.
class GpuLines {
public:
    static constexpr size_t chunk = 65535; // pieces to a texture

    void fill(std::span<const PathPoint> points);
    /// Draws the pieces that end at points first .. last - 1 with the program in use.
    void draw(size_t first, size_t last) const;
    size_t size() const { return size_; }

private:
    struct Chunk {
        GlBuffer buffer;
        GlTexture texture;
    };
    std::vector<Chunk> chunks_;
    size_t size_ = 0;
    GlVertexArray no_attributes_;
};

/// The path with fewer points: none that was left out is farther than `tolerance` from the piece
/// that passes it by. Pieces become one only if they are of one state and both rapids or not; it
/// belongs to the last of their blocks.
std::vector<PathPoint> simplified(const std::vector<PathPoint>& points, double tolerance);

/// Points first .. last - 1 of a path, whose pieces are drawn.
struct PathRange {
    size_t first = 0, last = 0;

    bool operator==(const PathRange&) const = default;
};

/// The stretches of a path that may be seen in a picture, in order, those side by side as one.
std::vector<PathRange> visible_ranges(const ToolPath& path, const Mat4& clip_from_scene);

/// Millimetres that a pixel covers where the path is nearest to the eye.
double nearest_pixel(const ToolPath& path, const Camera& camera, const Viewport& viewport);

/// Draws the path, and lines that nothing hides.
class LinePass {
public:
    static core::Result<LinePass> make();

    void draw_path(const ViewFrame& frame);
    /// A line through points over all else, with a dark seam.
    void draw_over(const ViewFrame& frame, const std::vector<Vec3>& points, Color color,
                   double pixels);

private:
    void bring(const SharedPath& path);
    void set_inks(const ViewFrame& frame) const;
    void draw_block(const ViewFrame& frame, uint32_t block, double wider) const;

    ShaderProgram lines_;
    /// The path with fewer points, for pictures in which nobody can tell.
    struct Level {
        double tolerance = 0.0; // mm
        SharedPath path;
        GpuLines lines;
    };
    const Level& level_for(const ViewFrame& frame) const;
    void draw_visible(const ViewFrame& frame, const Level& level) const;

    SharedPath shown_;
    std::vector<Level> levels_; // the path itself first
    GpuLines urgent_; // the pieces that are near or in violation, again: they are drawn last
    GpuLines over_;
};

} // namespace render
