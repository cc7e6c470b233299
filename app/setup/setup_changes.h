#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "app/setup/toml_edit.h"
#include "core/base/ids.h"
#include "core/base/vec.h"

namespace core {
struct Solid;
struct ToolDescription;
struct ToolSize;
} // namespace core

namespace gcode {
enum class LengthUnit : uint8_t;
}

namespace app {

struct FoundTool;

/// Functions that change the text of a set-up file, one statement at a time. They keep everything
/// else in it, as the functions of toml_edit.h do, whose errors they return. Lengths are mm, and
/// are written in the unit of the text, rounded as by setup_length(); angles are degrees.

/// The place of a body in a set-up: `[stock]`, `[part]` or an element of `[[fixture]]`.
using BodyPath = TomlPath;

/// The fixture with this name; empty if the set-up has none.
std::optional<BodyPath> path_of_fixture(const std::string& text, std::string_view name);
/// The `[[tool]]` with this number.
std::optional<TomlPath> path_of_tool(const std::string& text, core::ToolNumber number);

/// States the stock, a box or a cylinder, in place of the old one, and that it is not assumed. Its
/// frame, tolerance and comments stay.
core::Result<std::string> with_stock(const std::string& text, const core::Solid& stock,
                                     std::string_view frame);

/// Sets the shape of a body to a box, to a cylinder or to the mesh in a file. Position and frame
/// stay.
core::Result<std::string> with_box(const std::string& text, const BodyPath& body,
                                   const core::Aabb& box);
core::Result<std::string> with_cylinder(const std::string& text, const BodyPath& body,
                                        double radius, double height, int axis);
core::Result<std::string> with_mesh(const std::string& text, const BodyPath& body,
                                    const std::string& file);

/// Sets the shape of a body to a preset. Values of parameters that the new preset has too stay,
/// those of others are removed.
///
/// Errors: also invalid_value for a name that no preset has.
core::Result<std::string> with_preset(const std::string& text, const BodyPath& body,
                                      std::string_view name);
/// States a parameter of the preset of a body, in mm or as a count, or leaves it to the preset.
///
/// Errors: also invalid_value if the body has no preset, or the preset no such parameter, or if
///         the value does not fit it.
core::Result<std::string> with_preset_value(const std::string& text, const BodyPath& body,
                                            std::string_view key, std::optional<double> value);

/// States the unit of the mesh file of a body; mm by being silent.
core::Result<std::string> with_mesh_unit(const std::string& text, const BodyPath& body,
                                         gcode::LengthUnit unit);

/// States how far the mesh of a CAD file may be from its surface, mm.
core::Result<std::string> with_mesh_deviation(const std::string& text, const BodyPath& body,
                                              double deviation);

/// Sets `at` and `rotate_deg` of a body. Keys of the value 0 that are not there stay away.
core::Result<std::string> with_pose(const std::string& text, const BodyPath& body,
                                    const core::Vec3& at, const core::Vec3& rotate_deg);

/// Adds a fixture with these lines after its name, such as "box = [[0, 0, 0], [10, 10, 10]]" with
/// lengths in the unit of the text.
/// Removes `fixtures = "none"`.
///
/// Errors: also invalid_value for a name that is taken or that no fixture can have, as in
///         with_copied_fixture and with_renamed_fixture.
core::Result<std::string> with_fixture(const std::string& text, const std::string& name,
                                       const std::string& lines);
/// Adds a copy of a fixture under a new name, without its moves during the program.
core::Result<std::string> with_copied_fixture(const std::string& text, const std::string& name,
                                              const std::string& copy);
/// Removes a fixture.
///
/// Errors: also invalid_value if other bodies are positioned relative to it, or if an allowance
///         names it.
core::Result<std::string> without_fixture(const std::string& text, const std::string& name);
/// Renames a fixture where it is described and wherever it is named.
core::Result<std::string> with_renamed_fixture(const std::string& text, const std::string& name,
                                               const std::string& other);
/// A name that no fixture of the set-up has and that a fixture can have: `name`, or else with a
/// number after it.
std::string free_name(const std::string& text, const std::string& name);

/// Sets one value of a tool, given as TOML, or removes it. A tool that the set-up does not contain
/// is added with this value alone; the rest is inferred.
core::Result<std::string> with_tool_value(const std::string& text, core::ToolNumber number,
                                          const std::string& key,
                                          const std::optional<std::string>& value);
/// Sets a size of a tool in mm or degrees; 0 removes it.
core::Result<std::string> with_tool_size(const std::string& text, core::ToolNumber number,
                                         const core::ToolSize& size, double value);
/// States a tool completely, in place of the old description.
core::Result<std::string> with_tool(const std::string& text, const core::ToolDescription& tool);
/// Adds a tool of which nothing but the number is stated; the rest is assumed.
core::Result<std::string> with_bare_tool(const std::string& text, core::ToolNumber number);
/// States what a source states of a tool, in place of the old description; the rest is assumed. A
/// holder stays if the source has none.
core::Result<std::string> with_found_tool(const std::string& text, const FoundTool& tool);
core::Result<std::string> without_tool(const std::string& text, core::ToolNumber number);
/// Adds a copy of a tool under another number, or gives a tool another one, also where the set-up
/// says which tool is in the spindle at the start.
///
/// Errors: also invalid_value for a number that another tool has, or that no tool can have.
core::Result<std::string> with_copied_tool(const std::string& text, core::ToolNumber number,
                                           core::ToolNumber copy);
core::Result<std::string> with_tool_number(const std::string& text, core::ToolNumber number,
                                           core::ToolNumber other);

/// States the origin of a work offset: machine coordinates of X, Y, Z; its other axes stay. The
/// work offsets are then not assumed.
core::Result<std::string> with_offset(const std::string& text, const std::string& name,
                                      const core::Vec3& origin);
/// Removes a work offset.
///
/// Errors: also invalid_value if bodies are positioned in it.
core::Result<std::string> without_offset(const std::string& text, const std::string& name);

/// Sets how far the result may deviate from the part.
core::Result<std::string> with_part_tolerance(const std::string& text, double tolerance);

/// Sets the general minimum clearance, or leaves it to the defaults.
core::Result<std::string> with_allowance(const std::string& text, std::optional<double> distance);

/// Changes the distance of an `[[allowance]]` between two bodies, removes one, or adds one.
core::Result<std::string> with_pair_allowance(const std::string& text, size_t index,
                                              double distance);
core::Result<std::string> without_pair_allowance(const std::string& text, size_t index);
core::Result<std::string> with_new_pair_allowance(const std::string& text,
                                                  const std::array<std::string, 2>& between,
                                                  double distance);

/// Removes a word from `assumed`: the value is known.
core::Result<std::string> with_known(const std::string& text, std::string_view word);

/// Takes the machine from a file, in place of a preset with its sizes.
core::Result<std::string> with_machine_file(const std::string& text, const std::string& file);
/// Takes the machine from a preset, in place of a file. Sizes that the new preset has too stay.
///
/// Errors: also invalid_value for a name that no machine has.
core::Result<std::string> with_machine_preset(const std::string& text, std::string_view name);
/// States a size of the machine's preset, in mm or degrees, or leaves it to the preset.
///
/// Errors: also invalid_value if the set-up names no preset, or the value does not fit it.
core::Result<std::string> with_machine_value(const std::string& text, std::string_view key,
                                             std::optional<double> value);

} // namespace app
