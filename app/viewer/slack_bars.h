#pragma once

#include "app/viewer/panel.h"

namespace app::viewer {

/// The row of slacks on the timeline; the worst of the blocks that a pixel stands for. The device
/// must have answered.
void draw_slack(Frame& frame, const Area& area);

} // namespace app::viewer
