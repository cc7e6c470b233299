#pragma once

#include <string>

#include "core/base/result.h"

namespace gcode {
struct Program;
}

namespace app {

struct ProgramSettings;
struct SetupFile;

/// A complete set-up from a program and what its CAM system has stored: a job of FreeCAD (.FCStd),
/// or a tool library. What these do not state is inferred as by infer_setup, and the notes about
/// them are among the assumptions.
///
/// Errors: those of infer_setup and of the file.
core::Result<SetupFile> infer_setup_with(const gcode::Program& program,
                                         const ProgramSettings& settings, const std::string& path);

} // namespace app
