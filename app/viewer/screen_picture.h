#pragma once

#include <filesystem>

#include "render/image.h"

namespace app::viewer {

/// What the window's own framebuffer shows. Needs its context to be current.
render::Image screen_picture(int width, int height);

/// A file of a folder that does not exist yet: feeler-0001.png and so on.
std::filesystem::path free_picture_name(const std::filesystem::path& folder);

} // namespace app::viewer
