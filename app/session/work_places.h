#pragma once

#include <string>
#include <vector>

#include "app/session/program_survey.h"

namespace app {

/// The work offset whose coordinates hold most of what a program feeds; empty where it feeds
/// nothing.
std::optional<size_t> main_place(const ProgramSurvey& seen);

/// Moves the work offsets of a bare set-up apart that a program uses beside its main one, as parts
/// that are clamped side by side, unless the program writes them itself.
///
/// Result: what is assumed, empty where nothing was moved.
std::vector<std::string> move_apart(gcode::Environment& environment, const ProgramSurvey& seen);

} // namespace app
