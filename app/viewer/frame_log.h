#pragma once

#include <filesystem>
#include <fstream>

#include "app/viewer/view_model.h"

namespace app::viewer {

/// Writes down when keys came and frames were drawn, to measure how fast the window is. Times are
/// seconds since 1970.
///
///     key TIME CODE
///     frame BEGIN END CURSOR SHOWN PATH    the cursor's block, the block whose stock is shown (-1:
///                                          none yet), points of the path
class FrameLog {
public:
    /// Nothing is written where the path is empty.
    explicit FrameLog(const std::filesystem::path& path);

    void key(int code);
    /// Before and after a frame was drawn.
    void begin_frame();
    void end_frame(const ViewModel& model);

private:
    std::ofstream file_;
    double begin_ = 0.0;
};

} // namespace app::viewer
