#pragma once

#include "app/viewer/view_model.h"

namespace app::viewer {

/// The title of the window: it tells the place, for lists of windows and for those who have it read
/// to them; with the coprocessor's panel also what the device says of the block.
std::string window_title(const ViewModel& model);

} // namespace app::viewer
