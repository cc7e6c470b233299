#pragma once

#include <imgui.h>

#include "app/viewer/block_row.h"
#include "render/palette.h"

namespace app::viewer {

/// The colours of a theme as ImGui wants them.
struct Look {
    render::Theme theme = render::Theme::dark;

    ImU32 color(render::Role role, double alpha = 1.0) const;
    ImVec4 vector(render::Role role, double alpha = 1.0) const;
    /// Of words. What is too pale for them on white is darker.
    ImU32 ink(render::Role role) const;
    /// A mixture of two roles: the first at share 0.
    ImU32 mixed(render::Role a, render::Role b, double share) const;
    /// Of a block's clearance; `otherwise` where it is clear.
    ImU32 of(const BlockRow& row, render::Role otherwise) const;
};

/// Gives ImGui's current context the colours and sizes of a theme.
void apply_style(const Look& look, double scale);

} // namespace app::viewer
