#pragma once

#include "app/setup/body_table.h"

namespace app {

/// Reads one `[[tool]]` into the set-up and into what the control knows of tool lengths.
void read_tool(TableReader& table, BodyContext& context);

/// What a description leaves open, and what is taken for granted there.
std::vector<std::string> notes_on(const core::ToolDescription& tool);

/// Reads one `[[length_offset]]`.
void read_length_offset(TableReader& table, SetupFile& file);

} // namespace app
