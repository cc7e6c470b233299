#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/view/model/finding_group.h"
#include "app/view/model/samples.h"
#include "app/view/ui/panel.h"

namespace core {
struct Setup;
} // namespace core

namespace render {
class Renderer;
} // namespace render

namespace app::viewer {

enum class Popup : uint8_t;
struct RecentProgram;

/// The tabs of the open programs, along the upper edge if there are several.
class TabStrip : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;

    /// Its height, pixels; 0 for a single program.
    static float height_of(const Frame& frame);
};

/// The toolbar along the upper edge.
class ToolbarPanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;
};

/// The lines of the program as executed, each with its clearance.
class ProgramPanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;

private:
    void draw_head(Frame& frame, const Area& area);
    void draw_filter_note(Frame& frame);
    /// Scrolls to the cursor if it is not visible.
    void follow_cursor(Frame& frame);
    void draw_rows(Frame& frame);
    void draw_row(Frame& frame, size_t block, float width);

    float scroll_ = 0.0F, room_ = 0.0F; // pixels, of the rows in the last frame
};

/// The findings, grouped by rule and pair of bodies, with the notes on them.
class FindingsPanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;

private:
    void draw_group(Frame& frame, size_t index, const std::optional<StretchIndex>& selected);
    void draw_stretch(Frame& frame, const StretchIndex& which, bool is_selected);
    void draw_note(Frame& frame, const StretchIndex& which);

    std::optional<StretchIndex> scrolled_to_, noted_;
    uint64_t typed_from_ = 0; // number of the opened program
    std::string typed_;
};

/// Draws the tabs of the lists and the set-up on the left.
void draw_list_tabs(Frame& frame);
/// Draws the numbers of errors, of warnings and of all blocks next to them.
void draw_counts(Frame& frame, const Area& area);

/// The current block: clearance, pair, state, findings. Below it, the program as a whole.
class InspectorPanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;

private:
    std::string watch_;
};

/// The coprocessor: its answer for the current block, and its state at that time.
class DevicePanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;
};

/// The least clearance of every block, along the lower edge of the window. Below it the slack, if a
/// device was run.
class TimelinePanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;

private:
    bool scrubbing_ = false;
};

/// The 3D view: machine, stock, path, and the witness line with its clearance. The picture is
/// stored in a texture and redrawn only after a change.
class ScenePanel : public Panel {
public:
    explicit ScenePanel(render::Renderer renderer);
    ~ScenePanel() override;

    void draw(Frame& frame, const Area& area) override;
    /// Samples per pixel. 4: smooth edges, for pictures; 1: fast.
    void set_samples(int samples);

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The controls of the section along the lower edge of the view: direction, position, side. Returns
/// their height with a border; 0 without a section, or if the view is too small.
float draw_section_bar(Frame& frame, const Area& view);

/// The set-up as a tree, and the fields of the selected thing. An edit takes effect when its field
/// is left.
class SetupPanel : public Panel {
public:
    SetupPanel();
    ~SetupPanel() override;
    void draw(Frame& frame, const Area& area) override;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The file browser in the current ImGui window, which it fills.
void draw_file_browser(Frame& frame);

/// While the browser is open, the page keys belong to its list and not to ImGui's navigation.
void claim_page_keys(bool claimed);

/// A program of the recent ones as a row that can be clicked, with a button that takes it off the
/// list if it is missing. `width`: pixels.
void draw_recent(Frame& frame, const RecentProgram& recent, float width);

/// The message of the model, if there is one, in the lower left corner of an area.
void draw_message(const Frame& frame, const Area& area);

/// The dialogs on top of the panels: keys, go to line, open file, what-if, breakpoints, settings,
/// tolerances, unsaved edits.
class PopupPanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;

private:
    void draw_go_to_line(Frame& frame);
    void draw_breakpoint(Frame& frame);
    void draw_what_if(Frame& frame);
    void draw_leaving(Frame& frame);
    void draw_report(Frame& frame);
    void draw_lengths(Frame& frame, const core::Setup& setup);
    void draw_fixture(Frame& frame, const core::Setup& setup);

    std::string line_, condition_;
    Popup shown_{};
    // fields of the what-if dialog
    size_t fixture_ = 0;
    double length_ = 0.0, table_length_ = 0.0, allowance_ = 0.0, by_[3] = {0.0, 0.0, 0.0};
    int table_number_ = 1, offset_ = 0, axis_ = 2;
    double origin_ = 0.0;
};

/// The screen that is shown without a program: recent programs and samples, one click away.
class WelcomePanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;

private:
    std::optional<std::vector<Sample>> samples_; // read when first shown
};

/// The error in a program, set-up or mesh that could not be opened, and what to do.
class ErrorPanel : public Panel {
public:
    void draw(Frame& frame, const Area& area) override;
};

/// All panels and their areas. Needs a current OpenGL context and an ImGui context, but no window,
/// so it can also draw pictures.
class Layout {
public:
    explicit Layout(render::Renderer renderer);
    ~Layout();

    /// Draws everything between ImGui's NewFrame and Render.
    void draw(ViewModel& model, const Fonts& fonts, double now);

    /// Samples per pixel of the 3D view. 4: smooth edges, for pictures; 1: fast.
    void set_samples(int samples);

private:
    /// The areas of the panels; those of hidden panels have width 0.
    struct Parts {
        Area toolbar, list, view, device, inspector, timeline;
    };

    static Parts parts_of(const Frame& frame, const Area& area);
    void draw_body(Frame& frame, const Area& area);
    void draw_splitters(Frame& frame, const Parts& parts);

    TabStrip tabs_;
    ToolbarPanel toolbar_;
    ProgramPanel program_;
    FindingsPanel findings_;
    SetupPanel setup_;
    ScenePanel scene_;
    InspectorPanel inspector_;
    DevicePanel device_;
    TimelinePanel timeline_;
    PopupPanel popups_;
    WelcomePanel welcome_;
    ErrorPanel error_;
};

} // namespace app::viewer
