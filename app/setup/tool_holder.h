#pragma once

#include "app/setup/body_table.h"

namespace app {

/// Reads what holds a tool: `holder` as cones, as an outline or as a name from a library
/// (`holder_file`, else those that come with the program), or `holder_mesh`.
void read_holder(TableReader& table, BodyContext& context, core::ToolDescription& tool);

/// A part of a tool given as cones, rows of three, or as an outline, rows of two.
std::vector<core::ConeStep> read_steps(TableReader& table, const char* key);

} // namespace app
