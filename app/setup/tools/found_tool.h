#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/sim/tool_description.h"

namespace app {

/// A tool as somebody mentions it who does not describe it whole.
struct FoundTool {
    core::ToolDescription tool; // what is said; the rest is 0 or empty
    bool has_shape = false;     // else it is taken for a flat end mill
    bool has_diameter = true;   // else it is one that such tools often have
    std::string source;         // "the comment in line 12", as it ends a sentence
};

/// A tool that can be assembled: what was not said is what such tools usually have.
///
/// Flutes of which nothing is said are at least `least_flutes` long, what the program cuts with
/// them. Result: `assumed` says in one sentence where it comes from and what was taken for granted.
struct CompleteTool {
    core::ToolDescription tool;
    std::string assumed;
};
CompleteTool complete(const FoundTool& found, double least_flutes = 0.0);

/// A name of a shape in a source of tools.
struct ShapeName {
    std::string_view name;
    core::ToolShape shape;
};

/// Words of tool names in capitals, in the order in which they count.
std::span<const ShapeName> shape_words();
/// The shapes of FreeCAD's tool bits, in small letters.
std::span<const ShapeName> freecad_shapes();
/// The types of Fusion 360's tools.
std::span<const ShapeName> fusion_shapes();

/// The shape of exactly this name; empty if there is none.
std::optional<core::ToolShape> shape_in(std::span<const ShapeName> names, std::string_view name);

} // namespace app
