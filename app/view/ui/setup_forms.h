#pragma once

#include <array>
#include <functional>
#include <span>
#include <string>

#include "app/setup/stated_setup.h"
#include "app/setup/toml_edit.h"
#include "app/view/ui/setup_fields.h"
#include "core/base/ids.h"

namespace app {
struct MachinePreset;
struct SetupSheet;
struct SheetOffset;
struct SheetTool;
} // namespace app

namespace app::viewer {

/// The fields of the thing that is selected in the set-up.
class SetupForms {
public:
    /// `below`: room that is left free at the bottom of the panel.
    void draw(Frame& frame, float below);

    bool wants_name =
        false; // the name of the fixture, or the number of the tool, gets the keyboard

private:
    void draw_item(Frame& frame);
    void draw_item_head(Frame& frame, const std::string& title, bool can_copy, bool can_delete);
    /// Limits and sizes that the set-up states, or else all others.
    void draw_machine_sizes(Frame& frame, const MachinePreset& machine, bool first);
    void draw_machine_preset(Frame& frame);
    void draw_machine(Frame& frame);
    void draw_offset(Frame& frame, const SheetOffset& offset);
    void draw_stock(Frame& frame);
    void draw_assumed_stock(Frame& frame, const SetupSheet& sheet);
    void draw_fixture(Frame& frame, const StatedBody& body);
    void draw_part(Frame& frame, const StatedBody& body);
    void draw_preset_sizes(Frame& frame, const StatedBody& body, const TomlPath& path,
                           std::span<const PresetParameter> parameters);
    void draw_preset(Frame& frame, const StatedBody& body, const TomlPath& path);
    void draw_shape(Frame& frame, const StatedBody& body, const TomlPath& path);
    void draw_kinds(Frame& frame, int kind, const char* file,
                    const std::function<void(int)>& choose);
    bool draw_cylinder(Frame& frame, StatedBody::Cylinder& round);
    void draw_pose(Frame& frame, const StatedBody& body, const TomlPath& path);
    void draw_placing(Frame& frame, const std::string& body);
    void draw_face_lists(Frame& frame, const std::string& body);
    void draw_zero(Frame& frame, const std::string& offset);
    void draw_tool(Frame& frame, const SheetTool& shown);
    void draw_tool_sizes(Frame& frame, const SheetTool& shown);
    void draw_holder(Frame& frame, const SheetTool& shown);
    void draw_holder_length(Frame& frame, const SheetTool& shown, const std::string& name);
    void draw_library(Frame& frame, core::ToolNumber number);
    void draw_allowance(Frame& frame);
    void draw_pair_allowances(Frame& frame);

    std::optional<double> grip_; // mm in the jaws of a vise; empty: as usual
    SetupFields fields_;
    // of the lists of faces
    std::string listed_body_, other_body_;
    std::array<std::string, 2> pair_; // for which a minimum clearance is to be added
    size_t own_face_ = 0, other_face_ = 0;
    int zero_[3] = {0, 0, 2}; // corner of the stock: least, middle, greatest
};

} // namespace app::viewer
