#pragma once

#include <filesystem>
#include <map>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "app/setup/tools/found_tool.h"
#include "core/base/result.h"

namespace app {

/// The tools of a library of Fusion 360 in JSON, by the number of their post-processor data.
/// Holders, probes, turning tools and tools without a number are left out.
///
/// Errors: syntax, with the file, if no tool is left.
core::Result<std::map<core::ToolNumber, FoundTool>>
tools_of_fusion_library(const nlohmann::json& library, const std::filesystem::path& path);

/// The same from the archive that Fusion 360 exports (.tools), which holds the library as JSON.
///
/// Errors: those of the archive and of the library.
core::Result<std::map<core::ToolNumber, FoundTool>>
tools_of_fusion_archive(const std::string& path);

/// The same from a library of HSMWorks, Inventor CAM and older Fusion 360 (.hsmlib), in XML.
///
/// Source: the format has no public description; what is said here is from the documentation of
///         HsmLibraryReader of G-CAM, which checked it against real libraries. The angle of a
///         chamfer mill is that of its flank from the axis, that of a drill is of the whole point,
///         and the sections of a holder are points of its outline.
core::Result<std::map<core::ToolNumber, FoundTool>> tools_of_hsm_library(const std::string& path);

} // namespace app
