#pragma once

#include <vector>

#include "render/gpu_lines.h"
#include "render/path_levels.h"
#include "render/view_frame.h"

namespace render {

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
