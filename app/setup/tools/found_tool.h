#pragma once

#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/sim/tool_description.h"

namespace app {

/// A tool that is described incompletely.
struct FoundTool {
    core::ToolDescription tool;         // what is stated; the rest is 0 or empty
    bool has_shape = false;             // else a flat end mill is assumed
    bool has_diameter = true;           // else a common diameter is assumed
    std::string source;                 // "the comment in line 12", to follow "according to"
    std::vector<std::string> assumed{}; // what its reader assumed, each to precede "is assumed"
    bool is_described = true;           // else only its use is known
};

/// The keys of the values that a source states of a tool, as a set-up names them.
std::set<std::string> known_keys(const FoundTool& found);

/// A tool completed with the sizes that such tools usually have.
///
/// Flutes of unstated length are at least `least_flutes` long, the depth that the program cuts with
/// them. Result: `assumed` says in one sentence where the tool comes from and what is assumed.
struct CompleteTool {
    core::ToolDescription tool;
    std::string assumed;
};
CompleteTool complete(const FoundTool& found, double least_flutes = 0.0);

/// The name of a shape in some source of tools.
struct ShapeName {
    std::string_view name;
    core::ToolShape shape;
};

/// Words in tool names, in capitals; the first that matches counts.
std::span<const ShapeName> shape_words();
/// The shapes of FreeCAD's tool bits, in lower case.
std::span<const ShapeName> freecad_shapes();
/// The types of Fusion 360's tools.
std::span<const ShapeName> fusion_shapes();

/// The shape of exactly this name; empty if there is none.
std::optional<core::ToolShape> shape_in(std::span<const ShapeName> names, std::string_view name);

} // namespace app
