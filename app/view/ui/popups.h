#pragma once

#include <string>

#include "app/view/ui/setup_popup.h"

namespace app::viewer {

/// What lies on top of the other panels: keys, going to a line, opening a file, what-ifs, settings.
class PopupPanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;

private:
    void draw_go_to_line(Frame& frame);
    void draw_open_file(Frame& frame);
    void draw_breakpoint(Frame& frame);
    void draw_what_if(Frame& frame);
    void draw_lengths(Frame& frame, const core::Setup& setup);
    void draw_fixture(Frame& frame, const core::Setup& setup);

    std::string line_, path_, condition_;
    Popup shown_ = Popup::none;
    SetupPopup setup_;
    // of what-ifs
    size_t fixture_ = 0;
    double length_ = 0.0, table_length_ = 0.0, allowance_ = 0.0, by_[3] = {0.0, 0.0, 0.0};
    int table_number_ = 1, offset_ = 0, axis_ = 2;
    double origin_ = 0.0;
};

/// What stands in the middle while there is no program.
class WelcomePanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;
};

/// Why a program, a set-up or a mesh could not be opened, and what can be done.
class ErrorPanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;
};

} // namespace app::viewer
