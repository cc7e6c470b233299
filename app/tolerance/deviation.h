#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/base/result.h"

namespace core {
struct Setup;
struct ToolAssembly;
} // namespace core
namespace gcode {
struct Environment;
}

namespace app {

/// What a setter can get wrong.
///
/// work_offset: its value in the control, along an axis. tool_length: the length of a tool in the
/// control; the tool itself is as described. stick_out: the tool sits higher or lower in its
/// holder and was measured there, so its tip is right and the holder is not. tool_diameter: that of
/// the flutes; the control's radius compensation keeps the stated one. fixture, stock: its place on
/// the table.
enum class Quantity : uint8_t {
    work_offset,
    stock,
    fixture,
    tool_length,
    stick_out,
    tool_diameter
};

/// The name of a quantity in reports: "work offset", "tool length" ...
const char* name_of(Quantity quantity);

/// One quantity of a set-up that may deviate from its stated value.
struct Deviation {
    Quantity quantity = Quantity::work_offset;
    int axis = 0;                           // 0 X, 1 Y, 2 Z; of offsets, stock and fixtures
    size_t offset = 0;                      // index of the work offset, 0 is G54
    std::string fixture = {};               // its name
    core::ToolNumber tool{};                // for the tool quantities
    std::set<core::OffsetNumber> numbers{}; // entries with the length of the tool in the control

    /// Whether it is a place, and so has an axis.
    bool is_place() const { return quantity <= Quantity::fixture; }
    /// What deviates: "G54", "stock", "clamp left", "tool 3".
    std::string subject() const;
};

/// A set-up with its control.
struct StatedWorld {
    core::Setup& setup;
    gcode::Environment& environment;
};

/// Changes the stated value by `by`, mm. A tool diameter is that of the flutes alone.
///
/// Errors: invalid_value, for a tool that cannot have that size.
core::Result<void> deviate(const StatedWorld& world, const Deviation& deviation, double by);

/// The tool with another diameter of its flutes; its shank and its holder stay.
core::Result<core::ToolAssembly> with_diameter(const core::ToolAssembly& tool, double by);

/// Whether the flutes of a tool grow everywhere when its diameter does, so that all diameters of a
/// range lie between the smallest and the largest.
bool grows_with_diameter(const core::ToolAssembly& tool);

} // namespace app
