#pragma once

#include <memory>

#include "app/view/ui/panel.h"

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
    /// Scrolls to the cursor in the frame that is begun, where it is not seen.
    void follow_cursor(Frame& frame);
    void draw_rows(Frame& frame);
    void draw_row(Frame& frame, size_t block, float width);

    float scroll_ = 0.0F, room_ = 0.0F; // pixels, of the rows as they were drawn last
};

/// What was found, grouped by rule and pair of bodies, with what a person has written on it.
class FindingsPanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;

private:
    void draw_group(Frame& frame, size_t index, const std::optional<StretchPlace>& selected);
    void draw_stretch(Frame& frame, const StretchPlace& place, bool is_selected);
    void draw_note(Frame& frame, const StretchPlace& place);

    std::optional<StretchPlace> scrolled_to_, noted_;
    uint64_t typed_from_ = 0; // opening
    std::string typed_;
};

/// The names of the two lists at the left, of which one is shown.
void draw_list_tabs(Frame& frame);

/// What is known of the current block: clearance, pair, state, findings; and of the program.
class InspectorPanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;

private:
    std::string watch_;
};

/// The coprocessor: what it says of the current block, and how it stood then.
class DevicePanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;
};

/// The least clearance of every block, along the lower edge; slack below it where a device was run.
class TimelinePanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;

private:
    bool scrubbing_ = false;
};

} // namespace app::viewer
