#pragma once

#include "app/session/setup_sheet.h"
#include "app/session/tool_field.h"
#include "app/viewer/panel.h"

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

} // namespace app::viewer
