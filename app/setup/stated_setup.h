#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/setup/presets/preset.h"
#include "app/setup/toml_edit.h"
#include "core/base/ids.h"
#include "core/base/vec.h"
#include "gcode/language/modal_state.h"

namespace core {
struct ToolSize;
} // namespace core

namespace app {

/// A body as the text of a set-up states it, in mm whatever the unit of the text. Frame: `frame`.
struct StatedBody {
    struct Cylinder {
        double radius = 0.0, height = 0.0;
        int axis = 2;
    };

    std::string name; // of a fixture
    std::optional<core::Aabb> box;
    std::optional<Cylinder> cylinder;
    std::string mesh, model;                             // files
    std::string preset;                                  // its name, known or not
    PresetValues preset_values;                          // those that are stated, mm or counts
    std::string solid;                                   // of a CAD file; empty: all
    std::optional<double> mesh_deviation;                // of a CAD file, mm
    gcode::LengthUnit mesh_unit = gcode::LengthUnit::mm; // of the mesh file
    core::Vec3 at = core::Vec3(0.0), rotate_deg = core::Vec3(0.0);
    std::string frame = "G54";
    bool expendable = false, moves = false;  // moves: it has a [[fixture.move]]
    std::optional<double> tolerance, margin; // mm
    uint32_t line = 0;                       // of its header

    bool has_shape() const {
        return box || cylinder || !mesh.empty() || !model.empty() || !preset.empty();
    }
};

/// An `[[allowance]]` between two bodies or kinds of bodies.
struct StatedAllowance {
    size_t index = 0; // of all `[[allowance]]`
    std::array<std::string, 2> between;
    std::optional<double> distance; // mm
};

/// What the text of a set-up states, for editing it.
struct StatedSetup {
    std::optional<StatedBody> stock, part;
    std::vector<StatedBody> fixtures;
    std::vector<core::ToolNumber> tools;
    std::vector<std::string> offsets;          // names as written
    std::map<std::string, core::Vec3> origins; // of the offsets; 0 for an axis that is not stated
    std::vector<StatedAllowance> allowances;   // without the general one
    std::string machine_file, machine_preset, ini, tool_library;
    PresetValues machine_values;                           // stated sizes of that preset, mm or deg
    bool has_no_fixtures = false;                          // fixtures = "none"
    gcode::LengthUnit length_unit = gcode::LengthUnit::mm; // of the text

    /// Null if it states none of this name.
    const StatedBody* fixture(const std::string& name) const;
    bool has_tool(core::ToolNumber number) const;
    bool has_offset(const std::string& name) const;
};

/// The key that states a work offset, which may have another of its names: "G505" for "G58". A new
/// one has the name itself.
TomlPath path_of_offset(const std::string& text, const std::string& name);

/// A size that the text of a set-up states of a tool, mm or degrees; empty if it does not.
std::optional<double> stated_tool_size(const std::string& text, core::ToolNumber number,
                                       const core::ToolSize& size);

/// Reads a text that may be in the middle of an edit: wrong values are left out. Text that is not
/// TOML gives an empty set-up.
StatedSetup stated_in(const std::string& text);

} // namespace app
