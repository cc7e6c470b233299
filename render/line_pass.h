#pragma once

#include <span>
#include <vector>

#include "render/camera.h"
#include "render/gl_objects.h"
#include "render/tool_path.h"
#include "render/view_frame.h"

namespace render {

/// Pieces of a path on the graphics card, in textures of a size that every card supports.
class GpuLines {
public:
    static constexpr size_t chunk = 65535; // pieces per texture

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

/// The path with fewer points; every removed point is within `tolerance` of the new path. Pieces
/// are merged only if they have the same state and both or neither are rapids; the result belongs
/// to the last of their blocks.
std::vector<PathPoint> simplified(const std::vector<PathPoint>& points, double tolerance);

/// Points first .. last - 1 of a path.
struct PathRange {
    size_t first = 0, last = 0;

    bool operator==(const PathRange&) const = default;
};

/// The ranges of a path that may be visible in a picture, in order; adjacent ranges are merged.
std::vector<PathRange> visible_ranges(const ToolPath& path, const Mat4& clip_from_scene);

/// The size of a pixel where the path is nearest to the eye, mm.
double nearest_pixel(const ToolPath& path, const Camera& camera, const Viewport& viewport);

/// Draws the path, and lines on top of everything.
class LinePass {
public:
    static core::Result<LinePass> make();

    void draw_path(const ViewFrame& frame);
    /// A polyline over everything else, with a dark border.
    void draw_over(const ViewFrame& frame, const std::vector<Vec3>& points, Color color,
                   double pixels);

private:
    void bring(const SharedPath& path);
    void set_inks(const ViewFrame& frame) const;
    void draw_block(const ViewFrame& frame, uint32_t block, double wider) const;

    ShaderProgram lines_;
    /// The path with fewer points, for pictures in which the difference is invisible.
    struct Level {
        double tolerance = 0.0; // mm
        SharedPath path;
        GpuLines lines;
    };
    const Level& level_for(const ViewFrame& frame) const;
    void draw_visible(const ViewFrame& frame, const Level& level) const;

    SharedPath shown_;
    std::vector<Level> levels_; // the path itself first
    GpuLines urgent_;           // the pieces with near misses or violations, drawn last
    GpuLines over_;
};

} // namespace render
