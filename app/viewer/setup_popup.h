#pragma once

#include "app/viewer/setup_fields.h"

namespace app::viewer {

/// The set-up to be read, edited, checked with and saved. What is typed changes nothing until it is
/// applied, and is applied only when all of it can be.
class SetupPopup {
public:
    void draw(Frame& frame);

private:
    void begin(const std::shared_ptr<const SetupSheet>& sheet);
    void draw_tools(Frame& frame);
    void draw_tool(Frame& frame, size_t index);
    void draw_buttons(Frame& frame);
    void draw_saving(Frame& frame);
    /// The edits, if all of them can be made; else the mistakes are shown.
    std::optional<SetupEdits> checked_edits(const ViewModel& model);

    std::shared_ptr<const SetupSheet> shown_; // that `wanted_` began as
    SetupSheet wanted_;
    std::vector<EditRefusal> refused_;
    size_t tool_ = 0;
    bool is_saving_ = false, asks_to_replace_ = false;
    std::string path_, refusal_; // of saving
};

} // namespace app::viewer
