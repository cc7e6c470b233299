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

/// Reads one `[[tool]]` into the set-up and into what the control knows of tool lengths.
void read_tool(TableReader& table, BodyContext& context);

/// What a description leaves open, and what is taken for granted there.
std::vector<std::string> notes_on(const core::ToolDescription& tool);

/// Reads one `[[length_offset]]`.
void read_length_offset(TableReader& table, SetupFile& file);

/// Reads what holds a tool: `holder` as cones, as an outline or as a name from a library
/// (`holder_file`, else those that come with the program), or `holder_mesh`.
void read_holder(TableReader& table, BodyContext& context, core::ToolDescription& tool);

/// A part of a tool given as cones, rows of three, or as an outline, rows of two.
std::vector<core::ConeStep> read_steps(TableReader& table, const char* key);

} // namespace app
