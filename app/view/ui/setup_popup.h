#pragma once

#include "app/check/setup_sheet.h"
#include "app/view/ui/panel.h"

namespace app::viewer {

/// A length to be typed, in the unit of the window; whether it was changed. What is not touched
/// keeps every bit.
bool length_field(const Frame& frame, const char* id, double& mm);

/// A small word that says where a value comes from: what a person has stated stands out.
void source_mark(Frame& frame, SetupSource source, bool is_in_heading = false);

/// What is wrong with the field above, or nothing.
void field_refusal(Frame& frame, const std::vector<EditRefusal>& refused,
                   std::optional<core::ToolNumber> tool, std::string_view key);

/// The stock: its shape, corner and size, and where they come from.
void draw_stock_fields(Frame& frame, const SetupSheet& shown, SetupSheet& wanted,
                       const std::vector<EditRefusal>& refused);

/// The general allowance.
void draw_allowance_field(Frame& frame, const SetupSheet& shown, SetupSheet& wanted,
                          const std::vector<EditRefusal>& refused);

/// What a row is about; its field stands beside it.
void field_name(Frame& frame, const std::string& name, double width = 150.0);

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
