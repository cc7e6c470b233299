#pragma once

#include <string>
#include <vector>

namespace core {
struct ConeStep;
struct ToolDescription;
} // namespace core

namespace app {

class TableReader;
struct BodyContext;
struct SetupFile;

/// Reads one `[[tool]]` into the set-up and into the control's tool lengths.
void read_tool(TableReader& table, BodyContext& context);

/// Notes on properties that a description leaves open, and on what is assumed for them.
std::vector<std::string> notes_on(const core::ToolDescription& tool);

/// Reads one `[[length_offset]]`.
void read_length_offset(TableReader& table, SetupFile& file);

/// Reads the holder of a tool: `holder` as cones, an outline, the name of a preset or of a holder
/// in `holder_file`, or a preset with its sizes; or `holder_mesh`.
void read_holder(TableReader& table, BodyContext& context, core::ToolDescription& tool);

/// A part of a tool, given as cones (rows of three) or as an outline (rows of two).
std::vector<core::ConeStep> read_steps(TableReader& table, const char* key);

} // namespace app
