#pragma once

#include <optional>
#include <string>
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

} // namespace app
