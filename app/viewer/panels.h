#pragma once

#include <memory>

#include "app/viewer/panel.h"

namespace app::viewer {

/// Everything that can be done, along the upper edge.
class ToolbarPanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;
};

/// The lines of the program as they are executed, with the clearance of each.
class ProgramPanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;

private:
    void draw_head(Frame& frame, const Area& area);
    void draw_filter_note(Frame& frame);
    void draw_rows(Frame& frame);
    void draw_row(Frame& frame, size_t block, float width);
};

/// What is known of the current block: clearance, pair, state, findings; and of the program.
class InspectorPanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;

private:
    std::string watch_;
};

/// The least clearance of every block, along the lower edge.
class TimelinePanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;

private:
    bool scrubbing_ = false;
};

} // namespace app::viewer
