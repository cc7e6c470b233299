#pragma once

#include "app/viewer/view_model.h"

namespace app::viewer {

/// A view of the closest pair of the current block from where nothing hides it, if there is such a
/// side; the one that turns the camera least. Without a pair the whole block is framed.
///
/// Cost: a ray through the scene for each of some dozens of directions.
render::Camera witness_camera(const ViewModel& model, const render::Viewport& size);

} // namespace app::viewer
